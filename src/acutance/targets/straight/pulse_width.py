"""Whether the stated width of a pulse can be right, the published way.

The reports of South Dakota State University (Helder, Choi, "Generic sensor modeling using pulse
method", 2005, sections 3.6.3 and 3.6.4) look at the MTF of the ratio: with too large a width it
lies too high at .3 and too low at .4 cycles per pixel, and the width that makes it smooth is taken
for the true one. The joint fit finds the width with the line spread function, with a standard
deviation; the check ``width_sigmas`` compares the stated one with that.

What a wrong width does is in `pulse_spectrum`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.errors import OptionError
from acutance.targets.straight.published import PublishedPulse
from acutance.targets.straight.pulse_spectrum import width_error_gain

__all__ = ["WidthSearch", "smoothest_width"]

_DEFORMED_CPP = (0.3, 0.4)
_SMOOTH_TERMS = 4


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
        standard deviation: the joint fit's width has, which the check ``width_sigmas`` compares.

    Raises
    ------
    OptionError
        If there are fewer than three widths, or one is not above 0.
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
