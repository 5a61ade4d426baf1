"""Stars measured against the truth of their simulation, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from periodic_scenes import CYCLES, FREQ, STATED, errors_of, measured_star, star_scene
from scipy.ndimage import zoom

import acutance as ac
from acutance.errors import NoStarError, OptionError, RegionError
from acutance.optics import Sharpening
from acutance.raster import Gsd, Image
from acutance.simulate import Noise, reference_systems
from acutance.targets import QUESTIONS
from acutance.targets.periodic import StarOptions, measure_star
from acutance.targets.periodic.star_find import find_star


def _errors(found, truth):
    """Errors across, along and of the mean, with their standard deviations."""
    curves = (found.across.mtf, found.along.mtf, found.mean_mtf)
    truths = (truth.mtf_toward(0.0, FREQ), truth.mtf_toward(90.0, FREQ), truth.mtf_mean(FREQ))
    pairs = [errors_of(curve, true) for curve, true in zip(curves, truths, strict=True)]
    return np.array([error for error, _ in pairs]), np.array([std for _, std in pairs])


def _names(checks):
    return [check.name for check in checks]


@pytest.mark.parametrize("name", ["gaussian", "diffraction", "asymmetric"])
def test_whole_curves_with_stated_levels(name):
    found, truth = measured_star(name)
    error, std = _errors(found, truth)
    assert np.sqrt(np.mean(error**2)) < 0.005
    assert np.max(np.abs(error / std)) < 4.0
    assert np.all(std < 0.015)
    row, _ = found.centre
    assert abs(row.value - 36.2) < 0.02 + (0.5 if name == "asymmetric" else 0)
    assert found.trusted


@pytest.mark.parametrize("wave", ["sine", "square"])
def test_without_noise_what_the_modes_leave_is_no_signal(wave):
    """An aperture is none of them: taken for signal, its rest made an RER of half the true one."""
    sensor = reference_systems()["diffraction"]
    image, _ = ac.simulate.star(sensor, wave=wave)
    options = StarOptions(wave=wave, dark=200.0, bright=1200.0, level_std=1.0)
    found, true = measure_star(image, cycles=36, options=options), sensor.response_along(0.0)
    assert found.trusted
    for name, most in {"rer": 0.01, "fwhm_px": 0.02, "mtf_nyquist": 0.001}.items():
        seen = getattr(found.across, name)
        error = seen.value - float(getattr(true, name))
        assert abs(error) < min(2.5 * seen.std, most), name


def test_a_shape_that_no_mode_follows_is_seen_in_the_residuals():
    found, truth = measured_star("echo")
    error, std = _errors(found, truth)
    own = found.transfer.model.shape_error
    assert own is not None
    assert np.max(own.std) > 0.01
    assert np.sqrt(np.mean((error / std) ** 2)) < 1.5
    without = replace(found.transfer.model, shape_error=None)
    plain = np.linalg.norm(without.factor(FREQ, np.zeros(FREQ.size)), axis=1)
    # Errors are 4 deviations without it.
    assert np.sqrt(np.mean((error[0] / plain) ** 2)) > 2.5
    light = found.without_details().across.mtf(0.4)
    assert light.std == pytest.approx(found.across.mtf(0.4).std, rel=0.01)


def test_a_plain_star_has_no_such_error():
    found, _ = measured_star("gaussian")
    assert np.max(found.transfer.model.shape_error.std) < 0.3 * found.across.mtf(0.25).std


def test_long_kernels_are_followed():
    """States about the middle alone leave residuals, and a deviation of 0.05 at 0.5 c/px."""
    found, truth = measured_star("long kernel")
    error, std = _errors(found, truth)
    assert np.sqrt(np.mean((error / std) ** 2)) < 1.5
    assert np.all(std < 0.02)
    assert np.max(found.transfer.model.shape_error.std) < 0.01


def test_square_wave_and_fan():
    image, truth = star_scene(wave="square", start_deg=30.0, sweep_deg=100.0)
    found = measure_star(image, cycles=CYCLES, options=StarOptions("square", 200.0, 1200.0, 1.0))
    error = np.array([found.mean_mtf(f).value for f in FREQ]) - truth.mtf_mean(FREQ)
    assert np.sqrt(np.mean(error**2)) < 0.005
    assert found.star.sweep_deg == pytest.approx(100.0, abs=4)
    # Spokes at 30..130 degrees have normals at 120..220, which is -60..40.
    assert found.mtf_at(80.0)(0.4).std > 1.5 * found.mtf_at(-10.0)(0.4).std


@pytest.mark.parametrize(("start_deg", "sweep_deg"), [(10.0, 120.0), (-151.0, 200.0), (4.0, 336.0)])
def test_a_fan_ends_where_its_spokes_do(start_deg, sweep_deg):
    """Ends anywhere in a sector of two cycles, and a gap of less than one."""
    image, truth = star_scene(wave="square", start_deg=start_deg, sweep_deg=sweep_deg)
    found = measure_star(image, cycles=CYCLES, options=StarOptions("square", 200.0, 1200.0, 1.0))
    assert found.star.sweep_deg == pytest.approx(sweep_deg, abs=4)
    middle_deg = found.star.first_deg + 0.5 * (found.star.sweep_deg - sweep_deg)
    assert abs((middle_deg - start_deg + 180) % 360 - 180) < 4
    assert found.trusted
    own, true = found.across.mtf_nyquist, truth.mtf_toward(0.0, 0.5)
    assert abs(own.value - true) < 3 * own.std
    assert own.std < 0.02


def test_the_mean_of_a_fan_is_over_the_directions_in_which_it_shows_nyquist():
    # A sharpened sensor differs between the axes and the diagonals.
    image, truth = star_scene(
        "sharpened", start_deg=156.0, sweep_deg=110.0, cycles=48, radius_px=75.0,
        centre=(81.3, 82.1), shape=(164, 164),
    )  # fmt: skip
    found = measure_star(image, cycles=48, options=STATED)
    held = found.directions_deg
    # 5 px at either side are 19 degrees at the 15 px where 48 cycles are 0.5 c/px.
    assert np.ptp(held) < 110.0 - 2 * 18.0
    error = np.array([found.mean_mtf(f).value for f in FREQ]) - truth.mtf_mean(FREQ, held)
    std = np.array([found.mean_mtf(f).std for f in FREQ])
    assert np.max(np.abs(error / std)) < 3.0


def test_axes_phases_and_gsds_are_kept():
    image, truth = star_scene("trail")
    found = measure_star(
        Image.from_array(image, gsd_m=Gsd(0.4, 0.7)), cycles=CYCLES, options=STATED
    )
    assert found.measured_directions == ("across", "along")
    truths = {"across": 0.0, "along": 90.0}
    truths = {name: truth.sensor.response_along(angle) for name, angle in truths.items()}
    # The system differs between the axes by more than what is allowed for.
    assert truths["across"].mtf_nyquist.value - truths["along"].mtf_nyquist.value > 0.05
    for name, response in truths.items():
        one = found.directions[name]
        assert one.mtf_nyquist.value == pytest.approx(response.mtf_nyquist.value, abs=0.02)
        assert one.mtf.otf[35].imag == pytest.approx(response.mtf.otf[35].imag, abs=0.02)
    # A trail towards higher columns has a positive phase.
    assert found.across.mtf.otf[35].imag > 0.05
    for name, gsd_m in (("across", 0.7), ("along", 0.4)):
        one = found.directions[name]
        assert one.gsd_m == pytest.approx(gsd_m)
        assert one.fwhm_m.value == pytest.approx(gsd_m * one.fwhm_px.value)
    # An image that was flown over along its rows shows the same with the axes exchanged.
    turned = measure_star(
        Image.from_array(image.T, gsd_m=Gsd(0.7, 0.4), along_track="x"), cycles=CYCLES,
        options=STATED,
    )  # fmt: skip
    assert turned.image.along_track == "x"
    for name in truths:
        one, other = found.directions[name], turned.directions[name]
        assert one.mtf_nyquist.value == pytest.approx(other.mtf_nyquist.value, abs=2e-3)
        assert one.fwhm_m.value == pytest.approx(other.fwhm_m.value, rel=5e-3)


def test_without_levels_the_interval_widens_and_says_so():
    stated, truth = measured_star("halo")
    free, _ = measured_star("halo", stated=False)
    error, std = _errors(free, truth)
    assert np.all(np.abs(error) < 3 * std)
    assert free.mean_mtf(0.3).std > 3 * stated.mean_mtf(0.3).std
    assert _names(free.failed_checks) == ["level"]
    assert free.verdict.word == "usable"


@pytest.mark.parametrize(
    ("dark", "bright"), [(100.0, 800.0), (-400.0, 1800.0), (300.0, 1300.0), (0.0, 4095.0)]
)
def test_levels_of_another_image_are_invalid(dark, bright):
    """The middle of the second is right, and the contrast of the third."""
    image, _ = star_scene()
    found = measure_star(image, cycles=CYCLES, options=StarOptions(dark=dark, bright=bright))
    assert found.verdict.word == "invalid"
    assert "the stated levels" in found.verdict.sentence


@pytest.mark.parametrize(("number", "name"), list(enumerate(reference_systems())))
def test_true_levels_are_those_of_the_image(number, name):
    found, _ = measured_star(name, 20 + number)
    (check,) = (one for one in found.checks if one.name == "stated_levels")
    assert check.passed
    assert check.value < 0.01


def test_without_levels_none_are_judged():
    found, _ = measured_star(stated=False)
    assert "stated_levels" not in _names(found.checks)


def test_deviations_are_those_of_the_errors():
    """Over eight systems: deviations 0.8 or 1.25 times as large lie outside."""
    squares, inside = [], []
    for number, name in enumerate(reference_systems()):
        found, truth = measured_star(name, 20 + number)
        for angle in (0.0, 45.0, 90.0, 135.0):
            error, std = errors_of(found.mtf_at(angle), truth.mtf_toward(angle, FREQ))
            squares.append(np.mean((error / std) ** 2))
            inside.append(np.abs(error) < 1.96 * std)
    assert 0.75 < np.sqrt(np.mean(squares)) < 1.03
    assert np.mean(inside) > 0.93


def test_priors_are_as_wide_as_those_of_the_benchmark():
    """What the prior says shows where a star says least: three times as much lies outside."""
    free = [measured_star(name, stated=False)[0] for name in ("gaussian", "wide", "halo")]
    relative = np.mean([one.level.std / one.level.value for one in free])
    assert relative == pytest.approx(0.08, rel=0.15)


def test_shift_gain_and_region_leave_the_curve():
    image, _ = star_scene()
    one, _ = measured_star(stated=False)
    wide = np.full((92, 102), float(image.mean()))
    wide[10:82, 20:92] = 3 * image + 50
    two = measure_star(wide, (10, 20, 72, 72), cycles=CYCLES)
    assert two.mean_mtf(0.4).value == pytest.approx(one.mean_mtf(0.4).value, abs=1e-6)
    assert two.star.row == pytest.approx(one.star.row + 10, abs=1e-6)
    assert two.image.roi == (10, 20, 72, 72)


def test_cycles_are_counted_or_refused():
    image, _ = star_scene()
    assert measure_star(image, cycles=None).star.cycles == CYCLES
    with pytest.raises(NoStarError, match=r"30 cycles was asked for.*show 24"):
        measure_star(image, cycles=30)
    with pytest.raises(OptionError, match="3 cycles"):
        measure_star(image, cycles=3)


@pytest.mark.parametrize("wave", ["sine", "square"])
@pytest.mark.parametrize("cycles", [4, 5, 7, 9])
def test_few_cycles_are_found_and_counted(wave, cycles):
    """A tenth of a turn holds less than a cycle, and another number moves the centre off."""
    image, truth = ac.simulate.star(
        reference_systems()["gaussian"], cycles=cycles, shape=(112, 112), wave=wave, snr=100,
        rng=np.random.default_rng(cycles),
    )  # fmt: skip
    for stated in (cycles, None):
        found = find_star(image, stated)
        assert found.cycles == cycles
        assert math.hypot(found.row - truth.star.row, found.col - truth.star.col) < 2.5


def test_a_star_seen_aslant_is_refused_with_a_word_for_it():
    """Its rings show too few cycles, or a harmonic that no wave has: neither is the reason."""
    image, _ = star_scene()
    with pytest.raises(NoStarError, match=r"slanted view or pixels that are not square"):
        measure_star(zoom(image, (0.8, 1.0)), cycles=CYCLES)
    assert "slanted view" in QUESTIONS["wave"].advice


@pytest.mark.parametrize("part", ["whole", "three quarters"])
@pytest.mark.parametrize("off", [-2, -1, 1, 2])
def test_a_number_of_cycles_next_to_the_true_one_is_refused(part, off):
    """A wrong number moves the centre, and explains a third of the rings about it."""
    image, _ = star_scene()
    if part == "three quarters":
        middle = image.shape[0] // 2
        image[:middle, middle:] = np.nan
    asked = rf"{CYCLES + off} cycles was asked for.*show {CYCLES}"
    with pytest.raises(NoStarError, match=asked):
        measure_star(image, cycles=CYCLES + off)


def test_a_star_cut_off_by_the_border_is_measured():
    image, truth = star_scene()
    found = measure_star(image[:, :48], cycles=CYCLES, options=STATED)
    error, std = _errors(found, truth)
    assert np.max(np.abs(error / std)) < 4.0
    assert found.star.sweep_deg < 360


def test_noise_that_correlates_in_any_direction_widens_the_intervals():
    image, _ = star_scene(snr=None)
    white = np.random.default_rng(4).standard_normal(image.shape)
    smooth = (white + 0.5 * np.roll(white, (1, -1), axis=(0, 1))) / math.hypot(1.0, 0.5)
    smooth = (smooth + 0.5 * np.roll(smooth, 1, axis=0)) / math.hypot(1.0, 0.5)
    one, other = (
        measure_star(image + 10 * noise, cycles=CYCLES, options=STATED) for noise in (white, smooth)
    )
    assert other.mean_mtf(0.3).std > 1.2 * one.mean_mtf(0.3).std
    assert "correlated_noise" in _names(other.failed_checks)
    assert "correlated_noise" not in _names(one.failed_checks)


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


def test_structure_only_next_to_missing_pixels_is_no_star():
    image = np.full((60, 60), math.nan)
    image[5:20, 5:20] = 500 + np.random.default_rng(0).standard_normal((15, 15))
    image[30:34] = 500 + 300 * np.sign(np.sin(np.arange(60)))
    with pytest.raises(NoStarError, match="next to pixels without data"):
        measure_star(image, cycles=CYCLES)


def test_clipped_star_fails_by_name():
    image, _ = star_scene(noise=Noise(read=10.0, saturation=1100.0), snr=None)
    found = measure_star(image, cycles=CYCLES)
    assert "saturation" in _names(found.failed_checks)


@pytest.mark.parametrize("seed", range(3))
def test_a_sine_star_taken_for_a_square_one_is_refused(seed):
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
    image, _ = ac.simulate.star(sensor, snr=100, rng=np.random.default_rng(seed))
    said = r"square star of 36 cycles .*--wave sine.*state it \(cycles, --cycles\)|did not settle"
    with pytest.raises(NoStarError, match=said):
        measure_star(image, options=StarOptions(wave="square"))


def test_wrong_wave_fails_by_name():
    image, _ = star_scene(wave="square")
    assert "wave" in _names(measure_star(image, cycles=CYCLES).failed_checks)


def test_zero_noise_and_missing_pixels():
    image, truth = star_scene(snr=None)
    image[34:37, 14:26] = math.nan
    found = measure_star(image, cycles=CYCLES, options=STATED)
    error, _ = _errors(found, truth)
    assert np.max(np.abs(error)) < 0.002


def test_without_noise_nothing_is_blamed_on_the_target():
    for wave in ("sine", "square"):
        image, _ = star_scene(snr=None, wave=wave)
        options = StarOptions(wave=wave, dark=200.0, bright=1200.0)
        assert measure_star(image, cycles=CYCLES, options=options).trusted
    # What really lies on it is still seen.
    image[44:56, 44:56] += 150.0
    failed = _names(measure_star(image, cycles=CYCLES, options=options).failed_checks)
    assert "outliers" in failed


def test_options_are_refused_by_name():
    with pytest.raises(OptionError, match="dark and bright, or neither"):
        StarOptions(dark=1.0)
    with pytest.raises(OptionError, match="lower one"):
        StarOptions(dark=2.0, bright=1.0)
    with pytest.raises(OptionError, match="wave"):
        StarOptions(wave="triangle")
    image, _ = star_scene()
    with pytest.raises(OptionError, match="method"):
        measure_star(image, method="rings")


def test_document():
    found, _ = measured_star()
    document = found.to_dict()
    assert document["kind"] == "star"
    assert document["star"]["cycles"] == CYCLES
    assert document["across"]["mtf_nyquist"]["std"] > 0
    assert len(document["mean"]["mtf"]["value"]) == 101
    assert len(document["rings"]["freq_cpp"]) == len(document["rings"]["modulation"])


def test_spokes_too_fine_to_show_their_level_ask_for_it():
    """Sharpened, with .17 c/px at the rim: how far that was raised nothing shows."""
    one = np.array([0.15, 0.22, 0.26, 0.22, 0.15])
    kernel = -0.8 * np.outer(one, one)
    kernel[2, 2] += 1.8
    sharp = Sharpening(tuple(map(tuple, kernel.tolist())))
    sensor = ac.Sensor([ac.optics.Gaussian(0.5), ac.optics.Detector(), sharp])
    image, _ = ac.simulate.star(
        sensor, rng=np.random.default_rng(1), snr=50.0, centre=(46.2, 45.0), shape=(92, 92),
        radius_px=30.0, cycles=30,
    )  # fmt: skip
    with pytest.raises(NoStarError, match=r"0\.17 c/px, and do not show it\. State the levels"):
        measure_star(image, cycles=30)
    stated = measure_star(image, cycles=30, options=StarOptions(dark=200.0, bright=1200.0))
    true = float(sensor.response_along(0.0).mtf_nyquist)
    assert abs(stated.across.mtf_nyquist.value - true) < 3 * stated.across.mtf_nyquist.std
