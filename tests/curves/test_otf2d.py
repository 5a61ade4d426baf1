"""The slices of a 2-D OTF against the sensor's own curves and against closed forms."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.special import ndtr

from acutance import optics
from acutance.curves import Otf2d
from acutance.curves.grid import Floats
from acutance.errors import OptionError
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


@dataclass(frozen=True)
class TrailingGaussian:
    """A Gaussian of two widths with an exponential trail towards higher columns (+x).

    `oblique_px2` is the Gaussian's covariance of columns with rows: above 0 it is drawn out
    towards higher columns and rows.
    """

    across_px: float = 0.35
    along_px: float = 0.7
    trail_px: float = 0.6
    oblique_px2: float = 0.0
    band_cpp: float = 6.0

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> np.ndarray:
        power = (self.across_px * u_cpp) ** 2 + (self.along_px * v_cpp) ** 2
        power = power + 2 * self.oblique_px2 * u_cpp * v_cpp
        return np.exp(-2 * math.pi**2 * power) / (1 + 2j * math.pi * self.trail_px * u_cpp)

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> np.ndarray:
        return np.zeros((u_cpp.size, 0), complex)

    def lsf(self, x_px: Floats) -> Floats:
        """LSF across: the exponentially modified Gaussian, its centroid at `trail_px`."""
        s, length = self.across_px, self.trail_px
        decay = np.exp(0.5 * (s / length) ** 2 - x_px / length) / length
        return np.asarray(decay * ndtr(x_px / s - s / length))


def test_a_trail_towards_the_bright_side_has_a_positive_phase() -> None:
    model = TrailingGaussian()
    freq = 2 * math.pi * model.trail_px * np.arange(101) * 0.01
    expected = freq - np.arctan(freq)
    towards, away = Otf2d(model).response(0.0), Otf2d(model).response(180.0)
    wrapped = np.angle(np.exp(1j * expected))
    np.testing.assert_allclose(towards.mtf.phase_rad[:60], wrapped[:60], atol=1e-6)
    np.testing.assert_allclose(away.mtf.phase_rad[:60], -wrapped[:60], atol=1e-6)
    np.testing.assert_allclose(Otf2d(model).response(90.0).mtf.phase_rad, 0, atol=1e-9)


def test_a_trail_is_on_its_side_of_the_spread_functions() -> None:
    model = TrailingGaussian()
    towards, away = Otf2d(model).response(0.0), Otf2d(model).response(180.0)
    fine = np.arange(-400, 801) * 0.01
    half = float(np.interp(0.5, np.cumsum(model.lsf(fine)) * 0.01 - 0.005 * model.lsf(fine), fine))
    expected = model.lsf(towards.lsf.distance_px + half)
    near = np.abs(towards.lsf.distance_px) <= 4.0
    np.testing.assert_allclose(towards.lsf.value[near], expected[near], atol=2e-4)
    np.testing.assert_allclose(away.lsf.value[near], expected[::-1][near], atol=2e-4)
    assert towards.lsf(1.5).value > 20 * abs(towards.lsf(-1.5).value)
    assert 1 - towards.esf(1.5).value > 20 * abs(towards.esf(-1.5).value)
    assert towards.half_extent_bright_px.value > 1.5 * towards.half_extent_dark_px.value


def test_light_of_the_psf_lies_where_the_trail_points() -> None:
    distance, psf = Otf2d(TrailingGaussian()).psf(6.0, 0.1)
    rows, cols = psf @ distance, psf.T @ distance
    assert psf.sum() * 0.01 == pytest.approx(1, abs=1e-3)
    assert rows.sum() * 0.01 == pytest.approx(0.6, abs=2e-3)
    assert cols.sum() * 0.01 == pytest.approx(0, abs=1e-6)


def test_across_and_along_keep_their_own_widths() -> None:
    otf = Otf2d(TrailingGaussian(0.3, 0.6, 0.0))
    for normal_deg, sigma in ((0.0, 0.3), (90.0, 0.6), (60.0, math.hypot(0.15, 0.6 * 0.75**0.5))):
        found = otf.response(normal_deg)
        assert found.fwhm_px.value == pytest.approx(2.3548200 * sigma, abs=1e-3)
        assert found.mtf_nyquist.value == pytest.approx(math.exp(-0.5 * (math.pi * sigma) ** 2))
    distance, psf = otf.psf(3.0, 0.1)
    rows, cols = (psf @ distance**2), (psf.T @ distance**2)
    assert rows.sum() * 0.01 == pytest.approx(0.09, rel=1e-3)
    assert cols.sum() * 0.01 == pytest.approx(0.36, rel=1e-3)


@pytest.mark.parametrize("normal_deg", [30.0, -30.0, 150.0])
def test_directions_turn_from_columns_towards_rows(normal_deg: float) -> None:
    otf = Otf2d(TrailingGaussian(0.5, 0.5, 0.0, oblique_px2=0.1))
    sigma = math.sqrt(0.25 + 0.1 * math.sin(2 * math.radians(normal_deg)))
    assert otf.response(normal_deg).fwhm_px.value == pytest.approx(2.3548200 * sigma, abs=1e-3)
    distance, psf = otf.psf(4.0, 0.1)
    assert distance @ psf @ distance * 0.01 == pytest.approx(0.1, rel=1e-3)


@pytest.mark.parametrize(
    ("normal_deg", "gsd_m"), [(0.0, 1.0), (180.0, 1.0), (90.0, 2.0), (-45.0, 1.2649111)]
)
def test_metres_follow_the_direction(normal_deg: float, gsd_m: float) -> None:
    """From row to row 2 m, from column to column 1 m."""
    found = Otf2d(SensorModel(ROOF), gsd_m=(2.0, 1.0)).response(normal_deg)
    assert found.gsd_m == pytest.approx(gsd_m)
    assert found.fwhm_m is not None
    assert found.fwhm_m.value == pytest.approx(gsd_m * found.fwhm_px.value)


@pytest.mark.parametrize("direction", ["30", None, [0.0, 90.0], math.nan, math.inf])
def test_a_direction_is_a_finite_number(direction: object) -> None:
    with pytest.raises(OptionError, match=r"the direction is .*: give a finite number of degrees"):
        Otf2d(SensorModel(ROOF)).response(direction)  # type: ignore[arg-type]
