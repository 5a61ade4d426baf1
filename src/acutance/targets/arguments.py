"""What a caller hands in besides pixels: options of the right kind, and regions."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import cache
from typing import Any, Protocol, TypeVar, cast

from acutance.errors import OptionError, RegionError
from acutance.raster import Box, Region

__all__ = ["chosen_options", "chosen_region", "published_options"]

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


@cache
def _default(kind: Any) -> Any:
    """Options nobody changed: frozen, so one of them serves all."""
    return kind()


class _HasMethodOptions(Protocol):
    """Options of a target that published methods measure too."""

    @property
    def robust(self) -> bool: ...

    @property
    def method_options(self) -> Any: ...


def published_options(options: _HasMethodOptions, method: str, kind: type[Options]) -> Options:
    """What the options of a measurement hold for a published method.

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


def chosen_region(roi: Any) -> Region | Box:
    """A region, a box, or the box of four numbers.

    Raises
    ------
    RegionError
        If it is none of these.
    """
    if isinstance(roi, Region | Box):
        return roi
    if isinstance(roi, str):
        raise RegionError(
            f"roi is the text {roi!r}: read it with acutance.raster.parse_roi(text, image), or "
            "give (row, column, height, width)"
        )
    try:
        numbers: Sequence[Any] = tuple(roi)
    except TypeError:
        raise RegionError(
            f"roi is of type {type(roi).__name__}: give (row, column, height, width), a Box or a "
            "Region"
        ) from None
    if len(numbers) != 4:
        raise RegionError(
            f"roi has {len(numbers)} numbers: give four, (row, column, height, width), in pixels"
        )
    return Box(*numbers)
