"""Whether the stated width of a pulse can be right: by the joint fit, and the published way.

The joint fit finds the width with the line spread function (LSF), with a standard deviation. The
reports of South Dakota State University (Helder, Choi, "Generic sensor modeling using pulse
method", 2005, sections 3.6.3 and 3.6.4) look at the MTF of the ratio: with too large a width it
lies too high at .3 and too low at .4 cycles per pixel, and the width that makes it smooth is taken
for the true one.

What a wrong width does is in `pulse_spectrum`; its functions can be had here too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.errors import OptionError
from acutance.targets.straight.fit_pulse import SplinePulse
from acutance.targets.straight.published import PublishedPulse
from acutance.targets.straight.pulse_spectrum import (
    CriticalFrequency,
    critical_frequencies,
    width_error_gain,
    width_sensitivity_per_px,
    zeros_cpp,
)

__all__ = [
    "CriticalFrequency",
    "WidthConsistency",
    "WidthSearch",
    "critical_frequencies",
    "smoothest_width",
    "width_consistency",
    "width_error_gain",
    "width_sensitivity_per_px",
    "zeros_cpp",
]

_AGREES, _DOUBTFUL = 2.0, 3.0
_DEFORMED_CPP = (0.3, 0.4)
_SMOOTH_TERMS = 4


@dataclass(frozen=True)
class WidthConsistency:
    """A stated width against the one found in the image.

    Parameters
    ----------
    stated_px, found_px, std_px : float
        Widths along the normal and the standard deviation of the one that was fitted.
    """

    stated_px: float
    found_px: float
    std_px: float

    @property
    def difference_px(self) -> float:
        """Found minus stated."""
        return self.found_px - self.stated_px

    @property
    def sigmas(self) -> float:
        """The difference in standard deviations, with its sign."""
        return self.difference_px / self.std_px

    @property
    def consistent(self) -> bool:
        """Whether the difference is within two standard deviations."""
        return abs(self.sigmas) <= _AGREES

    @property
    def verdict(self) -> str:
        """One sentence: how large the difference is, how sure, and what it would do."""
        found = (
            f"the image shows a width of {self.found_px:.3f} ± {self.std_px:.3f} px, stated are "
            f"{self.stated_px:.3f}"
        )
        if self.consistent:
            return f"{found}: they agree within {abs(self.sigmas):.1f} standard deviations"
        side = "narrow" if self.difference_px > 0 else "wide"
        sure = "probably" if abs(self.sigmas) <= _DOUBTFUL else "almost certainly"
        gain = float(width_error_gain(self.found_px, self.stated_px, NYQUIST_CPP))
        return (
            f"{found}: the stated one, or the GSD, is {sure} too {side} by "
            f"{abs(self.difference_px):.3f} px ({abs(self.sigmas):.1f} standard deviations); the "
            f"ratio method would be {100 * (gain - 1):+.1f} % off at Nyquist"
        )

    def to_dict(self) -> dict[str, float | bool | str]:
        """Numbers and verdict by name."""
        return {
            "stated_px": self.stated_px,
            "found_px": self.found_px,
            "std_px": self.std_px,
            "difference_px": self.difference_px,
            "sigmas": self.sigmas,
            "consistent": self.consistent,
            "verdict": self.verdict,
        }


def width_consistency(fit: SplinePulse, stated_width_px: float) -> WidthConsistency:
    """Whether a stated width agrees with the one the joint fit found.

    Parameters
    ----------
    fit : SplinePulse
        Fitted with the width free.
    stated_width_px : float
        Along the normal.

    Returns
    -------
    WidthConsistency

    Raises
    ------
    OptionError
        If the width was held in that fit, so that it has no standard deviation.
    """
    if not fit.pulse_width.std > 0:
        raise OptionError(
            "the width was held at its stated value and has no standard deviation: fit the pulse "
            "with fit_width=True"
        )
    if not stated_width_px > 0:
        raise OptionError(f"a pulse has a width of {stated_width_px:g} px: give one above 0")
    return WidthConsistency(stated_width_px, fit.pulse_width.value, fit.pulse_width.std)


@dataclass(frozen=True, eq=False)
class WidthSearch:
    """Widths tried in the ratio of one profile, and the one that makes the smoothest MTF.

    Parameters
    ----------
    stated_px : float
        Width along the normal that was used.
    width_px, roughness : (n,) arrays
        Widths along the normal, and the rms residual of the profile's spectrum about a smooth MTF
        times the spectrum of a pulse of this width.
    chosen_px : float
        Width of the least roughness.
    deformation : (float, float)
        How far the MTF with the stated width lies above the smooth one at .3 and .4 cycles per
        pixel, relative to it.
    correction_gain : float
        Factor on the MTF at Nyquist when the chosen width replaces the one in the ratio.
    """

    stated_px: float
    width_px: Floats
    roughness: Floats
    chosen_px: float
    deformation: tuple[float, float]
    correction_gain: float

    @property
    def verdict(self) -> str:
        """One sentence, by the signs the report gives for a 3 px pulse."""
        low, high = self.deformation
        lies = f"M is {100 * low:+.0f} % off a smooth curve at .3 and {100 * high:+.0f} % at .4"
        if abs(low) + abs(high) < 0.05:
            return f"{lies}: no deformation, the stated width of {self.stated_px:.3f} px is usable"
        side = "large" if self.stated_px > self.chosen_px else "small"
        return (
            f"{lies}: the stated width of {self.stated_px:.3f} px is too {side}, "
            f"{self.chosen_px:.3f} px gives the smoothest curve"
        )

    def to_dict(self) -> dict[str, float | str | list[float]]:
        """Numbers, lists and verdict by name."""
        return {
            "stated_px": self.stated_px,
            "chosen_px": self.chosen_px,
            "deformation": list(self.deformation),
            "correction_gain": self.correction_gain,
            "verdict": self.verdict,
            "width_px": self.width_px.tolist(),
            "roughness": self.roughness.tolist(),
        }


def smoothest_width(
    fit: PublishedPulse, widths_px: ArrayLike | None = None, *, up_to_cpp: float = 0.5
) -> WidthSearch:
    """The published correction: of several widths, the one whose ratio is the smoothest curve.

    The reports try widths and judge the curve by eye, mostly at .3 and .4 cycles per pixel. Here
    the profile's spectrum is fitted by ``sinc(w f)`` times a smooth MTF, an even polynomial of
    degree 8 that is 1 at frequency 0. What is left is the roughness of the ratio, weighted by
    the pulse's spectrum so that the zero itself does not count.

    Parameters
    ----------
    fit : PublishedPulse
    widths_px : (n,) array, optional
        Widths along the normal to try, evenly spaced, at least three; steps of 0.01 px to
        12 % on both sides of the stated width unless given.
    up_to_cpp : float, optional
        Highest frequency that is judged.

    Returns
    -------
    WidthSearch
        Noise-free it finds the width to 0.02 px for smooth MTFs of every kind. It has no
        standard deviation: the joint fit's width has, see
        `width_consistency`.
    """
    stated = fit.pulse_width.value
    if widths_px is None:
        reach = math.ceil(0.12 * stated / 0.01)
        tried = stated + 0.01 * np.arange(-reach, reach + 1, dtype=float)
    else:
        tried = np.sort(np.asarray(widths_px, dtype=float))
    if tried.size < 3 or not tried[0] > 0:
        raise OptionError(f"at least three widths above 0 px must be tried, found {tried}")
    mtf = fit.response.mtf
    freq = mtf.freq_cpp[mtf.freq_cpp <= up_to_cpp + 1e-9]
    spectrum = (mtf.otf[: freq.size] * np.sinc(fit.ratio_width_px * freq)).real
    fitted = [_smooth_mtf(freq, spectrum, w * fit.px_per_normal) for w in tried.tolist()]
    roughness = np.array([rough for rough, _ in fitted])
    chosen = _lowest(tried, roughness)
    on_axis = chosen * fit.px_per_normal
    _, coefficient = _smooth_mtf(freq, spectrum, on_axis)
    smooth = 1.0 + _even_powers(np.array(_DEFORMED_CPP), float(freq[-1])) @ coefficient
    low, high = (mtf(f).value / float(m) - 1.0 for f, m in zip(_DEFORMED_CPP, smooth, strict=True))
    gain = float(width_error_gain(fit.ratio_width_px, on_axis, NYQUIST_CPP))
    return WidthSearch(stated, tried, roughness, chosen, (low, high), gain)


def _smooth_mtf(freq: Floats, spectrum: Floats, width_px: float) -> tuple[float, Floats]:
    """Rms residual of a smooth MTF times the pulse's spectrum, and the MTF's coefficients."""
    pulse = np.sinc(width_px * freq)
    basis = _even_powers(freq, float(freq[-1])) * pulse[:, None]
    coefficient = np.asarray(np.linalg.lstsq(basis, spectrum - pulse, rcond=None)[0], dtype=float)
    left = spectrum - pulse - basis @ coefficient
    return float(np.sqrt(np.mean(left**2))), coefficient


def _even_powers(freq: Floats, scale: float) -> Floats:
    return np.asarray((freq[:, None] / scale) ** (2 * np.arange(1, _SMOOTH_TERMS + 1)))


def _lowest(place: Floats, value: Floats) -> float:
    """Place of the minimum, by the parabola through the squares of its neighbours."""
    i = min(max(int(np.argmin(value)), 1), value.size - 2)
    a, b, c = value[i - 1 : i + 2] ** 2
    bend = a - 2 * b + c
    shift = 0.5 * (a - c) / bend if bend > 0 else 0.0
    return float(place[i] + np.clip(shift, -1, 1) * 0.5 * (place[i + 1] - place[i - 1]))
