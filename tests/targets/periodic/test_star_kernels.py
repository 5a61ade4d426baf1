"""The image of a star behind kernels is that of the product."""

import math

import numpy as np
import pytest
from periodic_scenes import STATED

from acutance.geometry.star_geometry import SiemensStar
from acutance.numerics.otf_kernels import blur_before, kernel_taps
from acutance.numerics.otf_modes import MeanOtf
from acutance.optics import Detector, Gaussian, Sensor, Sharpening, draw_sensor
from acutance.simulate import star
from acutance.targets.periodic import measure_star
from acutance.targets.periodic.star_kernels import kernel_columns
from acutance.targets.periodic.star_waves import BlurredStar

CENTRE = (60.3, 59.6)
CYCLES, RIM, TURN = 30, 44.0, 17.0


@pytest.mark.parametrize(("wave", "tolerance"), [("sine", 3e-4), ("square", 3e-3)])
def test_columns_are_as_exact_as_the_simulation(wave, tolerance):
    """Of a kernel that is no direction's mirror image, also next to the rim."""
    mean = MeanOtf(0.1, 0.0, 0.1)
    blur = [Gaussian(math.sqrt(blur_before(mean).xx)), Detector()]
    share = np.random.default_rng(1).normal(size=kernel_taps().shape[-1])
    taps = kernel_taps() @ share
    taps *= 0.5 / np.abs(taps).sum()
    taps[7, 7] += 1.0
    sensor = Sensor([*blur, Sharpening(tuple(map(tuple, taps.tolist())))])
    plain, product = (
        star(
            one, cycles=CYCLES, radius_px=RIM, shape=(121, 121), wave=wave, start_deg=TURN,
            centre=CENTRE,
        )[0]
        for one in (Sensor(blur), sensor)
    )  # fmt: skip
    rows, cols = np.nonzero(np.ones((121, 121)))
    radius = np.hypot(rows - CENTRE[0], cols - CENTRE[1])
    kept = (radius > 5) & (radius < RIM - 3)
    rows, cols = rows[kept], cols[kept]
    found = SiemensStar(
        row=CENTRE[0], col=CENTRE[1], cycles=CYCLES,
        alpha_rad=-CYCLES * math.radians(TURN) - math.pi / 2, rim_px=RIM,
    )  # fmt: skip
    blurred = BlurredStar(blur_before(mean), CYCLES, wave, RIM + 12, RIM)
    columns = kernel_columns(blurred, found, rows, cols)
    amplitude = 0.5 * (4 / math.pi if wave == "square" else 1.0)
    scale = 0.5 / np.abs(kernel_taps() @ share).sum()
    expected = (product[rows, cols] - 700) / 1000 * taps.sum() - (plain[rows, cols] - 700) / 1000
    error = amplitude * scale * (columns @ share) - expected
    assert np.max(np.abs(error)) < tolerance
    assert np.max(np.abs(expected)) > 15 * tolerance


def test_sharpened_products_are_within_their_deviations():
    """The states alone leave errors of 1.7 deviations, up to 3.7 behind kernels of 15 taps."""
    deviations = []
    for seed in range(8):
        rng = np.random.default_rng((41, seed))
        sensor = draw_sensor("sharpened", rng)
        image, _ = star(
            sensor, cycles=24, radius_px=32.0, shape=(72, 72), centre=(36.2, 34.9), snr=100.0,
            rng=rng,
        )  # fmt: skip
        found = measure_star(image, cycles=24, options=STATED)
        true = abs(sensor.otf(0.25, 0.0).item())
        for response in (found.across, found.along):
            one = response.mtf(0.25)
            deviations.append((one.value - true) / one.std)
    assert np.sqrt(np.mean(np.square(deviations))) < 1.35
