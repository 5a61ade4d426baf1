"""Where the ends of a fan are."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter

from acutance.geometry.star_geometry import SiemensStar
from acutance.targets.periodic.star_extent import extent_of


def test_ends_of_a_fan_of_an_odd_number_of_cycles() -> None:
    """Sectors of two cycles divide a turn where that is even; else they are somewhat wider."""
    cycles, rim_px, middle, fine = 13, 70.0, 80.0, 4
    place = (np.arange(161 * fine) + 0.5) / fine - 0.5 - middle
    y, x = np.meshgrid(place, place, indexing="ij")
    angle = np.arctan2(y, x)
    lit = (np.hypot(x, y) < rim_px) & (np.mod(np.degrees(angle) - 123.0, 360) < 150)
    wave = np.where(lit, 50 * np.cos(cycles * angle), 0.0) + 100
    image = wave.reshape(161, fine, 161, fine).mean(axis=(1, 3))
    star = SiemensStar(middle, middle, cycles, 0.0, rim_px)
    seen = np.ones(image.shape, bool)
    found = extent_of(gaussian_filter(image, 1.5), seen, star, star.radius_at(0.3))
    last_deg = found.first_deg + found.sweep_deg
    off = [abs((end + 180) % 360 - 180) for end in (found.first_deg - 123, last_deg - 273)]
    assert max(off) < 5
