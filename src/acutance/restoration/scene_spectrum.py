"""The power spectrum of a scene: natural, stiff (constrained least squares), or of an image."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from acutance.arguments import require_numbers
from acutance.curves.grid import Floats
from acutance.errors import OptionError

__all__ = ["NaturalScene", "SceneSpectrum", "StiffScene"]

_LOWEST_CPP = 1 / 512
"""Below this the power of a natural scene no longer rises: a scene has an end."""


class SceneSpectrum(Protocol):
    """Power of a scene over the plane of frequencies, that of the noise being 1."""

    def power(self, u_cpp: Floats, v_cpp: Floats) -> Floats:
        """Power per square cycle per pixel at any frequencies, over that of white noise."""
        ...

    def to_dict(self) -> dict[str, Any]:
        """What it is, for JSON."""
        ...


@dataclass(frozen=True)
class NaturalScene:
    """A scene whose power falls as a power of frequency: of photographs of nature as 1/f^2.

    Parameters
    ----------
    contrast_to_noise : float
        Standard deviation of the scene, before blur, over that of the noise.
    exponent : float, optional
        Power falls as ``f ** -exponent``: 2 of natural scenes, nearer 3 where a scene is made of
        areas with sharp borders.
    origin : str, optional
        "stated", or the image it was measured in.

    Raises
    ------
    OptionError
        If contrast or exponent makes no sense.
    """

    contrast_to_noise: float
    exponent: float = 2.0
    origin: str = "stated"

    def __post_init__(self) -> None:
        require_numbers(contrast_to_noise=self.contrast_to_noise, exponent=self.exponent)
        if not (0 < self.contrast_to_noise < math.inf and 0.5 <= self.exponent <= 6.0):
            raise OptionError(
                f"a scene of contrast to noise {self.contrast_to_noise:g} and exponent "
                f"{self.exponent:g} was requested: the first has to be above 0, the second "
                "between 0.5 and 6"
            )

    @cached_property
    def _height(self) -> float:
        """Power at 1 c/px for which the square below Nyquist holds the scene's variance."""
        radius = np.geomspace(_LOWEST_CPP / 100, math.sqrt(0.5), 4000)
        # Of a circle the part inside the square |u|, |v| <= 1/2.
        inside = np.where(radius > 0.5, 1 - 4 / math.pi * np.arccos(np.minimum(0.5 / radius, 1)), 1)
        density = self._shape(radius) * 2 * math.pi * radius * inside
        return self.contrast_to_noise**2 / float(np.trapezoid(density, radius))

    def _shape(self, radius: Floats) -> Floats:
        return np.asarray((_LOWEST_CPP**2 + radius**2) ** (-self.exponent / 2))

    def power(self, u_cpp: Floats, v_cpp: Floats) -> Floats:
        """Power per square cycle per pixel at any frequencies, over that of white noise."""
        return self._height * self._shape(np.hypot(u_cpp, v_cpp))

    def to_dict(self) -> dict[str, Any]:
        """What it is, for JSON."""
        return {
            "kind": "natural",
            "contrast_to_noise": self.contrast_to_noise,
            "exponent": self.exponent,
            "origin": self.origin,
        }


@dataclass(frozen=True)
class StiffScene:
    """The scene that constrained least squares assumes: one over the square of the Laplacian.

    A kernel that keeps the Laplacian of the result small (Hunt 1973) is Wiener's of this scene.
    """

    def power(self, u_cpp: Floats, v_cpp: Floats) -> Floats:
        """Power at any frequencies; its scale is that of the weight of noise, and free."""
        laplacian = 4 - 2 * np.cos(2 * math.pi * u_cpp) - 2 * np.cos(2 * math.pi * v_cpp)
        lowest = (2 * math.pi * _LOWEST_CPP) ** 2
        inside = (np.abs(u_cpp) <= 0.5) & (np.abs(v_cpp) <= 0.5)
        return np.where(inside, 1 / (laplacian**2 + lowest**2), 0.0)

    def to_dict(self) -> dict[str, Any]:
        """What it is, for JSON."""
        return {"kind": "stiff"}
