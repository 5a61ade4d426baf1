"""Kernels learned from optics: their modes, and what they hold of products not learned from."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac
from acutance.numerics.learn_kernels import taps_of
from acutance.numerics.learn_otf import fitted_mean
from acutance.numerics.otf_kernels import KERNEL_REACH, blur_before, kernel_modes, kernel_taps
from acutance.numerics.otf_modes import MeanOtf, ProcessModes
from acutance.numerics.stacked import stacked
from acutance.optics import draw_sensor


def test_modes_are_the_blur_times_sums_of_taps() -> None:
    mean = MeanOtf(0.12, 0.03, 0.2)
    u, v = np.random.default_rng(2).uniform(-1, 1, (2, 20))
    found = kernel_modes(mean, u, v)
    wanted = np.zeros_like(found)
    for row in range(-KERNEL_REACH, KERNEL_REACH + 1):
        for col in range(-KERNEL_REACH, KERNEL_REACH + 1):
            turn = np.exp(-2j * np.pi * (u * col + v * row))
            wanted += np.outer(turn, kernel_taps()[row + KERNEL_REACH, col + KERNEL_REACH])
    assert found == pytest.approx(blur_before(mean).otf(u, v)[:, None] * wanted, abs=1e-12)
    assert kernel_modes(mean, -u, -v) == pytest.approx(found.conj(), abs=1e-12)


def test_a_tap_far_away_is_found() -> None:
    kernel = np.zeros((11, 11))
    kernel[5, 5], kernel[5, 10] = 1.0, -0.05
    blocks = [ac.optics.Gaussian(0.5), ac.optics.Detector(1.0)]
    sharpening = ac.optics.Sharpening(tuple(map(tuple, kernel.tolist())))
    found = taps_of(ac.Sensor([*blocks, sharpening]))
    assert np.unravel_index(np.abs(found).argmax(), found.shape) == (7, 12)
    assert found[7, 12] == pytest.approx(-0.05 / 0.95, rel=0.3)
    assert np.abs(taps_of(ac.Sensor(blocks))).max() < 2e-3


def test_they_hold_new_products() -> None:
    """At Nyquist the states alone leave errors five times as large in the root mean square."""
    freq = np.arange(0.0, 1.2, 0.08)
    u, v = (one.ravel() for one in np.meshgrid(np.append(-freq[:0:-1], freq), freq))
    axes = np.array([0.5, 0.0]), np.array([0.0, 0.5])
    alone, together = [], []
    for seed in range(12):
        sensor = draw_sensor("sharpened", np.random.default_rng((8, seed)))
        mean = fitted_mean(sensor)

        def functions(u: np.ndarray, v: np.ndarray, mean: MeanOtf = mean) -> np.ndarray:
            states = 0.05 * ProcessModes(mean.width_px).otf_modes(u, v)
            own = 100 * mean.modes(u, v)[:, :6]
            return np.hstack([own, states, kernel_modes(mean, u, v)])

        design, at_axes = stacked(functions(u, v)), functions(*axes)
        wanted, true = stacked(np.asarray(sensor.otf(u, v), complex)), sensor.otf(*axes)
        kernels = kernel_taps().shape[-1]
        for errors, size in ((alone, design.shape[1] - kernels), (together, design.shape[1])):
            own = design[:, :size]
            gram = own.T @ own + 4e-8 * len(own) * np.eye(size)
            beta = np.linalg.solve(gram, own.T @ wanted)
            errors.append(np.abs(at_axes[:, :size] @ beta - true))
    assert np.sqrt(np.mean(np.square(together))) < 0.4 * np.sqrt(np.mean(np.square(alone)))


def test_they_are_small() -> None:
    assert kernel_taps().shape[-1] <= 40
