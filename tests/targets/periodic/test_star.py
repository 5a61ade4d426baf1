"""Stars measured against the truth of their simulation, and what is refused."""

import math

import numpy as np
import pytest

import acutance as ac
from acutance.errors import NoStarError, OptionError, RegionError
from acutance.simulate import Noise, reference_systems, star
from acutance.targets.periodic.star import measure_star
from acutance.targets.periodic.star_options import StarOptions

FREQ = np.arange(10, 51, 5) / 100
STATED = StarOptions(dark=200.0, bright=1200.0, level_std=1.0)


def _star(name="gaussian", seed=1, **given):
    given = {"snr": 100.0, "centre": (50.2, 48.9), "shape": (100, 100), "radius_px": 44.0, **given}
    return star(reference_systems()[name], rng=np.random.default_rng(seed), **given)


def _errors(measurement, truth):
    curves = (measurement.across.mtf, measurement.along.mtf, measurement.mtf)
    truths = (
        truth.mtf_toward(0.0, FREQ), truth.mtf_toward(90.0, FREQ), truth.mtf_mean(FREQ),
    )  # fmt: skip
    found = [[curve(f) for f in FREQ] for curve in curves]
    error = np.array([[e.value for e in row] for row in found]) - np.array(truths)
    return error, np.array([[e.std for e in row] for row in found])


@pytest.mark.parametrize("name", ["gaussian", "diffraction", "asymmetric"])
def test_whole_curves_with_stated_levels(name):
    image, truth = _star(name)
    found = measure_star(image, options=STATED)
    error, std = _errors(found, truth)
    assert np.sqrt(np.mean(error**2)) < 0.005
    assert np.max(np.abs(error / std)) < 4.0
    assert np.all(std < 0.015)
    row, _ = found.centre
    assert abs(row.value - 50.2) < 0.02 + (0.5 if name == "asymmetric" else 0)
    assert found.trusted


def test_square_wave_and_fan():
    image, truth = _star(wave="square", start_deg=30.0, sweep_deg=100.0)
    found = measure_star(image, options=StarOptions("square", 200.0, 1200.0, 1.0))
    error = np.array([found.mtf(f).value for f in FREQ]) - truth.mtf_mean(FREQ)
    assert np.sqrt(np.mean(error**2)) < 0.005
    assert found.star.sweep_deg == pytest.approx(100.0, abs=25)
    # Spokes at 30..130 degrees have normals at 120..220, which is -60..40.
    assert found.mtf_at(80.0)(0.4).std > 1.5 * found.mtf_at(-10.0)(0.4).std


def test_the_mean_of_a_fan_is_over_the_directions_in_which_it_shows_nyquist():
    # A sharpened sensor differs between the axes and the diagonals.
    image, truth = _star(
        "sharpened", start_deg=156.0, sweep_deg=110.0, cycles=48, radius_px=90.0,
        centre=(101.3, 102.1), shape=(204, 204),
    )  # fmt: skip
    found = measure_star(image, cycles=48, options=STATED)
    held = found.directions_deg
    # 5 px beside either side are 19 degrees at the 15 px where 48 cycles are 0.5 c/px.
    assert np.ptp(held) < 110.0 - 2 * 18.0
    error = np.array([found.mtf(f).value for f in FREQ]) - truth.mtf_mean(FREQ, held)
    std = np.array([found.mtf(f).std for f in FREQ])
    assert np.max(np.abs(error / std)) < 3.0


def test_without_levels_the_interval_widens_and_says_so():
    image, truth = _star("halo")
    stated, free = measure_star(image, options=STATED), measure_star(image)
    error, std = _errors(free, truth)
    assert np.all(np.abs(error) < 3 * std)
    assert free.mtf(0.3).std > 3 * stated.mtf(0.3).std
    assert [check.name for check in free.failed_checks] == ["level"]


def test_intervals_hold_the_truth_over_random_stars():
    hits, z = [], []
    for seed in range(4):
        image, truth = _star(("gaussian", "defocused")[seed % 2], seed, start_deg=seed * 11.0)
        error, std = _errors(measure_star(image, options=STATED), truth)
        hits.append(np.abs(error) < 1.96 * std)
        z.append(error / std)
    assert np.mean(hits) > 0.85
    assert 0.4 < np.sqrt(np.mean(np.square(z))) < 1.4


def test_shift_gain_and_region_leave_the_curve():
    image, _ = _star()
    one = measure_star(image)
    wide = np.full((120, 130), float(image.mean()))
    wide[10:110, 20:120] = 3 * image + 50
    two = measure_star(wide, (10, 20, 100, 100))
    assert two.mtf(0.4).value == pytest.approx(one.mtf(0.4).value, abs=1e-6)
    assert two.star.row == pytest.approx(one.star.row + 10, abs=1e-6)
    assert two.image.roi == (10, 20, 100, 100)
    turned = measure_star(image.T)
    assert turned.along.mtf(0.4).value == pytest.approx(one.across.mtf(0.4).value, abs=2e-4)


def test_cycles_are_counted_or_refused():
    image, _ = _star()
    assert measure_star(image, cycles=None).star.cycles == 36
    with pytest.raises(NoStarError, match=r"40 cycles was asked for.*show 36"):
        measure_star(image, cycles=40)
    with pytest.raises(OptionError, match="3 cycles"):
        measure_star(image, cycles=3)


def test_a_star_cut_off_by_the_border_is_measured():
    image, truth = _star()
    found = measure_star(image[:, :66], options=STATED)
    error, std = _errors(found, truth)
    assert np.max(np.abs(error / std)) < 4.0
    assert found.star.sweep_deg < 360


def test_no_star():
    rng = np.random.default_rng(0)
    with pytest.raises(NoStarError):
        measure_star(rng.standard_normal((100, 100)))
    with pytest.raises(NoStarError, match="uniform"):
        measure_star(np.full((60, 60), 7.0))
    edge, _ = ac.simulate.edge(reference_systems()["gaussian"], snr=100, rng=rng)
    with pytest.raises(NoStarError):
        measure_star(edge)
    with pytest.raises(NoStarError):
        measure_star(np.pad(edge, 20, mode="reflect"), cycles=None)
    with pytest.raises(RegionError):
        measure_star(np.full((60, 60), math.nan))


def test_clipped_star_fails_by_name():
    image, _ = _star(noise=Noise(read=10.0, saturation=1100.0), snr=None)
    found = measure_star(image)
    assert "saturation" in [check.name for check in found.failed_checks]


def test_wrong_wave_fails_by_name():
    image, _ = _star(wave="square")
    assert "wave" in [check.name for check in measure_star(image).failed_checks]


def test_zero_noise_and_missing_pixels():
    image, truth = _star(snr=None)
    image[47:51, 20:36] = math.nan
    found = measure_star(image, options=STATED)
    error, _ = _errors(found, truth)
    assert np.max(np.abs(error)) < 0.002


def test_without_noise_nothing_is_blamed_on_the_target():
    for wave in ("sine", "square"):
        image, _ = _star(snr=None, wave=wave)
        options = StarOptions(wave=wave, dark=200.0, bright=1200.0)
        assert measure_star(image, options=options).trusted
    # What really lies on it is still seen.
    image[60:80, 60:80] += 150.0
    failed = [check.name for check in measure_star(image, options=options).failed_checks]
    assert "outliers" in failed


def test_options_are_refused_by_name():
    with pytest.raises(OptionError, match="dark and bright, or neither"):
        StarOptions(dark=1.0)
    with pytest.raises(OptionError, match="lower one"):
        StarOptions(dark=2.0, bright=1.0)
    with pytest.raises(OptionError, match="wave"):
        StarOptions(wave="triangle")
    image, _ = _star()
    with pytest.raises(OptionError, match="method"):
        measure_star(image, method="rings")


def test_document():
    image, _ = _star()
    document = measure_star(image, gsd_m=0.5).to_dict()
    assert document["kind"] == "star"
    assert document["star"]["cycles"] == 36
    assert document["across"]["mtf_nyquist"]["std"] > 0
    assert len(document["mean"]["mtf"]["value"]) == 101
    assert len(document["rings"]["freq_cpp"]) == len(document["rings"]["modulation"])
    assert document["across"]["fwhm_m"]["value"] == pytest.approx(
        0.5 * document["across"]["fwhm_px"]["value"]
    )
