"""Whatever holds arrays prints as one line."""

from dataclasses import dataclass

import numpy as np
import pytest

import acutance as ac
from acutance.curves import Estimate
from acutance.curves.one_line import OneLine

SENSOR = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()], gsd_m=0.7)


@dataclass(frozen=True)
class Thing(OneLine):
    name: str
    size: float
    width: Estimate
    samples: np.ndarray
    place: tuple[float, float]
    parts: tuple[int, ...]
    sensor: ac.Sensor


@dataclass(frozen=True)
class Larger(Thing):
    more: None = None


def test_fields_are_told_in_short():
    fields = ("a", 1 / 3, Estimate(0.5, 0.01), np.zeros((60, 40)), (1.5, 2.0), tuple(range(9)))
    told = (
        "name 'a', size 0.333333, width 0.500 ± 0.010, samples array of 60 x 40, "
        "place (1.5, 2), parts (9 of them), sensor <Sensor>"
    )
    assert repr(Thing(*fields, SENSOR)) == f"<Thing: {told}>"
    assert repr(Larger(*fields, SENSOR)) == f"<Larger: {told}, more None>"


@pytest.fixture(scope="module")
def edge():
    return ac.simulate.edge(SENSOR, angle_deg=6, snr=30, rng=np.random.default_rng(1))


def test_a_measurement_tells_its_numbers_and_its_failed_checks(edge):
    m = ac.measure_edge(edge[0])
    assert (
        repr(m)
        == str(m)
        == (
            f"<Measurement: edge by spline, across, mtf_nyquist {m.mtf_nyquist}, rer {m.rer}, "
            f"fwhm_px {m.fwhm_px}, snr {m.snr:.3g}, "
            f"1 of {len(m.checks)} checks failed (contrast_snr)>"
        )
    )


def test_results_curves_and_truths_print_as_one_line(edge):
    image, truth = edge
    m = ac.measure_edge(image)
    scene = ac.simulate.site(SENSOR, np.random.default_rng(2))
    target = ac.measure_edges(scene.image)
    stripe, pulse_truth = ac.simulate.pulse(
        SENSOR, width_px=4.0, snr=100, rng=np.random.default_rng(3)
    )
    printed = [
        *(m, m.response, m.esf, m.lsf, m.mtf, m.samples, m.slices, truth, pulse_truth),
        *(scene, scene.edges[0], target, *target.groups.values()),
        ac.measure_pulse(stripe, width_px=4.0),
        ac.Image.from_array(image),
    ]
    for one in printed:
        assert "\n" not in repr(one)
        assert len(repr(one)) < 300, one
    assert f"mtf_nyquist {truth.mtf_nyquist}" in repr(truth)
    assert repr(m.mtf) == "<Mtf: freq_cpp 0 to 1, 101 places>"


def test_measurements_over_the_plane_print_both_directions():
    image, truth = ac.simulate.star(SENSOR, snr=100, rng=np.random.default_rng(4))
    m = ac.measure_star(image, cycles=truth.star.cycles)
    assert f"across: {m.across.in_words()}, along: {m.along.in_words()}, " in repr(m)
    assert f"of {len(m.checks)} checks failed" in repr(m)
    assert len(repr(truth)) < 200
