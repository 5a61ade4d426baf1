"""A softness that all objects of a scene have: it can be stated, and enters value and deviation."""

import numpy as np
import pytest
from bare_ground import all_of_softness

import acutance as ac
from acutance import simulate
from acutance.curves import Estimate, Otf2d
from acutance.errors import OptionError
from acutance.raster import Gsd
from acutance.report.figures.scene_sensor import edges_seen
from acutance.scan.scan_identity import scan_identity
from acutance.scan.stated_objects import OtfBehindObjects, behind_objects

SENSOR = simulate.reference_systems()["gaussian"]
SOFTNESS_PX = 0.25


class GaussianOtf:
    """A Gaussian of standard deviation `sigma_px`, whose logarithm at Nyquist is uncertain."""

    band_cpp = 2.0

    def __init__(self, sigma_px, error=0.0):
        self.sigma_px, self.error = sigma_px, error

    def otf(self, u, v):
        return np.exp(-2 * np.pi**2 * self.sigma_px**2 * (u**2 + v**2)).astype(complex)

    def factor(self, u, v):
        return (self.error * 4 * (u**2 + v**2) * self.otf(u, v))[:, None]


def test_the_border_is_divided_out_in_every_direction():
    softness = ac.ScanOptions(target_softness_m=0.3)
    found = behind_objects(GaussianOtf(0.5), softness, Gsd(row_m=1.0, col_m=2.0), {})
    freq, still = np.array([0.1, 0.5, 1.0]), np.zeros(3)
    for (u, v), squares in (
        ((freq, still), 0.25 - 0.15**2),
        ((still, freq), 0.25 - 0.3**2),
        ((0.6 * freq, 0.8 * freq), 0.25 - 0.36 * 0.15**2 - 0.64 * 0.3**2),
    ):
        expected = np.exp(-2 * np.pi**2 * squares * freq**2)
        np.testing.assert_allclose(found.otf(u, v), expected, rtol=1e-12)
    assert found.otf(np.zeros(1), np.zeros(1)) == 1
    assert not found.factor(np.zeros(1), np.zeros(1)).any()


def test_its_deviation_is_that_of_draws():
    sigma = Estimate(0.2, 0.05)
    found = behind_objects(GaussianOtf(0.5), ac.ScanOptions(target_softness_px=sigma), None, {})
    mtf = Otf2d(found).response(0.0).mtf
    drawn = np.random.default_rng(1).normal(sigma.value, sigma.std, 100_000)
    behind = np.exp(-2 * np.pi**2 * 0.25 * (0.25 - drawn**2))
    here = mtf(0.5)
    assert here.value == pytest.approx(behind.mean(), rel=0.02)
    assert here.std == pytest.approx(behind.std(), rel=0.1)


def test_beyond_the_band_nothing_is_amplified():
    found = behind_objects(GaussianOtf(0.3), ac.ScanOptions(target_softness_px=0.4), None, {})
    far, still = np.array([2.0, 2.5, 4.0]), np.zeros(3)
    np.testing.assert_allclose(found.otf(far, still), GaussianOtf(0.3).otf(far, still))


def test_nothing_stated_changes_nothing():
    sensor = GaussianOtf(0.4)
    assert behind_objects(sensor, ac.ScanOptions(), None, {}) is sensor


@pytest.fixture(scope="module")
def image():
    options = all_of_softness(SOFTNESS_PX)
    # Of this one no part is softer than others: its budget has no term for that.
    rng = np.random.default_rng(10)
    return simulate.landscape(SENSOR, shape=(600, 600), snr=100, options=options, rng=rng)[0]


@pytest.fixture(scope="module")
def stated(image, few_forms):
    options = ac.ScanOptions(target_softness_px=Estimate(SOFTNESS_PX, 0.03))
    with few_forms():
        return ac.scan_scene(image, gsd_m=2.0, options=options)


@pytest.fixture(scope="module")
def plain(image, few_forms):
    with few_forms():
        return ac.scan_scene(image, gsd_m=2.0)


def test_the_sensor_is_the_one_behind_the_objects(plain, stated):
    expected = float(np.abs(SENSOR.otf(np.array([0.5]), np.array([0.0])))[0])
    for name in ("across", "along"):
        before, after = getattr(plain, name).mtf_nyquist, getattr(stated, name).mtf_nyquist
        assert before.value + 4 * before.std < expected
        assert abs(after.value - expected) < 3 * after.std
    np.testing.assert_array_equal(plain.edges.mtf_nyquist, stated.edges.mtf_nyquist)
    corner = stated.at(0, 0).across.mtf_nyquist
    assert abs(corner.value - expected) < 3 * corner.std


def test_the_budget_has_it_as_a_term_of_its_own(stated):
    terms = {(term.direction, term.name): term for term in stated.budget}
    assert set(terms) == {
        (direction, name)
        for direction in ("across", "along")
        for name in ("fit", "target_softness", "shared_softness")
    }
    for direction in ("across", "along"):
        own = [term for (way, _), term in terms.items() if way == direction]
        for number in ("mtf_nyquist", "rer", "fwhm_px"):
            assert sum(one.share[number] for one in own) == pytest.approx(1)
            total = np.linalg.norm([one.std[number] for one in own])
            assert total == pytest.approx(getattr(getattr(stated, direction), number).std)
        nyquist = terms[direction, "target_softness"].std["mtf_nyquist"]
        value = getattr(stated, direction).mtf_nyquist.value
        assert nyquist == pytest.approx(value * 0.5 * np.pi**2 * 2 * SOFTNESS_PX * 0.03, rel=0.05)


@pytest.mark.usefixtures("undrawn")
def test_it_is_in_the_document_and_in_words(stated):
    again = ac.Record.from_dict(stated.to_dict())
    assert again.options["target_softness_px"] == {"value": SOFTNESS_PX, "std": 0.03}
    assert again == stated.record
    text = ac.report.text(stated)
    assert "stated softness 0.250 ± 0.030 px" in text
    assert "std of MTF at Nyquist: across: softness of the target's border 9" in text
    page = ac.report.page(stated)
    assert "Of what all of them have in common 0.250 ± 0.030 px are stated" in page
    light = stated.without_details()
    assert light.across.mtf_nyquist == stated.across.mtf_nyquist
    assert isinstance(light.otf.model.base, OtfBehindObjects)


def test_it_is_no_part_of_what_is_kept(image):
    source = ac.Image.of(image)
    box = ac.Box(0, 0, 600, 600)
    one, other = (
        scan_identity([source], box, None, None, ac.ScanOptions(target_softness_px=softness))
        for softness in (None, 0.2)
    )
    assert one == other


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"target_softness_m": 0.3}, "needs a GSD"),
        ({"target_softness_px": 0.5}, "hides the sensor"),
    ],
)
@pytest.mark.parametrize(
    "scan", [ac.scan_scene, lambda image, **how: ac.scan_bands([image], **how)]
)
def test_what_cannot_be_used_is_refused_before_the_scan(scan, options, words):
    seen = []
    with pytest.raises(OptionError, match=words):
        scan(
            np.zeros((100, 100)), options=ac.ScanOptions(**options),
            progress=lambda done, total: seen.append(done),
        )  # fmt: skip
    assert not seen


@pytest.mark.parametrize(
    "given", [{"target_softness_m": 0.1, "target_softness_px": 0.1}, {"target_softness_px": -0.1}]
)
def test_statements_that_mean_nothing(given):
    with pytest.raises(OptionError, match=r"ScanOptions: .*softness"):
        ac.ScanOptions(**given)


def test_edges_are_drawn_beside_what_they_show(plain, stated):
    one, other = edges_seen(plain), edges_seen(stated)
    np.testing.assert_allclose(one.sensor, other.sensor, atol=1e-9)
    at = (np.array([300.0]), np.array([300.0]), np.array([0.0]))
    assert stated.mtf_nyquist_at(*at) > 1.2 * plain.mtf_nyquist_at(*at)
