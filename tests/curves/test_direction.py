"""Unit vectors of directions and the GSD along them."""

import math

import numpy as np
import pytest

from acutance.curves.direction import gsd_along, unit_vector
from acutance.curves.otf2d import Otf2d
from acutance.optics import Gaussian, Sensor
from acutance.raster import Gsd
from acutance.targets.record import ImageInfo


def test_directions_turn_from_the_columns_towards_the_rows():
    assert unit_vector(0.0) == (1.0, 0.0)
    assert unit_vector(90.0) == pytest.approx((0.0, 1.0), abs=1e-15)
    x, y = unit_vector(np.array([30.0, -120.0]))
    np.testing.assert_allclose(x, [math.sqrt(0.75), -0.5])
    np.testing.assert_allclose(y, [0.5, -math.sqrt(0.75)])


@pytest.mark.parametrize("normal_deg", [0.0, 17.0, 45.0, 90.0, 160.0, -100.0])
def test_parallel_lines_a_pixel_apart_on_the_ground(normal_deg):
    row_m, col_m = 0.9, 0.6
    x, y = unit_vector(normal_deg)
    # The line x c + y r = 1 in metres, and its distance from the origin.
    on_ground = 1 / np.linalg.norm([x / col_m, y / row_m])
    assert gsd_along((row_m, col_m), normal_deg) == pytest.approx(on_ground, rel=1e-14)


def test_the_ends_and_square_pixels():
    assert gsd_along((0.9, 0.6), 0.0) == pytest.approx(0.6)
    assert gsd_along((0.9, 0.6), 90.0) == pytest.approx(0.9)
    assert gsd_along((0.7, 0.7), 33.0) == 0.7


class GaussianModel:
    band_cpp = 1.0

    def otf(self, u_cpp, v_cpp):
        return np.exp(-2 * np.pi**2 * 0.6**2 * (u_cpp**2 + v_cpp**2)).astype(complex)

    def factor(self, u_cpp, v_cpp):
        return np.zeros((u_cpp.size, 1), complex)


@pytest.mark.parametrize("normal_deg", [0.0, 25.0, 90.0])
def test_images_results_and_sensors_agree_on_it(normal_deg):
    expected = gsd_along((0.9, 0.6), normal_deg)
    sensor = Sensor([Gaussian(0.4)], gsd_m=0.6, gsd_along_m=0.9)
    assert sensor.gsd_along_normal_m(normal_deg) == expected
    assert Gsd(0.9, 0.6).along_normal(normal_deg) == expected
    assert ImageInfo(pixel_gsd_m=(0.9, 0.6)).gsd_along(normal_deg) == expected
    assert Otf2d(GaussianModel(), (0.9, 0.6)).response(normal_deg).gsd_m == expected
