"""Narrow shadows that are clipped: their borders look sharper than the sensor is."""

import numpy as np
import pytest
from scipy import ndimage

import acutance as ac

SAMPLES = 8
SIZE_PX, SPACING_PX = 240, 60
SHADOW_PX = 6.0
TURN = np.radians(20.0)


@pytest.fixture(scope="module")
def roofs():
    """Bright roofs with a narrow shadow to the right of each, and the middles of its far border."""
    x, y = np.meshgrid(*2 * [(np.arange(SIZE_PX * SAMPLES) + 0.5) / SAMPLES - 0.5])
    ground, borders = np.full(x.shape, 300.0), []
    for row in range(SPACING_PX // 2, SIZE_PX, SPACING_PX):
        for col in range(SPACING_PX // 2, SIZE_PX, SPACING_PX):
            right = (x - col) * np.cos(TURN) + (y - row) * np.sin(TURN)
            down = (y - row) * np.cos(TURN) - (x - col) * np.sin(TURN)
            across = np.abs(down) < 18
            ground[across & (right > -14) & (right < 6)] = 600.0
            ground[across & (right >= 6) & (right < 6 + SHADOW_PX)] = -200.0
            far = 6 + SHADOW_PX
            borders.append((row + far * np.sin(TURN), col + far * np.cos(TURN)))
    blurred = ndimage.gaussian_filter(ground, 0.45 * SAMPLES)
    pixels = blurred.reshape(SIZE_PX, SAMPLES, SIZE_PX, SAMPLES).mean(axis=(1, 3))
    return pixels + np.random.default_rng(2).normal(0.0, 6.0, pixels.shape), np.array(borders)


def used_beside_shadows(image, borders):
    """How many used edges lie on the far borders of shadows."""
    edges = ac.scan_scene(image).edges
    places = np.column_stack([edges.row, edges.col])[edges.used]
    return int(np.sum(np.linalg.norm(places[:, None] - borders, axis=2).min(axis=1) < 4.0))


def test_borders_of_clipped_shadows_are_not_used(roofs, few_forms):
    image, borders = roofs
    with few_forms():
        assert used_beside_shadows(image, borders) >= 6
        assert used_beside_shadows(np.maximum(np.rint(image), 0.0), borders) == 0
