"""The MTF curves of a sensor's latest measurements, by direction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from acutance.archive.counted import counted
from acutance.archive.natural_order import natural_key
from acutance.report.figures.curves import COLORS, mark_frequencies
from acutance.report.html import Plate
from acutance.report.paper import INK, new_page, styled

if TYPE_CHECKING:
    from acutance.archive.measurements import Measurements
    from acutance.targets.record import Record

__all__ = ["LATEST", "curves_plates"]

LATEST = 60
"""So many measurements are drawn, the latest."""
_ONE_OF = ("band", "level")
"""Curves of different ones are not drawn over one another."""
_TO_CPP = 1.0
_FEW = 10


def curves_plates(rows: Measurements) -> Iterator[Plate]:
    """Drawings of the latest curves, one a band and product level that has any.

    Parameters
    ----------
    rows : Measurements
        Oldest first.
    """
    latest: dict[tuple[str | None, str | None], dict[int, None]] = {}
    for number, *key in zip(*(rows[name].tolist() for name in ("id", *_ONE_OF)), strict=True):
        latest.setdefault((key[0], key[1]), {})[number] = None
    for words, numbers in sorted(latest.items(), key=lambda one: tuple(map(natural_key, one[0]))):
        plate = _plate(rows.load(list(numbers)[-LATEST:]), ", ".join(filter(None, words)))
        if plate is not None:
            yield plate


def _plate(records: Sequence[Record], name: str) -> Plate | None:
    """A drawing of curves; none where documents hold none."""
    curves = _curves(records)
    if not curves:
        return None
    with styled():
        figure = new_page(12.4, 4.6)
        # Two places on every plate: those of several bands are compared.
        all_axes = figure.subplots(1, 2, sharey=True)
        for axes in all_axes[len(curves) :]:
            axes.set_visible(False)
        for axes, (direction, several) in zip(all_axes, curves.items(), strict=False):
            freq = np.linspace(0.0, _TO_CPP, 201)
            drawn = np.array([np.interp(freq, at, value) for at, value in several])
            mark_frequencies(axes, None, float(np.nanmax(drawn)))
            for one in drawn:
                axes.plot(freq, one, color=COLORS[direction], alpha=_alpha(len(drawn)),
                          linewidth=0.8 if len(drawn) > _FEW else 1.4)  # fmt: skip
            if len(drawn) > 1:
                axes.plot(freq, np.median(drawn, axis=0), color=INK, linewidth=1.8, label="median")
                axes.legend(loc="upper right")
            title = ", ".join(filter(None, ("MTF", name, direction)))
            axes.set(title=title, xlabel="frequency [c/px]", xlim=(0.0, _TO_CPP))
        all_axes[0].set_ylabel("MTF")
    counts = " and ".join(
        f"{counted(len(several), 'measurement')} {direction}"
        for direction, several in curves.items()
    )
    median = ", and their median at every frequency" if max(map(len, curves.values())) > 1 else ""
    return Plate.of_figure(
        figure,
        "MTF of the latest measurements",
        f"{f'{name}: the' if name else 'The'} latest {counts}{median}.",
        wide=True,
    )


def _alpha(count: int) -> float:
    """Few curves are seen one by one, many as a cloud."""
    return float(np.clip(3 / count, 0.15, 0.8))


def _curves(records: Sequence[Record]) -> dict[str, list[tuple[np.ndarray, np.ndarray]]]:
    """Frequencies and values of every curve, by direction."""
    found: dict[str, list[tuple[np.ndarray, np.ndarray]]] = {}
    for record in records:
        for name in record.measured_directions:
            if record.directions[name].has_curve("mtf"):
                at, value, _ = record.directions[name].curve("mtf")
                found.setdefault(name, []).append((at, value))
    return {name: found[name] for name in ("across", "along") if name in found}
