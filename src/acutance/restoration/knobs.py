"""What a person turns: noise gain, MTF at Nyquist or overshoot; the weight of noise follows."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from numbers import Real

import numpy as np
from scipy.optimize import brentq

from acutance.curves import Otf2d, Response
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError
from acutance.restoration.filtered_otf import FilteredOtf
from acutance.restoration.kernel_family import KernelFamily
from acutance.restoration.known_otf import KnownOtf

__all__ = ["Knob", "Turned", "chosen_knob", "weight_of", "worst_overshoot"]

_WORDS = {
    "noise_gain": "a noise gain",
    "mtf_nyquist": "an MTF at Nyquist (mean of across and along)",
    "overshoot": "an overshoot",
}


@dataclass(frozen=True)
class Knob:
    """The one number that was asked for.

    Parameters
    ----------
    name : {"noise_gain", "mtf_nyquist", "overshoot"}
    value : float
    """

    name: str
    value: float


def chosen_knob(**asked: float | None) -> Knob | None:
    """The one knob of those given; ``None`` if none is: the least expected error is asked for.

    Raises
    ------
    OptionError
        If several are given, or one is no positive number.
    """
    given = {name: value for name, value in asked.items() if value is not None}
    if len(given) > 1:
        raise OptionError(
            f"{' and '.join(given)} were given, and each of them determines the kernel: give one, "
            "the others are reported"
        )
    for name, value in given.items():
        if isinstance(value, bool) or not isinstance(value, Real) or not 0 < value < math.inf:
            raise OptionError(f"{name} is {value!r}: give a finite number above 0")
        return Knob(name, float(value))
    return None


@dataclass(frozen=True, eq=False)
class Turned(ShortRepr):
    """A family of kernels on a sensor: its numbers at any weight of the noise.

    Parameters
    ----------
    family : KernelFamily
    known : KnownOtf
    """

    family: KernelFamily
    known: KnownOtf

    def responses(self, weight: float) -> tuple[Response, ...]:
        """Curves across and along."""
        model = FilteredOtf(self.known.otf.model, self.family.kernel(weight))
        otf = Otf2d(model, self.known.otf.gsd_m)
        return tuple(otf.response(angle) for angle in self.known.axes_deg.values())

    @cached_property
    def unfiltered(self) -> tuple[Response, ...]:
        """Curves of the sensor alone."""
        return tuple(self.known.otf.response(angle) for angle in self.known.axes_deg.values())

    def value(self, name: str, weight: float) -> float:
        """One of the knobs at a weight."""
        if name == "noise_gain":
            return self.family.noise_gain(weight)
        responses = self.responses(weight)
        if name == "mtf_nyquist":
            return sum(one.mtf_nyquist.value for one in responses) / len(responses)
        return worst_overshoot(responses)


def worst_overshoot(responses: tuple[Response, ...]) -> float:
    """The largest overshoot or undershoot of all directions."""
    return max(max(one.overshoot.value, one.undershoot.value) for one in responses)


def weight_of(knob: Knob, turned: Turned, sharper: str = "") -> float:
    """The weight of noise whose kernel has the number asked for: the sharpest that has it.

    Overshoot does not always rise with sharpness: a kernel that smooths may overshoot too.

    Parameters
    ----------
    knob : Knob
    turned : Turned
    sharper : str, optional
        What else reaches more than these kernels, in words.

    Raises
    ------
    OptionError
        If no kernel of the family reaches it: the message has what they reach.
    """
    from_smooth = turned.family.weights[::-1]
    values = np.array([turned.value(knob.name, float(weight)) for weight in from_smooth])
    reached = np.flatnonzero((values[:-1] < knob.value) & (values[1:] >= knob.value))
    if not reached.size:
        raise OptionError(_out_of_reach(knob, values, turned.family.size, sharper))
    last = int(reached[-1])
    low, high = (math.log(float(from_smooth[i])) for i in (last + 1, last))

    def excess(log_weight: float) -> float:
        return turned.value(knob.name, math.exp(log_weight)) - knob.value

    return math.exp(float(brentq(excess, low, high, xtol=1e-10)))


def _out_of_reach(knob: Knob, values: Floats, size: int, sharper: str) -> str:
    other = f", or {sharper}" if sharper and knob.value > values.max() else ""
    digits = 2 if knob.name == "noise_gain" else 4
    return (
        f"{_WORDS[knob.name]} of {knob.value:g} was requested, and kernels of {size} by {size} "
        f"pixels for this sensor reach {values.min():.{digits}f} to {values.max():.{digits}f}: "
        f"choose a value between them{other}{_meant(knob)}"
    )


def _meant(knob: Knob) -> str:
    """A question, where per cent may have been given for a share."""
    if knob.name != "overshoot" or not 1 <= knob.value < 100:
        return ""
    return f"; it is a share of the contrast: was {knob.value / 100:g} ({knob.value:g} %) meant?"
