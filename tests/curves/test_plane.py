"""The slices of a 2-D OTF against the sensor's own curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from acutance import optics
from acutance.curves import Otf2d
from acutance.curves.grid import Floats
from acutance.optics import Sensor

ROOF = Sensor([optics.Gaussian(0.4, 0.5), optics.Detector(), optics.Smear(0.7, "along")])
TRAIL = Sensor([optics.Gaussian(0.35), optics.Detector(), optics.Butterworth(0.8)])


@dataclass(frozen=True)
class SensorModel:
    """A sensor whose Gaussian blur is uncertain: one latent variable."""

    sensor: Sensor
    spread: float = 0.01

    @property
    def band_cpp(self) -> float:
        return 4.0

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> np.ndarray:
        return np.asarray(self.sensor.otf(u_cpp, v_cpp), complex)

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> np.ndarray:
        slope = -self.spread * (u_cpp**2 + v_cpp**2)
        return (slope * self.otf(u_cpp, v_cpp))[:, None]


@pytest.mark.parametrize("sensor", [ROOF, TRAIL])
@pytest.mark.parametrize("normal_deg", [0.0, 33.0, 90.0, -20.0])
def test_slices_are_the_sensors_own_curves(sensor: Sensor, normal_deg: float) -> None:
    truth = sensor.response_along(normal_deg)
    found = Otf2d(SensorModel(sensor)).response(normal_deg)
    assert np.abs(found.mtf.otf - truth.mtf.otf).max() < 1e-6
    inside = np.isin(np.round(truth.esf.distance_px, 6), np.round(found.esf.distance_px, 6))
    assert np.abs(found.esf.value - truth.esf.value[inside]).max() < 2e-5
    assert np.abs(found.lsf.value - truth.lsf.value[inside]).max() < 2e-5
    for name in ("rer", "fwhm_px", "mtf50_cpp"):
        assert getattr(found, name).value == pytest.approx(getattr(truth, name).value, abs=2e-5)


def test_the_factor_is_the_change_of_every_curve() -> None:
    """Moving the latent variable by one moves each curve by its factor."""
    base = Otf2d(SensorModel(ROOF)).response(20.0)

    @dataclass(frozen=True)
    class Moved(SensorModel):
        def otf(self, u_cpp: Floats, v_cpp: Floats) -> np.ndarray:
            return super().otf(u_cpp, v_cpp) * np.exp(-self.spread * (u_cpp**2 + v_cpp**2))

    moved = Otf2d(Moved(ROOF)).response(20.0)
    for name in ("mtf_nyquist", "rer", "fwhm_px"):
        change = abs(getattr(moved, name).value - getattr(base, name).value)
        assert getattr(base, name).std == pytest.approx(change, rel=0.05)


def test_psf_is_the_sensors() -> None:
    distance, found = Otf2d(SensorModel(ROOF)).psf(4.0, 0.25)
    places, truth = ROOF.psf(4.0, 0.25)
    assert np.allclose(distance, places)
    assert np.abs(found - truth).max() < 1e-4 * truth.max()


def test_metres_follow_the_direction() -> None:
    otf = Otf2d(SensorModel(ROOF), gsd_m=(2.0, 1.0))
    across, along = otf.response(0.0), otf.response(90.0)
    assert across.fwhm_m is not None
    assert along.fwhm_m is not None
    assert across.fwhm_m.value == pytest.approx(across.fwhm_px.value)
    assert along.fwhm_m.value == pytest.approx(2 * along.fwhm_px.value)
