"""Bars, stars and point sources against closed forms, and their truths against the images."""

import json
import math
import sys

import numpy as np
import pytest
from scipy.special import erf

from acutance.errors import ModelError
from acutance.optics import Detector, Exponential, Gaussian, Sensor, preset
from acutance.simulate import (
    BarGroup,
    BarsTruth,
    Star,
    add_star,
    bars,
    mirror_columns,
    mirror_square,
    points,
    reference_systems,
)

GENERIC = preset("generic-2005")
SKEWED = reference_systems()["asymmetric"]


@pytest.mark.parametrize("orientation", ["across", "along"])
@pytest.mark.parametrize("angle", [0.0, 8.0])
def test_long_bars_are_sums_of_steps(orientation, angle):
    image, truth = bars(
        SKEWED, periods_px=(5.3,), count=3, length_px=70, angle_deg=angle, orientation=orientation
    )
    group = truth.groups[0]
    profile = SKEWED.profile(group.normal_deg)
    rows, cols = np.indices(image.shape)
    x, y = math.cos(math.radians(group.normal_deg)), math.sin(math.radians(group.normal_deg))
    s = x * (cols - group.col) + y * (rows - group.row)
    expected = np.full(image.shape, 200.0)
    for place in (-5.3, 0.0, 5.3):
        expected += 1000 * (profile.esf(s - place + 5.3 / 4) - profile.esf(s - place - 5.3 / 4))
    middle = np.abs(-y * (cols - group.col) + x * (rows - group.row)) < 15
    np.testing.assert_allclose(image[middle], expected[middle], atol=1e-3)


def test_contrast_of_bars_is_that_of_many_bars():
    """Eleven bars, read midway on the middle bar and in the gaps next to it."""
    image, truth = bars(GENERIC, periods_px=(8.0, 4.0), count=11, length_px=30)
    assert truth.freq_cpp.tolist() == [0.125, 0.25]
    for group, ctf in zip(truth.groups, truth.ctf, strict=True):
        profile = GENERIC.profile(0.0)
        places = (np.arange(11) - 5) * group.period_px

        def level(s, places=places, quarter=group.period_px / 4, profile=profile):
            return np.sum(profile.esf(s - places + quarter) - profile.esf(s - places - quarter))

        assert level(0.0) - level(group.period_px / 2) == pytest.approx(ctf, abs=1e-4)
    np.testing.assert_allclose(truth.mtf, [truth.response.mtf(f).value for f in truth.freq_cpp])
    assert image.shape[0] > 2 * 30


@pytest.mark.parametrize("period_px", [40.0, 100.0, 400.0])
def test_coarse_bars_have_their_whole_contrast(period_px):
    group = BarGroup(0.0, 0.0, 0.0, period_px, 5, 20.0)
    truth = BarsTruth(GENERIC, (group,), 200.0, 1200.0)
    np.testing.assert_allclose(truth.ctf, 1.0, atol=1e-5)


def test_bars_keep_inside_their_regions():
    image, truth = bars(GENERIC, angle_deg=6.0, snr=100, rng=np.random.default_rng(1))
    for group in truth.groups:
        low, high = group.region.min(axis=0), group.region.max(axis=0)
        assert np.all(low > 5)
        assert np.all(high < np.array(image.shape) - 5)
        assert image[round(group.row), round(group.col)] > 400
    assert truth.noise.read == 10.0
    assert json.dumps(truth.to_dict())


def wave_at(image, star, freq):
    """Modulation on a ring: least squares of a constant, cosine and sine."""
    rows, cols = np.indices(image.shape)
    y, x = rows - star.row, cols - star.col
    ring = np.abs(np.hypot(x, y) - star.radius_at_px(freq)) < 0.5
    phase = star.cycles * np.arctan2(y, x)[ring]
    waves = np.column_stack([np.ones(phase.size), np.cos(phase), np.sin(phase)])
    found = np.linalg.lstsq(waves, image[ring], rcond=None)[0]
    return math.hypot(found[1], found[2])


@pytest.mark.parametrize(("wave", "gain"), [("sine", 1.0), ("square", 4 / math.pi)])
def test_rings_of_a_star_carry_the_mean_mtf(star_of, wave, gain):
    image, truth = star_of(GENERIC, wave=wave, cycles=48, radius_px=70, shape=(160, 160))
    for freq in (0.15, 0.25, 0.4):
        found = wave_at(image, truth.star, freq) / (500 * gain)
        assert found == pytest.approx(truth.mtf_mean(freq), abs=6e-3)
    assert image[80, 80] == pytest.approx(700, abs=1)


@pytest.fixture
def star_of():
    from acutance import simulate

    return simulate.star


def test_a_pixel_of_a_sine_star_is_an_integral(star_of):
    """By quadrature over a Gaussian and a pixel, at 29 px from the centre."""
    sigma = 0.6
    image, truth = star_of(Sensor([Gaussian(sigma), Detector()]))
    nodes = np.arange(-80, 81) * 0.05
    scale = sigma * math.sqrt(2)
    weight = 0.5 * (erf((nodes + 0.5) / scale) - erf((nodes - 0.5) / scale))
    wave, _ = truth.star.drawn(63 + nodes[:, None], 92 + nodes[None, :], 1e-6)
    expected = 700 + 500 * (weight @ wave @ weight) / weight.sum() ** 2
    assert image[63, 92] == pytest.approx(expected, abs=0.01)
    assert abs(expected - 700) > 50
    assert truth.star.inner_px == pytest.approx(36 / (2 * math.pi * 1.5))


@pytest.mark.parametrize("sweep", [300.0, 123.0, 360.0])
def test_a_square_fan_is_drawn_finely_enough_up_to_its_borders(star_of, monkeypatch, sweep):
    """Spokes begin and end there: what is beyond belongs to none."""
    drawn = []
    for subpixels in (10, 30):
        monkeypatch.setattr(sys.modules["acutance.simulate.star"], "SUBPIXELS", subpixels)
        image, _ = star_of(
            GENERIC, cycles=24, shape=(40, 42), radius_px=18.0, wave="square", ground=150.0,
            start_deg=20.0, sweep_deg=sweep,
        )  # fmt: skip
        drawn.append(image / 1000)
    np.testing.assert_allclose(drawn[0], drawn[1], atol=2e-3)


def test_a_fan_holds_its_directions_only(star_of):
    image, truth = star_of(GENERIC, start_deg=-30.0, sweep_deg=60.0, ground=300.0)
    assert image[20, 20] == pytest.approx(300.0, abs=1e-2)
    assert np.ptp(image[40:88, 90:110]) > 500
    # Spokes near the column axis have normals near the row axis, where the smear is.
    assert truth.mtf_mean(0.5) == pytest.approx(truth.mtf_toward(90.0, 0.5), abs=3e-3)
    assert truth.mtf_toward(90.0, 0.5) < truth.mtf_toward(0.0, 0.5)
    assert json.dumps(truth.to_dict())


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"wave": "saw"}, "'saw'"),
        ({"radius_px": 100.0}, "room for"),
        ({"cycles": 900}, "use fewer cycles"),
        ({"dark": 900.0, "bright": 100.0}, "dark has to be"),
        ({"finest_cpp": 3.0}, "finest_cpp"),
    ],
)
def test_stars_that_cannot_be_drawn_are_refused(star_of, wrong, words):
    with pytest.raises(ModelError, match=words):
        star_of(GENERIC, **wrong)


def test_frequency_and_radius_are_each_others_inverse():
    star = Star(0.0, 0.0, 50.0)
    freq = np.array([0.12, 0.5])
    np.testing.assert_allclose(star.freq_cpp(star.radius_at_px(freq)), freq)
    canvas = np.zeros((40, 40))
    add_star(canvas, GENERIC, Star(0.0, 0.0, 30.0), mean=1.0, amplitude=0.5)
    assert canvas[39, 39] == pytest.approx(0.0, abs=1e-4)
    assert canvas[15, 15] > 0.4


def test_a_point_is_the_psf_with_its_pixel():
    sigma, places = 0.6, [(10.3, 12.8), (25.0, 30.45)]
    image, _ = points(
        Sensor([Gaussian(sigma), Detector()]),
        positions=places,
        fluxes=[500.0, 900.0],
        shape=(40, 45),
    )

    def part(size, centre):
        s = np.arange(size) - centre
        scale = sigma * math.sqrt(2)
        return 0.5 * (erf((s + 0.5) / scale) - erf((s - 0.5) / scale))

    expected = 200.0 + sum(
        flux * np.outer(part(40, row), part(45, col))
        for (row, col), flux in zip(places, (500.0, 900.0), strict=True)
    )
    np.testing.assert_allclose(image, expected, atol=2e-5)


def test_a_trail_moves_points_by_the_centroid():
    # Wide enough that its samples have the centroid of the PSF.
    soft = Sensor([Gaussian(1.0), Exponential(0.4, "across"), Exponential(0.4, "along")])
    image, truth = points(soft, positions=[(20.0, 22.0)], fluxes=1000.0, shape=(48, 50))
    light = image - 200
    rows, cols = np.indices(image.shape)
    found = (np.sum(rows * light) / 1000 - 20, np.sum(cols * light) / 1000 - 22)
    assert found == pytest.approx(truth.centroid_px, abs=1e-4)
    assert found == pytest.approx((0.4, 0.4), abs=1e-3)


def test_mirrors_of_the_quickbird_campaign():
    image, truth = points(GENERIC, snr=80, rng=np.random.default_rng(2))
    assert truth.positions.shape == (20, 2)
    phases = np.round(truth.positions[:10] % 1, 2)
    assert {tuple(phase) for phase in phases} >= {(0.2, 0.25), (0.4, 0.5)}
    assert np.unique(phases[:, 0]).size == 5
    assert np.unique(phases[:, 1]).size == 4
    assert truth.noise.read == pytest.approx(1000 / 80)
    assert truth.response("along").mtf_nyquist == GENERIC.response(0, "along").mtf_nyquist
    assert image.max() < 1300
    assert json.dumps(truth.to_dict())
    square = mirror_square((3.0, 4.0))
    assert np.unique(square[:, 0] % 1).tolist() == [0.0, 0.25, 0.5, 0.75]
    assert mirror_columns((0.0, 0.0), count=2, columns=1).tolist() == [[0.0, 0.0], [10.2, 1.25]]


def test_the_peak_is_that_of_a_centred_source():
    image, _ = points(GENERIC, positions=[(15.0, 16.0)], peak=750.0)
    assert image[15, 16] == pytest.approx(950.0, abs=1e-2)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"positions": [1.0, 2.0]}, r"have to be \(n, 2\)"),
        ({"positions": [(5.0, 60.0)], "shape": (40, 40)}, "outside the image"),
        ({"fluxes": [1.0, 2.0]}, "2 fluxes were given for 20"),
    ],
)
def test_sources_that_mean_nothing_are_refused(wrong, words):
    with pytest.raises(ModelError, match=words):
        points(GENERIC, **wrong)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"periods_px": ()}, "has to be a period"),
        ({"angle_deg": 60.0}, "cannot exceed 45"),
        ({"dark": 5.0, "bright": 5.0}, "levels have to differ"),
    ],
)
def test_bars_that_mean_nothing_are_refused(wrong, words):
    with pytest.raises(ModelError, match=words):
        bars(GENERIC, **wrong)


def test_a_group_knows_its_size():
    group = BarGroup(10.0, 20.0, 0.0, 4.0, 5, 12.0)
    assert group.width_px == 18.0
    assert group.region.min(axis=0).tolist() == [4.0, 11.0]
    assert len(group.patches(100.0)) == 5
