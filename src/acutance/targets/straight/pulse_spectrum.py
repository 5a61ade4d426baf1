"""The spectrum of a pulse, ``sinc(w f)``: where it vanishes, and what a wrong width does.

The ratio method divides by it: a wrong width shows, and near its zeros everything does. The joint
fit of pulse and line spread function (LSF) does not divide.

Source of the sensitivities and corrections: Helder, Choi, "Generic sensor modeling using pulse
method" (2005), section 3.6.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.errors import OptionError

__all__ = [
    "CriticalFrequency",
    "critical_frequencies",
    "width_error_gain",
    "width_sensitivity_per_px",
    "zeros_cpp",
]

_MARGIN_CPP = 0.05


def zeros_cpp(width_px: float, up_to_cpp: float = 1.0) -> Floats:
    """Frequencies at which the spectrum of a pulse vanishes: multiples of 1 / width.

    Parameters
    ----------
    width_px : float
    up_to_cpp : float, optional
        Highest frequency of interest in cycles per pixel.

    Returns
    -------
    (n,) array
        Ascending; empty where the first zero lies higher.
    """
    if not width_px > 0:
        raise OptionError(f"a pulse has a width of {width_px:g} px: give one above 0")
    return np.arange(1, math.floor(up_to_cpp * width_px + 1e-9) + 1) / width_px


def width_error_gain(
    width_true_px: ArrayLike, width_used_px: ArrayLike, freq_cpp: ArrayLike
) -> Floats:
    """The ratio method's MTF with a wrong width, over its MTF with the true one.

    ``|sinc(w_true f) / sinc(w_used f)|``. With the old and the new width in its place it is also
    what a correction changes: 8.77 to 8.85 m at 2.8 m GSD gives 1.0198 at Nyquist.

    Parameters
    ----------
    width_true_px, width_used_px, freq_cpp : float or arrays that broadcast

    Returns
    -------
    array
        Infinite where only the used width has a zero.
    """
    freq = np.asarray(freq_cpp, dtype=float)
    true, used = np.asarray(width_true_px, dtype=float), np.asarray(width_used_px, dtype=float)
    if not (np.all(true > 0) and np.all(used > 0)):
        raise OptionError("a pulse has a width that is not above 0: give one above 0 px")
    with np.errstate(divide="ignore", invalid="ignore"):
        gain = np.abs(_sinc(true * freq) / _sinc(used * freq))
    return np.asarray(np.where(np.broadcast_to(true == used, gain.shape), 1.0, gain))


def _sinc(x: Floats) -> Floats:
    """``sin(pi x) / (pi x)`` with zeros that are 0."""
    whole = (np.abs(x - np.rint(x)) < 1e-12) & (np.abs(x) > 0.5)
    return np.where(whole, 0.0, np.sinc(x))


def width_sensitivity_per_px(width_px: float, freq_cpp: ArrayLike) -> Floats:
    """Relative change of the ratio method's MTF per pixel the true width exceeds the used one.

    The derivative of `width_error_gain` by the true width, ``pi f cot(pi w f) - 1 / w``: for
    3 px -3.23 at .3, +1.40 at .4 and -0.33 at .5 cycles per pixel. A used width that is too
    large changes it by the opposite.

    Parameters
    ----------
    width_px : float
    freq_cpp : float or array
        Above 0.

    Returns
    -------
    array of the shape of `freq_cpp`
        Infinite at a zero of the spectrum.
    """
    angle = np.pi * np.asarray(freq_cpp, dtype=float)
    with np.errstate(divide="ignore"):
        return np.asarray(angle / np.tan(angle * width_px) - 1.0 / width_px)


@dataclass(frozen=True)
class CriticalFrequency:
    """A frequency near a zero of the pulse's spectrum.

    Parameters
    ----------
    name : str
        What is reported there.
    freq_cpp, zero_cpp : float
        The frequency, and the zero nearest to it.
    change_per_percent : float
        Relative change of the MTF there when the width is wrong by one percent.
    """

    name: str
    freq_cpp: float
    zero_cpp: float
    change_per_percent: float

    def __str__(self) -> str:
        percent = min(100 * self.change_per_percent, 100.0)
        return (
            f"{self.name} ({self.freq_cpp:.3f} cycles/px) lies {self.distance_cpp:.3f} from a "
            f"zero of the pulse's spectrum at {self.zero_cpp:.3f}: a width wrong by 1 % changes "
            f"the ratio method's MTF there by {percent:.0f} %"
            f"{' or more' if percent >= 100 else ''}; use the joint fit, or a target of another "
            "width"
        )

    @property
    def distance_cpp(self) -> float:
        """How far apart the two are."""
        return abs(self.freq_cpp - self.zero_cpp)

    def to_dict(self) -> dict[str, float | str]:
        """All numbers by name."""
        return {**vars(self), "distance_cpp": self.distance_cpp}


def critical_frequencies(
    width_px: float,
    frequencies: Mapping[str, float] | None = None,
    margin_cpp: float = _MARGIN_CPP,
) -> tuple[CriticalFrequency, ...]:
    """Reported frequencies at which the ratio method cannot be trusted with this width.

    Parameters
    ----------
    width_px : float
        Width in the ratio.
    frequencies : mapping of str to float, optional
        What is reported, by name: Nyquist and .25 cycles per pixel unless given; MTF50 and
        MTF30 may be NaN.
    margin_cpp : float, optional
        Nearest a zero may be.

    Returns
    -------
    tuple of CriticalFrequency
        Those too near, in the order given; its text is a warning.

    Examples
    --------
    >>> for warning in critical_frequencies(8.83 / 2.4):
    ...     print(warning.name, round(warning.zero_cpp, 4))
    Nyquist 0.5436
    0.25 0.2718
    """
    if frequencies is None:
        frequencies = {"Nyquist": NYQUIST_CPP, "0.25": 0.25}
    found = []
    for name, freq in frequencies.items():
        if not freq > 0:
            continue
        zeros = zeros_cpp(width_px, freq + margin_cpp)
        if zeros.size == 0:
            continue
        zero = float(zeros[np.argmin(np.abs(zeros - freq))])
        if abs(zero - freq) <= margin_cpp:
            change = abs(float(width_sensitivity_per_px(width_px, freq))) * 0.01 * width_px
            found.append(CriticalFrequency(name, freq, zero, change))
    return tuple(found)
