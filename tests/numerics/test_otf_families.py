"""Directions learned from optics: they hold what sensors of a family do, in either position."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac
from acutance.numerics.learn_otf import departure, principal_directions
from acutance.numerics.otf_families import FAMILY_LOG_AMPLITUDES, family_directions
from acutance.numerics.otf_modes import ProcessModes
from acutance.optics import draw_sensor

FREQ = np.linspace(0.02, 1.2, 40)
NOTHING = np.zeros(FREQ.size)


def curve(states: np.ndarray) -> np.ndarray:
    """What coefficients of the states are along an axis, in cycles per width."""
    return np.asarray(ProcessModes(1.0).otf_modes(FREQ, NOTHING) @ states)


class TestDeparture:
    def test_gaussian_has_none(self) -> None:
        sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector(1.0)])
        assert np.abs(curve(departure(sensor))).max() < 1e-3

    def test_halo_is_a_dip_beside_zero(self) -> None:
        blocks = [ac.optics.Gaussian(0.4), ac.optics.Halo(0.1, 3.0), ac.optics.Detector(1.0)]
        found = curve(departure(ac.Sensor(blocks))).real
        assert found[0] > 0.01
        assert np.abs(found[FREQ > 1]).max() < 0.5 * found[0]

    def test_turned_and_mirrored(self) -> None:
        """A trail across has its phase there, and the other sign mirrored."""
        blocks = [ac.optics.Gaussian(0.3), ac.optics.Exponential(0.5, "across")]
        sensor = ac.Sensor([*blocks, ac.optics.Detector(1.0)])
        ahead, behind = (curve(departure(sensor, signs=(sign, 1))) for sign in (1, -1))
        assert np.abs(ahead.imag).max() > 0.01
        assert behind.imag == pytest.approx(-ahead.imag, abs=1e-4)
        assert np.abs(curve(departure(sensor, turned=True)).imag).max() < 1e-4


class TestDirections:
    def test_one_rare_sensor_does_not_lead(self) -> None:
        rng = np.random.default_rng(1)
        usual = departure(draw_sensor("halo", rng))
        other = departure(draw_sensor("sharpened", rng))
        drawn = np.stack([usual] * 30 + [50 * other])
        first = principal_directions(drawn)[:, 0]
        alike = curve(first) @ curve(usual).conj()
        assert abs(alike) > 0.9 * np.linalg.norm(curve(first)) * np.linalg.norm(curve(usual))

    @pytest.mark.parametrize("family", FAMILY_LOG_AMPLITUDES)
    def test_kept_directions_hold_new_sensors(self, family: str) -> None:
        """Of a departure at most a quarter is left in the median, though no draw was learned."""
        found = family_directions()
        own = found.states[:, found.family == list(FAMILY_LOG_AMPLITUDES).index(family)]
        basis = np.linalg.qr(curve(own).real)[0]
        left = []
        for seed in range(5):
            seen = curve(departure(draw_sensor(family, np.random.default_rng((9, seed))))).real
            left.append(np.linalg.norm(seen - basis @ (basis.T @ seen)) / np.linalg.norm(seen))
        assert np.median(left) < 0.25

    def test_they_are_small(self) -> None:
        assert family_directions().family.size < 100
