"""Options of a measurement: those a caller gave or the default ones, holding what they declare."""

from __future__ import annotations

import types
from collections.abc import Hashable, Iterable, Mapping
from functools import cache
from numbers import Integral, Real
from typing import (
    Any,
    Literal,
    Protocol,
    TypeVar,
    Union,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np

from acutance.errors import OptionError

__all__ = ["chosen_options", "published_options", "require_known_method", "require_types"]

Options = TypeVar("Options")


def chosen_options(options: Any, kind: type[Options]) -> Options:
    """The options given, or the default ones for ``None``.

    Raises
    ------
    OptionError
        If they are those of another measurement, or none at all.
    """
    if options is None:
        # To mypy a class hashes as its objects do.
        default: Options = _default(cast(Hashable, kind))
        return default
    if not isinstance(options, kind):
        raise OptionError(
            f"options are of type {type(options).__name__}: give {kind.__name__}(...), or leave "
            "them out"
        )
    return options


def require_known_method(kind: str, name: Any, known: Iterable[str]) -> None:
    """Refuse a method that a kind of target has not.

    Raises
    ------
    OptionError
        If it is none of the known ones; they are named.
    """
    # A list is equal to no name, but cannot be looked for among those of a dict either.
    if not isinstance(name, str) or name not in known:
        raise OptionError(f"there is no {kind} method {name!r}: choose one of {', '.join(known)}")


@cache
def _default(kind: Any) -> Any:
    """The default options: frozen, so one object is enough."""
    return kind()


class _HasMethodOptions(Protocol):
    """Options of a target that published methods measure too."""

    @property
    def robust(self) -> bool: ...

    @property
    def method_options(self) -> Any: ...


def published_options(options: _HasMethodOptions, method: str, kind: type[Options]) -> Options:
    """The options of a published method, out of those of a measurement.

    Raises
    ------
    OptionError
        If they hold what the method does not have.
    """
    if not options.robust:
        raise OptionError(
            f"robust=False (--no-robust) is a choice of the reference method: {method} bounds no "
            "weights, so leave it out"
        )
    chosen = options.method_options
    if chosen is None:
        return kind()
    if not isinstance(chosen, kind):
        raise OptionError(
            f"method_options are {type(chosen).__name__}: method {method} takes {kind.__name__}"
        )
    return chosen


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
    if isinstance(values, str) or not hasattr(values, "__len__"):
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
    if origin is tuple and parts[-1] is ...:
        return f"several times {_word(parts[0])}"
    if origin is tuple:
        return f"({', '.join(map(_word, parts))})"
    if kind is types.NoneType:
        return "None"
    if origin is Mapping:
        return "a dict"
    return _WORDS.get(kind, f"{kind.__name__}(...)")
