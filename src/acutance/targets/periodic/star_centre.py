"""A star whose spokes end before its centre: printed and painted ones may have a blank middle.

A blank middle looks like a transfer that falls to nothing. No sensor's transfer does so within the
width of its own blur: the pixels further out predict the spokes of the next rings, with their
deviation. Where these rings have none, the star ends there, and its fit is that of the pixels
further out.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.errors import AcutanceError
from acutance.geometry.star_geometry import SiemensStar
from acutance.targets.periodic.fit_star import StarSolution, solve_star
from acutance.targets.periodic.otf_model import all_modes
from acutance.targets.periodic.star_rings import first_radius, ring_modulations
from acutance.targets.periodic.star_waves import Wave
from acutance.targets.periodic.stated_contrast import Levels

__all__ = ["solve_spokes"]

_BLUR_RINGS: Final = 3
"""Rings of a pixel over which a border is blurred."""
_BLANK_SHARE: Final = 0.1
"""Largest amplitude of a blank ring over that beyond the border's blur."""
_SEEN_SIGMAS: Final = 3.0
"""Deviations from which on a ring has spokes, and lacks those that are predicted."""
_FINEST_CPP: Final = 0.85
"""Of spokes that are finer a blank middle takes nothing that matters below Nyquist."""
_MIN_BLANK_PX: Final = 3.0
"""A smaller middle is as wide as the blur: spokes of few cycles have none there anyway."""
_MARGIN_PX: Final = 3.5
"""From the outermost blank ring to the pixels that a blank middle does not reach."""
_DIRECTIONS_DEG: Final = np.arange(0.0, 180.0, 5.0)


def solve_spokes(
    image: Floats,
    star: SiemensStar,
    *,
    wave: Wave,
    levels: Levels | None,
    inner_px: float | None,
    robust: bool,
) -> StarSolution:
    """Solve a star as far as its spokes reach; parameters and errors of `solve_star`."""

    def solved(inner: float | None) -> StarSolution:
        return solve_star(image, star, wave=wave, levels=levels, inner_px=inner, robust=robust)

    blank_px = _blank_radius(image, star, inner_px)
    if blank_px is not None:
        try:
            outer = solved(blank_px + _MARGIN_PX)
        except AcutanceError:  # too little of the star lies there
            return solved(inner_px)
        if _lacks_spokes(image, outer, blank_px):
            return outer
    return solved(inner_px)


def _blank_radius(image: Floats, star: SiemensStar, inner_px: float | None) -> float | None:
    """Radius of the outermost ring of a middle that seems to be blank."""
    first, last = first_radius(star, inner_px), star.rim_px - _BLUR_RINGS
    freq, amplitude, std = ring_modulations(image, star, first, last)
    if freq.size <= _BLUR_RINGS:
        return None
    beyond = amplitude[_BLUR_RINGS:]
    within, noise = np.abs(amplitude[:-_BLUR_RINGS]), _SEEN_SIGMAS * std[:-_BLUR_RINGS]
    blank = np.flatnonzero(within <= np.maximum(noise, _BLANK_SHARE * beyond))
    if blank.size == 0:
        return None
    end = int(blank[-1])
    largest = np.maximum(noise[: end + 1], _BLANK_SHARE * beyond[end])
    if (
        float(freq[end]) > _FINEST_CPP
        or bool(np.any(within[: end + 1] > largest))
        or beyond[end] < 4 * noise[end]
    ):
        return None
    radius = star.radius_at(float(freq[end]))
    return radius if radius >= _MIN_BLANK_PX else None


def _lacks_spokes(image: Floats, solved: StarSolution, blank_px: float) -> bool:
    """Whether the outermost blank ring has less of the spokes than the pixels further out say."""
    freq, amplitude, std = ring_modulations(
        image, solved.star, blank_px - 0.5, blank_px + 0.5 + 1e-6
    )
    if freq.size == 0:
        return False
    directions = np.array([unit_vector(one) for one in _DIRECTIONS_DEG.tolist()])
    u, v = (float(freq[0]) * directions).T
    modes = np.mean(all_modes(solved.otf.mean, solved.otf.beta.size, u, v).real, axis=0)
    predicted = float(modes @ solved.otf.beta)
    predicted_std = float(np.linalg.norm(modes @ solved.otf.beta_factor))
    return predicted - float(amplitude[0]) > _SEEN_SIGMAS * math.hypot(predicted_std, float(std[0]))
