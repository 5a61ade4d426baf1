"""The biases of the published steps, as closed forms predict them, against the reference method.

An edge of a Gaussian and a square pixel without noise: what a step takes from the MTF is known,
so every named method has to show its own error, and the reference method none.
"""

import math

import numpy as np
import pytest

import acutance as ac
from acutance import optics, simulate
from acutance.targets.straight.options import EdgeOptions
from acutance.targets.straight.published import Iso12233Options

SENSOR = ac.Sensor([optics.Gaussian(0.5), optics.Detector()])


def ratio_at_nyquist(method, angle_deg, **options):
    image, truth = simulate.edge(SENSOR, angle_deg=angle_deg, shape=(80, 60))
    found = ac.measure_edge(image, method=method, options=EdgeOptions(**options))
    return found.mtf_nyquist.value / truth.mtf_nyquist.value


def test_reference_method_has_no_static_error():
    for angle_deg in (4.0, 14.036, 33.0):
        assert ratio_at_nyquist("spline", angle_deg) == pytest.approx(1, abs=1e-3)


def test_row_distance_instead_of_normal_distance_would_show():
    # The pixels of a row seen as if their spacing were along the normal: M(f / cos angle).
    angle_deg = 20.0
    image, truth = simulate.edge(SENSOR, angle_deg=angle_deg, shape=(60, 60))
    found = ac.measure_edge(image)
    by_row = truth.mtf(0.5 / math.cos(math.radians(angle_deg)))
    assert by_row.value / truth.mtf_nyquist.value < 0.90
    assert abs(found.mtf_nyquist.value - truth.mtf_nyquist.value) < 1e-3


def test_quarter_pixel_bins_take_what_their_sinc_says():
    # Bins of h = 1/4 px along the row average the ESF: -2.55 % at Nyquist; the difference of
    # neighbours takes as much again and is corrected for. A Hann window adds to it: it is
    # measured here through two bin widths of the same method, which share the window.
    options = [
        EdgeOptions(method_options=Iso12233Options(bins_per_px=bins, replicates=0))
        for bins in (4, 8)
    ]
    image, _ = simulate.edge(SENSOR, angle_deg=5.3, shape=(160, 60))
    coarse, fine = (
        ac.measure_edge(image, method="iso12233", options=option).mtf_nyquist.value
        for option in options
    )
    expected = np.sinc(0.5 / 4) / np.sinc(0.5 / 8)
    assert coarse / fine == pytest.approx(expected, abs=0.004)


@pytest.mark.parametrize("method", ["sdsu-2005", "kompsat-2014", "iso12233"])
def test_published_methods_keep_errors_that_the_reference_avoids(method):
    options = {}
    if method == "iso12233":
        options["method_options"] = Iso12233Options(replicates=0)
    error = abs(ratio_at_nyquist(method, 6.0, **options) - 1)
    assert 0.002 < error < 0.2
    assert error > 5 * abs(ratio_at_nyquist("spline", 6.0) - 1)
