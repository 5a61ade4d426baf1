"""The ISO chart, band by band: from the reference program's curve to ours, step by step.

The reference program fits a polynomial of degree 5 to the centroids of the columns. On this chart
that polynomial bends by 0.1 px where the edge is straight to 0.01 px, and takes MTF away.
"""

from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import acutance as ac
from acutance.targets.straight import EdgeOptions
from acutance.targets.straight.published import Iso12233Options

FOLDER = Path(__file__).parents[3] / "shared" / "data"
BANDS = {1: "SFR_R", 2: "SFR_G", 3: "SFR_B"}
FREQ_CPP = np.arange(0.05, 0.501, 0.01)

pytestmark = [
    pytest.mark.real,
    pytest.mark.skipif(not FOLDER.is_dir(), reason=f"no folder of real images at {FOLDER}"),
]


def chart(band):
    return ac.open_image(FOLDER / "03_sfrmat5_chart_edge1_rgb.tif", band)


def reference_mtf50(band):
    table = np.genfromtxt(FOLDER / "03_sfrmat5_reference_sfr.csv", delimiter=",", names=True)
    return crossing(table["freq_cy_per_px"], table[BANDS[band]])


def crossing(freq, mtf):
    """Frequency where a curve first falls to 0.5."""
    behind = int(np.flatnonzero(mtf < 0.5)[0])
    return np.interp(0.5, mtf[[behind, behind - 1]], freq[[behind, behind - 1]])


@cache
def by_iso(band, order):
    options = Iso12233Options(edge_order=order, replicates=30)
    return ac.measure_edge(
        chart(band), method="iso12233", options=EdgeOptions(method_options=options)
    ).response.mtf50_cpp


@cache
def ours(band):
    return ac.measure_edge(chart(band))


def binned(m, step_px=0.25, half_px=60.0):
    """MTF50 of an e-SFR along our line, the gains of bins and difference divided out."""
    distance, value = m.details.distance_px, m.details.value
    used = np.abs(distance) < half_px
    place = ((distance[used] + half_px) / step_px).astype(int)
    esf = np.bincount(place, value[used]) / np.bincount(place)
    lsf = esf[2:] - esf[:-2]
    s = (np.arange(lsf.size) + 1.5) * step_px - half_px
    lsf *= 0.5 + 0.5 * np.cos(np.pi * s / half_px)
    otf = np.abs(np.exp(-2j * np.pi * np.outer(FREQ_CPP, s)) @ lsf) / lsf.sum()
    return crossing(FREQ_CPP, otf / np.sinc(2 * FREQ_CPP * step_px) / np.sinc(FREQ_CPP * step_px))


def bend_px(m, pixels, half_px):
    """Rms of what degree 5 adds to a line through the centroids within a window about the edge."""
    change = np.diff(pixels, axis=0)
    col = np.arange(pixels.shape[1])
    x, y = m.line.normal
    line = m.line.row - (col - m.line.col) * x / y
    away = np.arange(change.shape[0])[:, None] + 0.5 - line
    weight = np.where(np.abs(away) < half_px, 0.5 + 0.5 * np.cos(np.pi * away / half_px), 0)
    centroid = (change * weight * away).sum(axis=0) / (change * weight).sum(axis=0)
    along = col / col.max() - 0.5
    bent, straight = (np.polyval(np.polyfit(along, centroid, k), along) for k in (5, 1))
    return float(np.std(bent - straight))


@pytest.mark.parametrize("band", BANDS)
def test_our_iso12233_with_the_same_polynomial_is_the_reference(band):
    assert by_iso(band, 5).value == pytest.approx(reference_mtf50(band), rel=0.006)


@pytest.mark.parametrize("band", BANDS)
def test_the_polynomial_costs_two_to_four_per_cent(band):
    assert 1.015 < by_iso(band, 1).value / by_iso(band, 5).value < 1.04


@pytest.mark.parametrize("band", BANDS)
def test_its_bend_is_that_of_the_window_and_not_of_the_edge(band):
    m, pixels = ours(band), chart(band).read()
    bends = [bend_px(m, pixels, half_px) for half_px in (6.0, 12.0, 25.0, 60.0)]
    assert bends[0] < 0.005
    assert all(wider > 2 * narrower for narrower, wider in pairwise(bends))
    assert bends[-1] > 0.08


@pytest.mark.parametrize("band", BANDS)
def test_ours_agrees_with_the_binned_curve_on_a_straight_line(band):
    found, straight = ours(band).response.mtf50_cpp, by_iso(band, 1)
    assert abs(found.value - binned(ours(band))) < 2.5 * np.hypot(found.std, straight.std)
