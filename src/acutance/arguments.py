"""What callers hand in: of the kind that is needed, or refused by its name, in words."""

from __future__ import annotations

import math
import operator
import os
import types
from collections.abc import Collection, Hashable, Iterable, Mapping, Sequence
from functools import cache
from numbers import Integral, Real
from typing import Any, Literal, TypeVar, Union, cast, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import ArrayLike, NDArray

from acutance.errors import ModelError, OptionError

__all__ = [
    "require_all",
    "require_choice",
    "require_class",
    "require_finite",
    "require_flags",
    "require_floats",
    "require_function",
    "require_kind",
    "require_numbers",
    "require_optional",
    "require_path",
    "require_paths",
    "require_place",
    "require_rng",
    "require_shape",
    "require_texts",
    "require_types",
    "require_whole",
]

Kind = TypeVar("Kind")


def require_numbers(**values: Any) -> None:
    """Refuse what is of another kind than a number, such as a truth value.

    Raises
    ------
    OptionError
        Names the argument.
    """
    for name, value in values.items():
        # Nearly all are floats, and to ask an abstract class takes ten times as long.
        if type(value) is not float and (isinstance(value, bool) or not isinstance(value, Real)):
            raise OptionError(f"{name} is {value!r:.80}, it has to be a number")


def require_finite(**values: Any) -> None:
    """Refuse what is infinite or not a number.

    Raises
    ------
    OptionError
        If it is something else than a number: names the argument.
    ModelError
        If it is an infinite number, or NaN.
    """
    require_numbers(**values)
    for name, value in values.items():
        if not math.isfinite(value):
            raise ModelError(f"{name} is {value:g}, it has to be a finite number")


def require_whole(least: int, **values: Any) -> None:
    """Refuse what is no whole number, or below `least`.

    Raises
    ------
    OptionError
        Names the argument.
    """
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, Integral) or int(value) < least:
            raise OptionError(
                f"{name} is {value!r:.80}, it has to be a whole number, {least} or more"
            )


def require_flags(**values: Any) -> None:
    """Refuse what is neither true nor false.

    Raises
    ------
    OptionError
        Names the argument.
    """
    for name, value in values.items():
        if not isinstance(value, bool | np.bool_):
            raise OptionError(f"{name} is {value!r:.80}, it has to be True or False")


def require_function(**values: Any) -> None:
    """Refuse what is neither left out (``None``) nor can be called.

    Raises
    ------
    OptionError
        Names the argument.
    """
    for name, value in values.items():
        if value is not None and not callable(value):
            raise OptionError(f"{name} is {value!r:.80}: give a function, or leave it out")


def require_kind(kind: type[Any], **values: Any) -> None:
    """Refuse what is no object of a class.

    Raises
    ------
    OptionError
        Names the argument and the class.
    """
    for name, value in values.items():
        if not isinstance(value, kind):
            raise OptionError(f"{name} is {value!r:.80}: give {kind.__name__}(...)")


def require_class(name: str, **values: Any) -> None:
    """Refuse what is no object of a class, which is told by its name and need not be loaded.

    Raises
    ------
    OptionError
        Names the argument and the class.
    """
    for argument, value in values.items():
        if name not in (one.__name__ for one in type(value).__mro__):
            raise OptionError(
                f"{argument} is {value!r:.80}, a {type(value).__name__}: give {name}(...)"
            )


def require_optional(kind: type[Any], **values: Any) -> None:
    """Refuse what is neither left out (``None``) nor an object of a class.

    Raises
    ------
    OptionError
        Names the argument and the class.
    """
    require_kind(kind, **{name: value for name, value in values.items() if value is not None})


def require_all(
    kind: type[Any] | tuple[type[Any], ...], name: str, values: Iterable[Kind]
) -> tuple[Kind, ...]:
    """Objects of a class, or of one of several, that a caller gave one after another.

    Parameters
    ----------
    kind : type, or tuple of them
    name : str
        What the argument is called, for the message.
    values : iterable
        Of any length, none included.

    Raises
    ------
    OptionError
        If it is no sequence, or holds something else.
    """
    words = " or ".join(f"{one.__name__}(...)" for one in _tuple_of(kind))
    try:
        found = tuple(values)
    except TypeError:
        raise OptionError(f"{name} is {values!r:.80}: give a list of {words}") from None
    for number, value in enumerate(found, start=1):
        if not isinstance(value, kind):
            raise OptionError(f"number {number} of {name} is {value!r:.80}: give {words}")
    return found


def _tuple_of(kind: type[Any] | tuple[type[Any], ...]) -> tuple[type[Any], ...]:
    return kind if isinstance(kind, tuple) else (kind,)


def require_choice(choices: Collection[str], **values: Any) -> None:
    """Refuse what is none of some words.

    Raises
    ------
    OptionError
        Names the argument and the words.
    """
    for name, value in values.items():
        # An array is equal to no word, and cannot be looked for among those of a dict either.
        if not isinstance(value, str) or value not in choices:
            raise OptionError(f"{name} is {value!r:.80}: choose one of {', '.join(choices)}")


def require_path(**values: Any) -> None:
    """Refuse what is no path of a file: a text, or an object of `pathlib`.

    Raises
    ------
    OptionError
        Names the argument.
    """
    for name, value in values.items():
        if not isinstance(value, str | os.PathLike):
            raise OptionError(f"{name} is {value!r:.80}: give the path of a file, as a text")


def require_paths(name: str, values: Any) -> tuple[str | os.PathLike[str], ...]:
    """Paths of files that a caller gave as a list.

    Raises
    ------
    OptionError
        If it is a single one, or holds something else: names the argument.
    """
    found = _listed(name, values, "paths")
    for value in found:
        require_path(**{f"one of {name}": value})
    return found


def require_texts(name: str, values: Any) -> tuple[str, ...]:
    """Texts that a caller gave as a list, in its order.

    Raises
    ------
    OptionError
        If it is a single one, or holds something else: names the argument.
    """
    found = _listed(name, values, "texts")
    for value in found:
        if not isinstance(value, str):
            raise OptionError(f"one of {name} is {value!r:.80}: give a list of texts")
    return found


def _listed(name: str, values: Any, words: str) -> tuple[Any, ...]:
    """Several values of a caller, where a single one could be taken for a list of its parts."""
    if isinstance(values, str | bytes | type | os.PathLike) or not isinstance(values, Iterable):
        raise OptionError(f"{name} is {values!r:.80}: give a list of {words}")
    return tuple(values)


def require_floats(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Numbers of a caller as an array, of any shape; infinite ones and NaN may be among them.

    Raises
    ------
    OptionError
        If it holds something else: names the argument.
    """
    try:
        return np.asarray(values, np.float64)
    except (TypeError, ValueError):
        raise OptionError(f"{name} is {values!r:.80}: it has to hold numbers") from None


def require_place(**values: Any) -> None:
    """Refuse what is no pair of finite numbers, (row, column).

    Raises
    ------
    OptionError
        If it is something else than two numbers: names the argument.
    ModelError
        If one of them is infinite, or NaN.
    """
    for name, place in values.items():
        try:
            row, col = place
        except (TypeError, ValueError):
            raise OptionError(
                f"{name} is {place!r:.80}: it has to be two numbers, (row, column)"
            ) from None
        require_finite(**{f"the row of {name}": row, f"the column of {name}": col})


def require_shape(shape: Any) -> tuple[int, int]:
    """Rows and columns of an image, as a caller gave them.

    Raises
    ------
    OptionError
        If they are no pair of whole numbers.
    """
    try:
        rows, cols = map(operator.index, shape)
    except (TypeError, ValueError):
        raise OptionError(
            f"shape is {shape!r:.80}: it has to be two whole numbers, (rows, columns)"
        ) from None
    return rows, cols


def require_rng(rng: np.random.Generator | None, wanted: str) -> np.random.Generator:
    """The random generator of a caller, for what needs one.

    Parameters
    ----------
    rng : numpy.random.Generator or None
    wanted : str
        What needs it, for the message.

    Raises
    ------
    ModelError
        If there is none.
    OptionError
        If it is something else, such as a seed.
    """
    if rng is None:
        raise ModelError(f"{wanted} was requested without rng: pass numpy.random.default_rng()")
    if not isinstance(rng, np.random.Generator):
        seed = rng if isinstance(rng, int) else ""
        raise OptionError(f"rng is {rng!r:.80}: pass numpy.random.default_rng({seed})")
    return rng


_WORDS = {float: "a number", int: "a whole number", bool: "True or False", str: "text"}


def require_types(options: object) -> None:
    """Refuse a field of a dataclass that is not of the type its class declares.

    Parameters
    ----------
    options : dataclass
        Of numbers, truth values, texts, other classes, and tuples of them. An infinite number
        is one, NaN is none: nothing lies above or below it.

    Raises
    ------
    OptionError
        Names the class, the field, what was given and what it has to be.
    """
    # To mypy a class hashes as its objects do.
    for name, kind in _declared_types(cast(Hashable, type(options))).items():
        value = getattr(options, name)
        if not _is_of(value, kind):
            raise OptionError(
                f"{type(options).__name__}: {name} has to be {_word(kind)}, found {value!r:.80}"
            )


@cache
def _declared_types(of: Any) -> dict[str, Any]:
    return get_type_hints(of)


def _is_of(value: Any, kind: Any) -> bool:
    origin, parts = get_origin(kind), get_args(kind)
    if origin in (Union, types.UnionType):
        return any(_is_of(value, part) for part in parts)
    if origin is Literal:
        return isinstance(value, str | int) and value in parts
    if origin is tuple:
        return _are_of(value, parts)
    if origin is Sequence:
        return _are_of(value, (*parts, ...))
    if origin is Mapping:
        # Names and values are checked by `require_limits`.
        return isinstance(value, Mapping)
    if kind is bool:
        return isinstance(value, bool | np.bool_)
    if kind in (int, float):
        wanted = Integral if kind is int else Real
        return isinstance(value, wanted) and not isinstance(value, bool) and bool(value == value)
    return isinstance(value, kind)


def _are_of(values: Any, kinds: tuple[Any, ...]) -> bool:
    """Whether any kind of sequence holds what a tuple is declared to hold."""
    if isinstance(values, str | bytes | type) or not hasattr(values, "__len__"):
        return False
    if kinds[-1] is ...:
        return all(_is_of(value, kinds[0]) for value in values)
    return len(values) == len(kinds) and all(map(_is_of, values, kinds))


def _word(kind: Any) -> str:
    origin, parts = get_origin(kind), get_args(kind)
    if origin in (Union, types.UnionType):
        return " or ".join(_word(part) for part in parts)
    if origin is Literal:
        return " or ".join(map(repr, parts))
    if origin is Sequence or (origin is tuple and parts[-1] is ...):
        return f"several times {_word(parts[0])}"
    if origin is tuple:
        return f"({', '.join(map(_word, parts))})"
    if kind is types.NoneType:
        return "None"
    if origin is Mapping:
        return "a dict"
    return _WORDS.get(kind, f"{kind.__name__}(...)")
