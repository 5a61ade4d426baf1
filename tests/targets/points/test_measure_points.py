"""Points against known truth: curves, places, coverage, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import acutance as ac
from acutance.targets.points import PointsOptions
from acutance.targets.points.first_fit import fit_first_gaussian
from acutance.targets.points.fit import fit_points
from acutance.targets.points.stamps import cut_stamps

STARS = Path(__file__).parents[4] / "shared" / "data" / "15_tetra3_stars.tif"
PIXEL = ac.optics.Detector()
GAUSSIAN = ac.Sensor([ac.optics.Gaussian(0.45), PIXEL])


def image_of(sensor, **options):
    return ac.simulate.points(sensor, **options)


def worst(found, truth):
    """Largest error of both slices up to Nyquist."""
    return max(
        float(np.abs(response.mtf.value[:51] - truth.response(name).mtf.value[:51]).max())
        for name, response in (("across", found.across), ("along", found.along))
    )


@pytest.mark.parametrize(
    ("name", "most"),
    [
        ("gaussian", 1e-4),
        # Restored products reach as far as rings do, and the prior has both.
        ("diffraction", 0.025),
        ("halo", 0.015),
        ("asymmetric", 0.015),
        ("smeared", 0.015),
    ],
)
def test_without_noise_both_slices_are_the_truth(name, most):
    image, truth = image_of(ac.simulate.reference_systems()[name])
    found = ac.measure_points(image, positions=truth.positions)
    assert worst(found, truth) < most


@pytest.mark.parametrize("name", ["diffraction", "halo", "defocused"])
def test_intervals_hold_without_noise(name):
    """No drawn sensor is the true one: what the prior leaves of it, errors of 4 to 21 deviations,
    is noise of .0004 of the peak."""
    image, truth = image_of(ac.simulate.reference_systems()[name])
    across, true = ac.measure_points(image).across, truth.response("across")
    for freq_cpp in (0.25, 0.5):
        seen = across.mtf(freq_cpp)
        assert abs(seen.value - true.mtf(freq_cpp).value) < 3 * seen.std
    assert abs(across.rer.value - true.rer.value) < 3 * across.rer.std


def test_the_lsf_is_the_integral_of_a_leaning_psf_and_not_its_slice():
    """Smear at 45 degrees: the slice through the peak would be narrower than the LSF."""
    smear = ac.Sensor([ac.optics.Gaussian(0.35), ac.optics.Smear(0.6, "along"), PIXEL])
    image, truth = image_of(smear)
    found = ac.measure_points(image)
    for name, response in (("across", found.across), ("along", found.along)):
        assert response.fwhm_px.value == pytest.approx(truth.response(name).fwhm_px.value, abs=0.02)
    assert found.along.fwhm_px.value > found.across.fwhm_px.value + 0.02


def test_the_published_gaussian_takes_the_pixel_for_blur():
    """Its FWHM is that of a Gaussian fitted to pixel values: exact for points sampled as points."""
    image, truth = image_of(ac.simulate.reference_systems()["wide"])
    found = ac.measure_points(image, method="gaussian-2003")
    assert found.across.fwhm_px.value == pytest.approx(1.57, abs=0.03)
    assert worst(found, truth) < 0.03
    assert found.details.published is not None
    assert len(found.details.published.mirrors) == 20


def test_the_document_holds_what_outlives_the_pixels():
    image, truth = image_of(GAUSSIAN, snr=60, rng=np.random.default_rng(8))
    image[60, 8] += 3000.0
    found = ac.measure_points(image, surveyed=truth.positions + 0.4, gsd_m=0.7)
    document = found.to_dict()
    assert len(document["sources"]) == 20
    assert "hot pixel" in [one["reason"] for one in document["rejected"]]
    assert document["survey"]["rmse_cm"][0] == pytest.approx(70 * 0.013, rel=0.5)
    assert document["across"]["fwhm_m"]["value"] == pytest.approx(0.7 * found.across.fwhm_px.value)
    assert document["noise"]["std"] == pytest.approx(1000 / 60, rel=0.03)
    flux = np.array([one.flux.value for one in found.sources])
    assert np.abs(flux / truth.fluxes - 1).max() < 0.08


@pytest.mark.parametrize("change", ["gain", "shift", "transpose"])
def test_gain_place_and_transposition_leave_the_mtf_alone(change):
    places = ac.simulate.mirror_columns((12.3, 12.1), count=4)
    image, _ = image_of(GAUSSIAN, positions=places, snr=100, rng=np.random.default_rng(6))
    base = ac.measure_points(image, positions=places)
    if change == "gain":
        other = ac.measure_points(3.0 * image + 50.0, positions=places)
    elif change == "shift":
        padded = np.pad(image, ((3, 0), (0, 2)), mode="reflect")
        other = ac.measure_points(padded, (3, 0, *image.shape), positions=places + np.array([3, 0]))
    else:
        other = ac.measure_points(image.T, positions=places[:, ::-1])
    pair = (other.across, other.along)
    if change == "transpose":
        pair = pair[::-1]
    assert pair[0].mtf_nyquist.value == pytest.approx(base.across.mtf_nyquist.value, abs=5e-4)
    assert pair[1].mtf_nyquist.value == pytest.approx(base.along.mtf_nyquist.value, abs=5e-4)


def test_one_source_is_measured_with_wider_intervals():
    image, _ = image_of(
        GAUSSIAN, positions=[[15.3, 15.2]], shape=(31, 31), snr=80, rng=np.random.default_rng(2)
    )
    few = ac.measure_points(image)
    many, _ = image_of(GAUSSIAN, snr=80, rng=np.random.default_rng(2))
    assert few.across.mtf_nyquist.std > 1.5 * ac.measure_points(many).across.mtf_nyquist.std
    assert [check.name for check in few.failed_checks] == ["sources", "phase_gap_px"]


def test_sources_that_were_not_asked_for_do_not_disturb_the_others():
    image, truth = image_of(GAUSSIAN, snr=80, rng=np.random.default_rng(2))
    found = ac.measure_points(image, positions=truth.positions[:3])
    assert len(found.sources) == 3
    assert [one.reason for one in found.rejected] == ["left out"] * 17
    assert found.across.mtf_nyquist.value == pytest.approx(0.2344, abs=0.03)


def test_a_spot_that_is_no_point_is_unlike_the_others():
    image, truth = image_of(GAUSSIAN, snr=200, rng=np.random.default_rng(2))
    image[57:60, 8] += [250.0, 500.0, 250.0]
    image[58, 7:10] += [60.0, 0.0, 60.0]
    found = ac.measure_points(image)
    assert len(found.sources) == 20
    assert {one.reason for one in found.rejected} <= {"cosmic ray", "unlike"}
    assert np.abs(found.positions - truth.positions[0]).min() < 0.1


def test_noise_that_grows_with_the_light_is_seen():
    noise = ac.simulate.Noise(read=3.0, shot_gain=0.6)
    gains = []
    for seed in range(3, 6):
        image, truth = image_of(GAUSSIAN, noise=noise, peak=4000.0, rng=np.random.default_rng(seed))
        gains.append(ac.measure_points(image, positions=truth.positions).noise_gain)
    assert np.mean(gains) == pytest.approx(0.6, abs=0.3)
    assert min(gains) > 0


@pytest.mark.parametrize(
    ("image", "error", "message"),
    [
        (np.full((40, 40), 9.0), ac.TargetError, "no point source stands out"),
        (np.full((40, 40), np.nan), ac.RegionError, "hold data"),
        (np.zeros((4, 4)), ac.RegionError, "at least"),
        (np.random.default_rng(1).normal(size=(50, 50)), ac.TargetError, "point source"),
    ],
)
def test_images_without_points_are_refused(image, error, message):
    with pytest.raises(error, match=message):
        ac.measure_points(image)


def test_senseless_options_are_refused():
    image, _ = image_of(GAUSSIAN)
    for positions in ([1.0, 2.0], [[1.0, np.nan]], np.empty((0, 2))):
        with pytest.raises(ac.OptionError):
            ac.measure_points(image, positions=positions)
    with pytest.raises(ac.OptionError, match="no points method"):
        ac.measure_points(image, method="median")
    with pytest.raises(ac.OptionError, match="min_snr"):
        PointsOptions(min_snr=0.0)
    with pytest.raises(ac.TargetError, match="no source"):
        ac.measure_points(image, positions=[[60.0, 4.0]])


@pytest.mark.real
@pytest.mark.skipif(not STARS.is_file(), reason="the folder of real images is absent")
def test_saturated_stars_and_a_hot_pixel_are_rejected_by_name():
    image = ac.open_image(str(STARS))
    found = ac.measure_points(image, options=PointsOptions(min_snr=60.0))
    reasons = {(round(one.row), round(one.col)): one.reason for one in found.rejected}
    assert reasons[539, 228] == reasons[194, 302] == "saturated"
    assert reasons[206, 120] == "hot pixel"
    for row, col, across, along in (
        (38.93, 187.84, 1.40, 1.51),
        (527.97, 23.80, 1.51, 1.72),
        (345.55, 519.87, 1.43, 1.79),
    ):
        region = (max(int(row) - 18, 0), int(col) - 18, 37, 37)
        one = ac.measure_points(image, region, positions=[(row, col)])
        for response, listed in ((one.across, across), (one.along, along)):
            width = response.fwhm_px
            assert abs(width.value - listed) < 3 * width.std + 0.1


def test_the_spokes_of_a_star_are_refused_as_points_in_words():
    image, _ = ac.simulate.star(
        ac.simulate.reference_systems()["gaussian"], wave="square", snr=100.0,
        rng=np.random.default_rng(0),
    )  # fmt: skip
    with pytest.raises(ac.TargetError, match="no points"):
        ac.measure_points(image)
    with pytest.raises(ac.TargetError, match="none of 30 sources has a Gaussian of its own"):
        ac.measure_points(image, method="gaussian-2003")


def test_a_psf_without_light_at_its_centre_is_refused():
    """Rings around dark middles: the one PSF that explains them is no sensor's."""
    places = np.array([[20.0, 20.0], [20.4, 45.3], [45.2, 20.7], [45.6, 45.1]])
    row, col = np.indices((66, 66))
    image = np.full((66, 66), 100.0)
    for down, right in places:
        far = np.hypot(row - down, col - right)
        image += 900 * np.exp(-0.5 * ((far - 4) / 1.2) ** 2) - 800 * np.exp(-0.5 * far**2)
    image += np.random.default_rng(1).normal(size=image.shape)
    stamps = cut_stamps(image, places, 11.0)
    with pytest.raises(np.linalg.LinAlgError, match="no light at its centre"):
        fit_points(stamps, fit_first_gaussian(stamps, places))


@pytest.mark.parametrize("level", [30.0, 30.3])
@pytest.mark.parametrize("seed", [0, 1])
def test_numbers_with_less_noise_than_their_step_refuse_no_mirror(seed, level):
    """Most pixels of an even background have one number: their median deviation is nothing."""
    sensor = ac.simulate.reference_systems()["gaussian"]
    image, _ = ac.simulate.points(sensor, snr=200, rng=np.random.default_rng(seed))
    light = image - np.median(image)
    found = ac.measure_points(np.rint(level + 100.0 * light / light.max()))
    assert len(found.sources) == 20
    assert not found.verdict.warns
    # Half a step, and rounding; by their median it was less, and the rest grew with the light.
    assert found.noise_std == pytest.approx(np.hypot(0.5, 12**-0.5), rel=0.1)
    assert found.noise_gain == 0
    for direction in (found.across, found.along):
        error = direction.mtf_nyquist.value - sensor.mtf()(0.5).value
        assert abs(error) < 3 * direction.mtf_nyquist.std < 0.05


def test_sources_of_one_phase_alone_are_doubtful():
    """Behind sharpened products 9 of 12 such intervals miss by more than four deviations."""
    noise = np.random.default_rng(2)
    words = []
    for positions in ([[15.3, 15.2]], [[15.3, 15.2], [28.3, 15.2]], [[15.3, 15.2], [28.8, 15.6]]):
        image, _ = image_of(GAUSSIAN, positions=positions, shape=(44, 31), snr=80, rng=noise)
        words.append(ac.measure_points(image).verdict.word)
    assert words == ["doubtful", "doubtful", "usable"]
