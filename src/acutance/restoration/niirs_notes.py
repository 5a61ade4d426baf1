"""What has to be said of a NIIRS: where the equation was not made for such an image."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from acutance.restoration.giqe import JUMP_RER, GiqeInputs, giqe4_jump

__all__ = ["NO_OVERSHOOT", "ONE_DIRECTION", "GiqeVersion", "Note", "equation_notes"]

GiqeVersion = Literal[3, 4, 5]

_MIN_SNR = 5.0
_RER_RANGE = (0.2, 1.3)
"""Outside of these an equation is extrapolated: few images are that soft or that sharpened."""
_GSD_RANGE_M = (0.05, 10.0)
"""Bounds of ours: levels 1 to 9 of the scale are those of some 9 m to .1 m."""
_MIN_ELEVATION_DEG = 30.0
"""A bound of ours: below it the two sides of a pixel on the ground differ by more than two."""
_SCALE = (0.0, 9.0)
_EXTRAPOLATED = "the equation is extrapolated, and its own deviation is not known there"
_NEAR_JUMP_STDS = 2.0


@dataclass(frozen=True)
class Note:
    """A warning that belongs to a result.

    Parameters
    ----------
    name : str
    message : str
        What was found, and what it means.
    """

    name: str
    message: str

    def __str__(self) -> str:
        return f"{self.name}: {self.message}"


ONE_DIRECTION = Note(
    "one direction",
    "the measurement shows one direction, whose RER stands for both: state the other (rer, --rer), "
    "or give a measurement of another direction besides (across.json along.json)",
)


NO_OVERSHOOT = Note(
    "overshoot H",
    "version 5 has no term for overshoot, so the stated H changes nothing: use version 3 or 4 "
    "(version, --version)",
)


def equation_notes(
    inputs: GiqeInputs, value: float, version: GiqeVersion, rer_std: float
) -> tuple[Note, ...]:
    """Where the equation was not made for such an image.

    Parameters
    ----------
    inputs : GiqeInputs
    value : float
        What it gave.
    version : {3, 4, 5}
    rer_std : float
        Standard deviation of the RER.
    """
    return tuple(
        note
        for note in (
            _low_snr(inputs),
            _rer_range(inputs),
            _gsd_range(inputs),
            _low_elevation(inputs),
            _off_the_scale(value),
            _jump(inputs, version, rer_std),
            _sharpened(inputs, version),
        )
        if note is not None
    )


def _low_snr(inputs: GiqeInputs) -> Note | None:
    if inputs.snr >= _MIN_SNR:
        return None
    return Note(
        "low SNR",
        f"SNR is {inputs.snr:.3g}, below {_MIN_SNR:g}: the equation overrates such images",
    )


def _rer_range(inputs: GiqeInputs) -> Note | None:
    low, high = _RER_RANGE
    found = [one for one in (inputs.rer_across, inputs.rer_along) if not low <= one <= high]
    if not found:
        return None
    return Note(
        "RER out of range",
        f"RER is {found[0]:.3g}, outside {low:g} to {high:g}: {_EXTRAPOLATED}",
    )


def _gsd_range(inputs: GiqeInputs) -> Note | None:
    low, high = _GSD_RANGE_M
    if low <= inputs.gsd_m <= high:
        return None
    return Note(
        "GSD out of range",
        f"GSD is {inputs.gsd_m:.3g} m, outside {low:g} to {high:g} m: {_EXTRAPOLATED}",
    )


def _low_elevation(inputs: GiqeInputs) -> Note | None:
    if inputs.elevation_deg >= _MIN_ELEVATION_DEG:
        return None
    return Note(
        "low elevation",
        f"the line of sight has an elevation of {inputs.elevation_deg:.3g} degrees, below "
        f"{_MIN_ELEVATION_DEG:g}: {_EXTRAPOLATED}",
    )


def _off_the_scale(value: float) -> Note | None:
    low, high = _SCALE
    if low <= value <= high:
        return None
    return Note("off the scale", f"NIIRS has levels from {low:g} to {high:g} only")


def _jump(inputs: GiqeInputs, version: GiqeVersion, rer_std: float) -> Note | None:
    if version != 4:
        return None
    near = max(_NEAR_JUMP_STDS * rer_std, 0.01)
    if abs(inputs.rer_mean - JUMP_RER) > near:
        return None
    jump = f"{giqe4_jump(inputs):+.2f}".replace("-", "−")
    return Note(
        "jump at RER 0.9",
        f"RER is {inputs.rer_mean:.3f}, and version 4 changes its coefficients at {JUMP_RER:g}: "
        f"it jumps there by {jump}",
    )


def _sharpened(inputs: GiqeInputs, version: GiqeVersion) -> Note | None:
    if version != 5 or (math.isclose(inputs.noise_gain, 1.0) and inputs.rer_weighted <= 1.0):
        return None
    return Note(
        "sharpened image",
        "version 5 is of images before sharpening, and has no term for overshoot or noise gain: "
        "give RER and SNR before it, or use version 4",
    )
