"""Strips that touch the border of an edge: found where they are, and only there."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

import acutance as ac
from acutance.optics import draw_sensor
from acutance.simulate import Noise, Regrid, edge, reference_systems
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.find_edges import find_segments
from acutance.targets.straight.fit_edge import fit_edge
from acutance.targets.straight.rim import find_rim
from acutance.targets.straight.trim import trim

SYSTEMS = reference_systems()
SNR = 120.0


def an_edge(sensor, seed, width_px=0.0, height=0.0, side="bright", snr=SNR, texture_px=0.0):
    """An edge of 45 px with a strip along it, and its true curves; texture instead of noise."""
    rng = np.random.default_rng(seed)
    image, truth = edge(
        sensor, angle_deg=float(rng.uniform(4, 20)), shape=(45, 45), dark=200, bright=1200,
        noise=Noise(read=0.0), rng=rng,
    )  # fmt: skip
    s = truth.line.normal_distance(*np.indices(image.shape))
    places = (0.0, width_px) if side == "bright" else (-width_px, 0.0)
    inner, outer = (
        np.interp(s - place, truth.esf.distance_px, truth.esf.value) for place in places
    )
    image = image + 1000 * height * (inner - outer)
    noise = rng.normal(0, 1, image.shape)
    if texture_px:
        noise = gaussian_filter(noise, texture_px, mode="wrap")
    return image + 1000 / snr * noise / noise.std(), truth


def strip_of(image):
    """The strip that the search finds in an image."""
    trimmed, _ = trim(image, next(iter(find_segments(image, 1))))
    fit = fit_edge(trimmed)
    return find_rim(CheckData.of(trimmed, fit), fit)


def rim_check(measurement):
    return next(check for check in measurement.checks if check.name == "rim")


def sigmas(measured, truth):
    """The larger error of RER and MTF at Nyquist, in deviations."""
    pairs = [(measured.rer, truth.rer), (measured.mtf_nyquist, truth.mtf_nyquist)]
    return max(abs(found.value - true.value) / found.std for found, true in pairs)


@pytest.mark.parametrize("system", ["gaussian", "diffraction", "smeared"])
def test_strips_that_steepen_the_edge_are_named_where_they_move_the_numbers(system):
    wrong, warned, named, on_its_side = 0, 0, 0, 0
    for seed in range(16):
        rng = np.random.default_rng((5, seed))
        side = ("dark", "bright")[seed % 2]
        height = float(rng.uniform(0.05, 0.2)) * (1 if side == "bright" else -1)
        width_px, snr = float(rng.uniform(0.8, 2.5)), float(rng.uniform(60, 150))
        image, truth = an_edge(SYSTEMS[system], seed, width_px, height, side, snr)
        measured = ac.measure_edge(image)
        rim = rim_check(measured)
        named += not rim.passed
        on_its_side += not rim.passed and f"on the {side} side" in rim.message
        if sigmas(measured, truth) > 3:
            wrong += 1
            warned += measured.verdict.word in ("doubtful", "invalid")
    assert wrong >= 5
    # Of 80 of each 90 to 100 % are.
    assert warned >= 0.75 * wrong
    assert named >= wrong
    assert on_its_side >= 0.8 * named


@pytest.mark.parametrize(("side", "height"), [("bright", 0.12), ("dark", -0.12)])
def test_height_and_sensor_of_a_strip(side, height):
    behind, as_measured = [], []
    for seed in range(6):
        image, truth = an_edge(SYSTEMS["gaussian"], seed, 1.5, height, side, 200.0)
        found = strip_of(image)
        assert found.side == side
        # Width and height of a strip narrower than the blur are known as their product only.
        assert found.width_px * found.height == pytest.approx(1.5 * height, rel=0.4)
        behind.append(found.rer - truth.rer.value)
        as_measured.append(ac.measure_edge(image).rer.value - truth.rer.value)
    assert np.mean(np.square(behind)) < 0.5 * np.mean(np.square(as_measured))


def test_sensors_alone_have_no_rims():
    probability = []
    for family in ("telescope", "halo", "smear", "sharpened", "restored", "resampled"):
        for seed in range(8):
            rng = np.random.default_rng((3, seed))
            image, _ = an_edge(draw_sensor(family, rng), seed, snr=float(rng.uniform(40, 150)))
            found = strip_of(image)
            probability.append(0.0 if found is None else found.probability)
    assert np.mean(np.array(probability) > 0.1) <= 0.025


def test_symmetric_lobes_of_sharpening_are_no_rims():
    for seed in range(8):
        image, _ = an_edge(SYSTEMS["sharpened"], seed)
        assert rim_check(ac.measure_edge(image)).value < 0.05


def test_asymmetry_is_graver_on_textured_ground():
    """A dark strip narrower than the blur looks like a charge trail, which is rare on ground."""
    severities = {0.0: [], 1.5: []}
    for texture_px, found in severities.items():
        for seed in range(8):
            image, _ = an_edge(
                SYSTEMS["gaussian"], seed, 1.2, -0.15, snr=60.0, texture_px=texture_px
            )
            checks = {check.name: check for check in ac.measure_edge(image).checks}
            asymmetric = checks["asymmetric_lsf"]
            found.append(not asymmetric.passed and asymmetric.severity == "caution")
            is_told = "that of textured ground" in asymmetric.message
            assert asymmetric.passed or is_told == (texture_px > 0)
    assert np.mean(severities[0.0]) <= 0.25
    assert np.mean(severities[1.5]) >= 0.5


def test_an_asymmetry_like_that_of_no_sensor_is_a_caution():
    """What is wrong behind strips as wide as the blur, and no trail makes."""
    wrong, warned = 0, 0
    for seed in range(12):
        image, truth = an_edge(SYSTEMS["wide"], seed, 1.6, 0.3, "dark", 120.0)
        measured = ac.measure_edge(image)
        if measured.details.families["other"] < 0.5 or sigmas(measured, truth) < 3:
            continue
        wrong += 1
        check = next(one for one in measured.checks if one.name == "asymmetric_lsf")
        warned += not check.passed and check.severity == "caution"
        assert check.passed or "the LSF is like that of no sensor known" in check.message
    assert wrong >= 6
    assert warned >= 0.8 * wrong


def like_interpolation(measured):
    """Whether the asymmetry is a caution because only an interpolated product has such an LSF."""
    check = next(one for one in measured.checks if one.name == "asymmetric_lsf")
    named = "interpolated at one phase, and its noise is not" in check.message
    return named and check.severity == "caution" and not check.passed


def test_white_noise_tells_a_strip_from_interpolation_at_one_phase():
    """Both make the LSF uneven, and only one of them mixes the noise of neighbours."""
    wrong, warned, named = 0, 0, 0
    for seed in range(16):
        rng = np.random.default_rng((9, seed))
        sensor = draw_sensor("telescope", rng)
        image, truth = an_edge(sensor, seed, float(rng.uniform(0.7, 1.6)), -0.25, "bright", 100.0)
        measured = ac.measure_edge(image)
        if sigmas(measured, truth) > 3:
            wrong += 1
            warned += measured.verdict.word in ("doubtful", "invalid")
        named += like_interpolation(measured)
    assert wrong >= 12
    assert warned >= 0.8 * wrong
    assert named >= 8


def test_products_interpolated_with_their_noise_are_not_taken_for_strips():
    shifted, named = 0, 0
    for seed in range(16):
        rng = np.random.default_rng((8, seed))
        image, _ = edge(
            SYSTEMS["diffraction"], angle_deg=float(rng.uniform(4, 20)), shape=(50, 50), dark=200,
            bright=1200, noise=Noise(read=10.0), rng=rng, regrid=Regrid(0.3, -0.25),
        )  # fmt: skip
        measured = ac.measure_edge(image)
        shifted += measured.details.families.get("shifted", 0.0) > 0.3
        named += like_interpolation(measured)
    assert shifted >= 12
    assert named == 0


def test_noise_below_rounding_does_not_tell_its_colour():
    image, _ = an_edge(SYSTEMS["gaussian"], 1, snr=2000.0)
    for pixels, is_told in ((image, True), (np.round(image), False)):
        trimmed, _ = trim(pixels, next(iter(find_segments(pixels, 1))))
        assert CheckData.of(trimmed, fit_edge(trimmed)).is_noise_white is is_told


def test_published_methods_do_not_ask():
    image, _ = an_edge(SYSTEMS["gaussian"], 1)
    names = {check.name for check in ac.measure_edge(image, method="iso12233").checks}
    assert "rim" not in names
