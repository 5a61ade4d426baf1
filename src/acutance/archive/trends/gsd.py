"""A GSD that changes during a series: what it does to numbers in pixels.

A width in pixels changes with the GSD although the sensor does not; in metres it stays. The MTF at
Nyquist belongs to another frequency of the ground afterwards, which no factor mends: the change is
then an event with a step of its own.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.archive.trends.series import Event, Series, moment_of
from acutance.curves.grid import Floats

__all__ = ["SAME_GSD", "gsd_classes", "gsd_events", "gsd_range"]

SAME_GSD: Final = 0.02
"""GSDs that differ by less are those of one product."""
_MAX_CHANGES: Final = 3
_OTHER_CLASS: Final = 1.4
"""A gap so wide between GSDs is one between products: bands of 10 and 20 m, of 20 and 30 m."""


def gsd_classes(gsd_m: Floats) -> NDArray[np.int64]:
    """Labels of GSDs with a gap between them, (n,): 0 for the finest, -1 where it is not known.

    Parameters
    ----------
    gsd_m : (n,) array
        ``nan`` where it is not known.
    """
    known = np.unique(gsd_m[np.isfinite(gsd_m)])
    firsts = known[1:][known[1:] > _OTHER_CLASS * known[:-1]]
    label = np.searchsorted(firsts, gsd_m, side="right")
    return np.where(np.isfinite(gsd_m), label, -1)


def gsd_range(series: Series) -> tuple[float, float] | None:
    """Smallest and largest GSD in metres; ``None`` where none is known."""
    known = np.array([]) if series.gsd_m is None else series.gsd_m[np.isfinite(series.gsd_m)]
    return (float(known.min()), float(known.max())) if known.size else None


def gsd_events(series: Series) -> tuple[tuple[Event, ...], tuple[str, ...]]:
    """Events at which the GSD changed, and what there is to be said of it.

    Parameters
    ----------
    series : Series
        With dates and values.
    """
    found = gsd_range(series)
    if found is None or found[1] <= found[0] * (1 + SAME_GSD) or _is_in_metres(series.metric):
        return (), ()
    assert series.gsd_m is not None
    known = np.isfinite(series.gsd_m)
    order = np.argsort(series.when[known], kind="stable")
    when, gsd_m = series.when[known][order], series.gsd_m[known][order]
    is_other = np.abs(gsd_m[1:] / gsd_m[:-1] - 1) > SAME_GSD
    changed = (1 + np.flatnonzero(is_other & (np.diff(when) > 0))).tolist()
    span = f"GSD runs from {found[0]:.3g} to {found[1]:.3g} m"
    if len(changed) > _MAX_CHANGES:
        return (), (
            f"The {span}, from image to image: numbers in pixels scatter with it. Compare lengths "
            "in metres (fwhm_m).",
        )
    if not changed:
        return (), (
            f"The {span}, little by little: numbers in pixels drift with it. Compare lengths in "
            "metres (fwhm_m).",
        )
    # The moment and not its day, which would begin before the earlier of two images of a day.
    events = tuple(
        Event(moment_of(0.5 * float(when[at - 1] + when[at])),
              f"GSD {gsd_m[at - 1]:.3g} to {gsd_m[at]:.3g} m")
        for at in changed
    )  # fmt: skip
    note = f"The {span}: each change is an event with a step of its own"
    unit = series.metric.rpartition("_")[2]
    advice = ("; in metres (fwhm_m) there is none." if unit in ("px", "cpp") else
              ", because the frequency it belongs to changes on the ground.")  # fmt: skip
    return events, (note + advice,)


def _is_in_metres(metric: str) -> bool:
    return metric.rpartition("_")[2] == "m"
