"""How far the edges of a scene lie from its sensor, and how far they are expected to.

A soft object of softness tau has exp(-pi^2 tau^2 / 2) times the sensor's modulation transfer
function (MTF) at Nyquist; edges scatter about that in proportion to their standard deviations.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.report.figures.panel import Panel, on_axes
from acutance.report.figures.scene_sensor import EdgesSeen, behind_words, edges_seen
from acutance.report.paper import BLUE, FAINT, INK, SHADE, VERMILION
from acutance.scan.softness import NEARLY_IDEAL_PX, STRANGE, law_chances

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from acutance.scan import SceneMeasurement

__all__ = ["expected_counts", "population_panel", "scatter_of"]

_TAIL: Final = 0.005
"""Share of the edges beyond either end, where there are enough of them."""
_ENOUGH: Final = 200
_MIN_BINS, _MAX_BINS = 12, 60
_MIN_REACH: Final = 0.02
_HEADROOM: Final = 1.25
"""For the legend."""
_MAX_EDGES: Final = 2000
"""More edges are represented by so many."""
_CELLS_PX: Final[Floats] = np.linspace(0.0, 1.6, 65)
"""Of softer objects nothing is left at Nyquist."""
_MIN_EDGES: Final = 5
_MEDIAN: Final = 0.6745
"""Half of a normal distribution lies within so many standard deviations."""
_SIGMAS: Final[Floats] = np.linspace(-6.0, 6.0, 1201)
_NORMAL: Final[Floats] = np.array([0.5 * (1 + math.erf(one / math.sqrt(2))) for one in _SIGMAS])


def population_panel(measurement: SceneMeasurement) -> Panel:
    """Histogram of edges minus sensor; with the details also what the fit expects."""
    expected = (
        ""
        if measurement.details is None
        else " Lines: how many edges the fitted population expects in every bar, dark all of them, "
        "blue those of ideal objects. For the lines an edge scatters by "
        f"{scatter_of(edges_seen(measurement)):.2f} times its stated standard deviation: so much "
        "do the edges to the right of 0, among which there are no soft objects."
    )
    return Panel(
        "Sharpness of the edges",
        "Grey bars: MTF at Nyquist of the used edges minus that of the sensor (red) at their place "
        "along their normal; at most one in a hundred lies beyond the ends. Soft objects lie on "
        "the left." + expected + behind_words(measurement),
        on_axes(_draw, measurement),
    )


def scatter_of(edges: EdgesSeen) -> float:
    """Scatter of the edges about the sensor, in units of their standard deviations.

    Of those that are sharper than it: no soft object is among them.
    """
    sharper = (edges.off / edges.std)[edges.off > 0]
    return float(np.median(sharper)) / _MEDIAN if sharper.size >= _MIN_EDGES else 1.0


def expected_counts(edges: EdgesSeen, share: Floats, bins: Floats) -> tuple[Floats, Floats]:
    """Edges expected in every bin of edge minus sensor.

    Parameters
    ----------
    edges : EdgesSeen
    share : (p,) array
        Of `acutance.scan.softness.PARTS`.
    bins : (m + 1,) array

    Returns
    -------
    ideal, all : (m,) arrays
    """
    some = np.linspace(0, edges.mtf.size - 1, min(edges.mtf.size, _MAX_EDGES)).astype(int)
    sensor, std = edges.sensor[some], scatter_of(edges) * edges.std[some]
    each = edges.mtf.size / some.size
    strange = each * share[-1] * _counted(sensor, sensor, math.sqrt(STRANGE) * std, bins)
    # Softness zero, cells of others, and all that is softer.
    cells = share[1:-1] @ law_chances(_CELLS_PX)
    weight = np.array([share[0], *cells, share[1:-1].sum() - cells.sum()])
    softness_px = np.array([0.0, *(0.5 * (_CELLS_PX[:-1] + _CELLS_PX[1:])), np.inf])
    left = np.exp(-0.5 * (np.pi * softness_px) ** 2)
    counts = np.array([
        each * own * _counted(kept * sensor, sensor, std, bins)
        for own, kept in zip(weight, left, strict=True)
    ])  # fmt: skip
    return counts[softness_px < NEARLY_IDEAL_PX].sum(axis=0), counts.sum(axis=0) + strange


def _counted(mtf: Floats, sensor: Floats, std: Floats, bins: Floats) -> Floats:
    """Edges of some MTF (n,) by bins of what is measured minus sensor, (m,).

    What is measured is a modulus: errors that would make it negative turn it up again.
    """
    most = bins + sensor[:, None]
    above, below = ((one - mtf[:, None]) / std[:, None] for one in (most, -most))
    less = np.interp(above, _SIGMAS, _NORMAL) - np.interp(below, _SIGMAS, _NORMAL)
    return np.diff(np.maximum(less, 0.0).sum(axis=0))


def _draw(axes: Axes, measurement: SceneMeasurement) -> None:
    edges = edges_seen(measurement)
    bins = _bins(edges.off)
    counts, _ = np.histogram(edges.off, bins)
    axes.stairs(
        counts, bins, fill=True, facecolor=SHADE, edgecolor=FAINT, linewidth=0.9, label="edges"
    )
    axes.axvline(0.0, color=VERMILION, linewidth=1.4, label="sensor")
    if measurement.details is not None:
        middle = 0.5 * (bins[1:] + bins[:-1])
        ideal, every = expected_counts(edges, measurement.details.share, bins)
        axes.plot(middle, every, color=INK, linewidth=1.5, label="expected")
        axes.plot(middle, ideal, color=BLUE, linewidth=1.5, label="ideal ones")
    share = measurement.objects["ideal"]
    axes.set(
        xlim=(bins[0], bins[-1]), xlabel="edge − sensor, MTF at Nyquist", ylabel="edges",
        title=f"Edges: {100 * share.value:.0f} ± {100 * share.std:.0f} % of ideal objects",
    )  # fmt: skip
    axes.set_ylim(0.0, _HEADROOM * max(axes.get_ylim()[1], 1.0))
    axes.locator_params(axis="x", nbins=6)
    # Half an edge is none.
    axes.locator_params(axis="y", integer=True, min_n_ticks=1)
    axes.legend(loc="upper left")
    axes.grid(visible=False, axis="x")


def _bins(off: Floats) -> Floats:
    """Bins that hold all edges, or nearly all of many, the narrower the more there are."""
    tail = _TAIL if off.size > _ENOUGH else 0.0
    low, high = np.quantile(off, [tail, 1 - tail]) if off.size else (0.0, 0.0)
    count = int(np.clip(2 * off.size**0.4, _MIN_BINS, _MAX_BINS))
    return np.linspace(min(low, -_MIN_REACH), max(high, _MIN_REACH), count + 1)
