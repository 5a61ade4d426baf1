"""Whatever holds arrays prints as one line and compares by what it holds."""

import math
import pickle
from dataclasses import dataclass, fields, replace

import numpy as np
import pytest

import acutance as ac
from acutance.curves import Esf, Estimate, Lsf, Mtf, Otf2d, Response
from acutance.curves.short_repr import ShortRepr

SENSOR = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()], gsd_m=0.7)


@dataclass(frozen=True)
class Thing(ShortRepr):
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
    summary = (
        "name 'a', size 0.333333, width 0.500 ± 0.010, samples array of 60 x 40, "
        "place (1.5, 2), parts (9 of them), sensor <Sensor>"
    )
    assert repr(Thing(*fields, SENSOR)) == f"<Thing: {summary}>"
    assert repr(Larger(*fields, SENSOR)) == f"<Larger: {summary}>"


@pytest.fixture(scope="module")
def edge():
    return ac.simulate.edge(SENSOR, angle_deg=6, snr=15, rng=np.random.default_rng(2))


def test_a_measurement_tells_its_numbers_and_its_failed_checks(edge):
    m = ac.measure_edge(edge[0])
    assert (
        repr(m)
        == str(m)
        == (
            "<StraightMeasurement: edge by spline, across: "
            f"mtf_nyquist {m.mtf_nyquist}, rer {m.rer}, "
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
        *(m, m.response, m.esf, m.lsf, m.mtf, m.details, m.slices, truth, pulse_truth),
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
    assert f"across: {m.across.summary()}, along: {m.along.summary()}, " in repr(m)
    assert f"of {len(m.checks)} checks failed" in repr(m)
    assert len(repr(truth)) < 200


@dataclass(frozen=True)
class Pair:
    """Whose own equality would ask for the truth of an array."""

    name: str
    samples: np.ndarray


@dataclass(frozen=True, eq=False)
class Holder(ShortRepr):
    samples: object


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (np.array([1.0, math.nan]), np.array([1.0, 2.0])),
        (np.array([1.0, 1j]), np.array([1.0, 2j])),
        (np.array(["a", "b"]), np.array(["a", "c"])),
        (np.zeros(3), np.zeros(4)),
        (np.zeros(3), None),
        (None, np.zeros(3)),
        (math.nan, 1.0),
        ((1, np.zeros(2)), (1, np.ones(2))),
        ([np.zeros(2)], [np.zeros(2), np.zeros(2)]),
        ({"a": np.zeros(2)}, {"a": np.ones(2)}),
        ({"a": np.zeros(2)}, {"b": np.zeros(2)}),
        (Pair("a", np.zeros(2)), Pair("a", np.ones(2))),
        (Pair("a", np.zeros(2)), Holder(np.zeros(2))),
        (Estimate(0.5, math.nan), Estimate(0.5, 0.1)),
        ("a", "b"),
    ],
)
def test_equal_to_a_copy_and_to_nothing_else(one, other):
    assert Holder(one) == pickle.loads(pickle.dumps(Holder(one)))
    assert Holder(one) != Holder(other)


def test_only_those_of_one_class_are_equal():
    @dataclass(frozen=True, eq=False)
    class Further(Holder):
        pass

    assert Further(1) != Holder(1)
    assert Holder(1) != 1
    assert Esf(np.arange(4.0), np.zeros(4), np.zeros((4, 0))) != Lsf(
        np.arange(4.0), np.zeros(4), np.zeros((4, 0))
    )


def test_an_equality_of_its_own_stays_and_is_inherited():
    class ByName(ShortRepr):
        def __eq__(self, other: object) -> bool:
            return isinstance(other, ByName) and other.name == self.name

        __hash__ = None

    @dataclass(frozen=True)
    class Named(ByName):
        name: str
        samples: np.ndarray

    assert Named("a", np.zeros(2)) == Named("a", np.ones(2))
    assert repr(Named("a", np.zeros(2))) == "<Named: name 'a', samples array of 2>"


def test_like_arrays_they_have_no_hash(edge):
    with pytest.raises(TypeError, match="unhashable"):
        hash(edge[1].mtf)


@dataclass(frozen=True)
class Flat:
    """A model of a 2-D OTF that holds an array."""

    heights: np.ndarray


def uncertain_response() -> Response:
    rng = np.random.default_rng(6)
    places, latent = np.arange(11) * 0.1, rng.normal(size=(2, 3))
    return Response(
        Esf(places, rng.normal(size=11), rng.normal(size=(11, 2)), latent),
        Lsf(places, rng.normal(size=11), rng.normal(size=(11, 2)), latent),
        Mtf(places, rng.normal(size=11) + 1j, rng.normal(size=(11, 2)) + 1j, latent),
        gsd_m=0.7,
    )


@pytest.mark.parametrize("name", ["esf", "lsf", "mtf"])
def test_a_curve_equals_its_copy_and_differs_in_any_field(name):
    curve = getattr(uncertain_response(), name)
    assert pickle.loads(pickle.dumps(curve)) == curve
    for field in fields(curve):
        assert replace(curve, **{field.name: 1.1 * getattr(curve, field.name)}) != curve


def test_whatever_holds_curves_equals_its_copy(edge):
    plane = Otf2d(Flat(np.array([1.0, math.nan])), (1.0, 2.0))
    for one in (uncertain_response(), plane, edge[1], edge[1].response):
        assert pickle.loads(pickle.dumps(one)) == one
    assert replace(uncertain_response(), rer_centre="peak") != uncertain_response()
    assert replace(plane, model=Flat(np.zeros(2))) != plane
    assert replace(plane, gsd_m=(2.0, 1.0)) != plane


def test_what_was_computed_already_is_no_difference():
    read, unread = uncertain_response(), uncertain_response()
    _ = read.mtf.std, read.esf.covariance_factor, read.mtf_nyquist
    assert read == unread
    assert len(pickle.dumps(read)) == len(pickle.dumps(unread))
    assert pickle.loads(pickle.dumps(read)).mtf_nyquist == read.mtf_nyquist
