"""Scenes on a grid that was interpolated: what is measured is the mean transfer of the product."""

from functools import cache

import numpy as np
import pytest

import acutance as ac
from acutance import optics, simulate
from acutance.optics.interpolation import interpolation_transfer

TELESCOPE = ac.Sensor([
    optics.Diffraction(1.4, 0.3), optics.Gaussian(0.28), optics.Detector(), optics.Halo(0.05, 2.0),
])  # fmt: skip
SIZE = 500


@cache
def landscape():
    rng = np.random.default_rng(5)
    return simulate.landscape(TELESCOPE, shape=(700, 700), snr=100, rng=rng)[0]


def resampled(kernel, old_pixel_px, turn_deg):
    """The landscape interpolated onto a grid that is stretched and turned."""
    at = (np.arange(SIZE) - 0.5 * (SIZE - 1)) / old_pixel_px
    row, col = np.meshgrid(at, at, indexing="ij")
    sine, cosine = np.sin(np.radians(turn_deg)), np.cos(np.radians(turn_deg))
    rows, cols = cosine * row + sine * col, cosine * col - sine * row
    return simulate.resample(landscape(), 349.6 + rows, 349.3 + cols, kernel=kernel)


def mean_mtf(kernel, old_pixel_px, turn_deg, normal_deg, freq_cpp):
    """MTF of the product along a direction: that of the sensor times the kernel's."""
    angle = np.radians(normal_deg - turn_deg)
    u, v = old_pixel_px * freq_cpp * np.array([np.cos(angle), np.sin(angle)])
    kernels = interpolation_transfer(kernel, u) * interpolation_transfer(kernel, v)
    return float(np.abs(TELESCOPE.otf(u, v)) * kernels)


@pytest.mark.parametrize(
    ("kernel", "old_pixel_px", "turn_deg"),
    [("spline", 1.1, 0.0), ("spline", 1.0, 5.0), ("lanczos", 1.1, 0.0), ("lanczos", 0.95, 3.0)],
)
def test_kernels_that_end_steeply_are_known(kernel, old_pixel_px, turn_deg):
    scene = ac.scan_scene(resampled(kernel, old_pixel_px, turn_deg))
    for normal_deg, found in ((0.0, scene.across), (90.0, scene.along)):
        for number, freq_cpp in ((found.mtf(0.25), 0.25), (found.mtf_nyquist, 0.5)):
            true = mean_mtf(kernel, old_pixel_px, turn_deg, normal_deg, freq_cpp)
            assert abs(number.value - true) < 2.5 * number.std
        assert abs(found.mtf_nyquist.value - true) < 0.016
    assert scene.verdict.word == "usable"
    assert [check.name for check in scene.failed_checks] == ["periodic_noise"]
