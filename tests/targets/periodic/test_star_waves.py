"""The image of a star through a transfer function is exact, not a local plane wave."""

import math

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid
from scipy.special import jv

from acutance.numerics.otf_modes import MEAN_MODES, MeanOtf, ProcessModes
from acutance.optics import Detector, Exponential, Gaussian, Sensor, Smear
from acutance.simulate import star
from acutance.targets.periodic.star_waves import BlurredStar, StarTable

CENTRE = (40.3, 39.6)
CYCLES, RIM, TURN = 20, 28.0, 17.0


def _polar(image):
    rows, cols = np.indices(image.shape)
    y, x = rows - CENTRE[0], cols - CENTRE[1]
    radius = np.hypot(x, y)
    kept = (radius > 5) & (radius < RIM - 4)
    return kept, radius[kept], np.arctan2(y, x)[kept]


@pytest.mark.parametrize(("wave", "tolerance"), [("sine", 1e-4), ("square", 3e-3)])
def test_mean_blur_is_rendered_as_exactly_as_the_simulation(wave, tolerance):
    sensor = Sensor([Gaussian(0.4), Detector()])
    image, _ = star(
        sensor, cycles=CYCLES, radius_px=RIM, shape=(81, 81), wave=wave, start_deg=TURN,
        centre=CENTRE,
    )  # fmt: skip
    kept, radius, angle = _polar(image)
    table = StarTable(MeanOtf(0.16, 0.0, 0.16), CYCLES, wave, 4.0, RIM, RIM)
    phase = CYCLES * (angle - math.radians(TURN)) - math.pi / 2
    columns, _ = table.columns(radius, phase, angle)
    amplitude = 500 * (4 / math.pi if wave == "square" else 1)
    error = (image[kept] - 700 - amplitude * columns[:, 0]) / 1000
    assert np.max(np.abs(error)) < tolerance
    # The local plane wave is off by twenty times that.
    angle_of_normal = angle + math.pi / 2
    f = CYCLES / (2 * math.pi * radius)
    otf = sensor.otf(f * np.cos(angle_of_normal), f * np.sin(angle_of_normal)).real
    local = (image[kept] - 700) / 500 - otf * np.cos(phase)
    if wave == "sine":
        assert np.max(np.abs(local)) > 5e-4


def test_phase_of_an_asymmetric_system_and_a_turned_ellipse():
    """The spectrum of a state times a small number, added to the mean, shows in its column."""
    sensor = Sensor([Gaussian(0.3), Exponential(0.3, "across"), Smear(0.5, "along"), Detector()])
    image, _ = star(
        sensor, cycles=CYCLES, radius_px=RIM, shape=(81, 81), start_deg=TURN, centre=CENTRE
    )
    kept, radius, angle = _polar(image)
    blur = MeanOtf(0.12, 0.02, 0.11)
    phase = CYCLES * (angle - math.radians(TURN)) - math.pi / 2
    table = StarTable(blur, CYCLES, "sine", 4.0, RIM, RIM)
    columns, _ = table.columns(radius, phase, angle)
    # Project the sensor's OTF on the modes over the plane: the same coefficients give the image.
    u, v = (
        grid.ravel() for grid in np.meshgrid(np.linspace(-1.6, 1.6, 41), np.linspace(0, 1.6, 21))
    )
    modes = np.hstack([blur.modes(u, v), ProcessModes(blur.width_px).otf_modes(u, v)])
    stacked = np.vstack([modes.real, modes.imag])
    otf = sensor.otf(u, v)
    ridge = 1e-7 * np.eye(stacked.shape[1])
    beta = np.linalg.solve(
        stacked.T @ stacked + ridge, stacked.T @ np.concatenate([otf.real, otf.imag])
    )
    assert np.max(np.abs(modes @ beta - otf)) < 0.01
    inner = radius > 8
    error = (image[kept] - 700) / 500 - columns @ beta
    assert np.max(np.abs(error[inner])) < 0.01
    odd = np.abs((image[kept] - 700) / 500 - columns[:, [0]] @ beta[[0]])
    assert np.max(odd[inner]) > 0.1


def test_high_harmonics_are_whole_at_all_radii():
    """Their Bessel functions are left out only where they are nothing."""
    blur = MeanOtf(0.04, 0.0, 0.04)
    rim, outer, k = 24.0, 26.0, 8
    radius, phase = np.linspace(2.0, 23.0, 20), 0.3
    found = BlurredStar(blur, k, "square", outer, rim)(radius, np.full(20, phase), np.zeros(20))
    step = 1 / (2 * outer + 24)
    freq = step * np.arange(1, math.ceil(1.5 / step))
    angle = 2 * math.pi * np.arange(64) / 64
    transfer = blur.otf(np.outer(freq, np.cos(angle)), np.outer(freq, np.sin(angle)))
    grid = np.linspace(0.0, 2 * math.pi * rim * freq[-1], 8000)
    wanted = np.zeros(20)
    for index, number in enumerate(range(1, int(1.3 * 2 * math.pi * rim / k) + 1, 2)):
        order = number * k
        whole = cumulative_trapezoid(grid * jv(order, grid), grid, initial=0) / order
        weight = order * step / freq * np.interp(2 * math.pi * rim * freq, grid, whole)
        for m in range(-12, 13, 2):
            part = np.mean(transfer * np.exp(-1j * m * angle), axis=1)
            bessel = jv(order + m, 2 * math.pi * np.outer(radius, freq))
            wave = (-1.0) ** index / number * 1j**m * np.exp(1j * number * phase)
            wanted += (wave * (bessel @ (weight * part))).real
    assert np.max(np.abs(found - wanted)) < 5e-4


def test_derivative_by_phase():
    blur = MeanOtf(0.2, 0.05, 0.15)
    table = StarTable(blur, CYCLES, "square", 4.0, RIM, RIM)
    radius, angle = np.linspace(6, 26, 40), np.linspace(0, 6, 40)
    at = [table.columns(radius, CYCLES * angle + 0.4 + d, angle) for d in (-1e-4, 0.0, 1e-4)]
    slope = (at[2][0][:, 0] - at[0][0][:, 0]) / 2e-4
    assert np.allclose(at[1][1], slope, atol=1e-4)


def test_modes_are_those_of_real_spread_functions():
    """Every mode has the symmetry of a real PSF, and the mean's slopes are its derivatives."""
    blur = MeanOtf(0.2, 0.05, 0.15)
    rng = np.random.default_rng(3)
    u, v = rng.uniform(-1, 1, (2, 30))
    states = ProcessModes(blur.width_px)
    for modes in (blur.modes, states.otf_modes):
        assert np.allclose(modes(-u, -v), np.conj(modes(u, v)), atol=1e-12)
    assert states.blocks().size == states.otf_modes(u, v).shape[1]
    assert blur.modes(u, v).shape[1] == MEAN_MODES
    step = 1e-5
    by_xy = (MeanOtf(0.2, 0.05 + step, 0.15).otf(u, v) - blur.otf(u, v)) / step
    assert np.allclose(blur.modes(u, v)[:, 2], by_xy, atol=1e-4)
    wider = MeanOtf(0.2, 0.05, 0.15, 1 + step).otf(u, v) - blur.otf(u, v)
    assert np.allclose(blur.modes(u, v)[:, 6:].sum(axis=1), wider / step, atol=1e-4)


def test_modes_are_smooth_where_the_pixel_transfers_nothing():
    """A detector of another width does not vanish at 1 and 2 cycles per pixel."""
    blur = MeanOtf(0.1, 0.0, 0.1)
    freq = np.array([0.999, 1.0, 1.001, 1.999, 2.0, 2.001])
    modes = blur.modes(freq, np.zeros(freq.size))
    assert modes[1] == pytest.approx(modes[[0, 2]].mean(axis=0), abs=1e-5)
    assert modes[4] == pytest.approx(modes[[3, 5]].mean(axis=0), abs=1e-5)
    assert abs(modes[1, 6]) > 0.1
