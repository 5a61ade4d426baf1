"""Options of a measurement: those a caller gave, or the default ones."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from functools import cache
from typing import Any, Protocol, TypeVar, cast

from acutance.errors import OptionError

__all__ = ["chosen_options", "published_options", "require_known_method"]

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
