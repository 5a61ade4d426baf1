"""The kinds of target, in one table: where each is measured, and by which methods.

Names only: a room is imported when its kind is measured. Help texts, choices and documentation
read their names here; a new kind of target begins with a line of this table.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

__all__ = ["KINDS", "Kind", "methods_text"]


@dataclass(frozen=True)
class Kind:
    """One kind of target.

    Parameters
    ----------
    name : str
        As measurements and documents name it.
    room : str
        The package to import.
    measure : str
        Its function that turns a region into a measurement.
    options : str
        Its class of options.
    methods : tuple of str
        The estimators by name, the reference first.
    measure_all : str, optional
        Its function that measures every target of a region.
    """

    name: str
    room: str
    measure: str
    options: str
    methods: tuple[str, ...]
    measure_all: str | None = None

    def load(self, name: str) -> Callable[..., Any]:
        """A function or class of the room, which is imported now."""
        found: Callable[..., Any] = getattr(importlib.import_module(self.room), name)
        return found


KINDS = {
    kind.name: kind
    for kind in (
        Kind(
            "edge", "acutance.targets.straight", "measure_edge", "EdgeOptions",
            ("spline", "sdsu-2005", "kompsat-2014", "iso12233", "fermi"), "measure_edges",
        ),
        Kind(
            "pulse", "acutance.targets.straight", "measure_pulse", "PulseOptions",
            ("spline", "sdsu-2005"),
        ),
        Kind(
            "points", "acutance.targets.points", "measure_points", "PointsOptions",
            ("psf-fit", "gaussian-2003"),
        ),
        Kind(
            "biresolution", "acutance.targets.pair", "measure_biresolution", "BiresolutionOptions",
            ("kernel-fit", "spectral-ratio"),
        ),
        Kind("bars", "acutance.targets.periodic", "measure_bars", "BarsOptions", ("joint",)),
        Kind("star", "acutance.targets.periodic", "measure_star", "StarOptions", ("joint",)),
        Kind(
            "combined", "acutance.targets.combine", "combine", "CombineOptions", ("least-squares",),
        ),
    )
}  # fmt: skip


def methods_text(methods: tuple[str, ...]) -> str:
    """The names for a help text: "spline (the reference), sdsu-2005 or fermi"."""
    reference, *others = methods
    if not others:
        return reference
    *commas, last = (f"{reference} (the reference)", *others)
    return f"{', '.join(commas)} or {last}"
