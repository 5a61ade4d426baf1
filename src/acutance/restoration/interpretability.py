"""NIIRS of an image from its sharpness, sampling distance and SNR, with what is not known of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from acutance.curves import Estimate
from acutance.errors import OptionError
from acutance.restoration.giqe import EQUATION_STD, JUMP_RER, GiqeInputs, giqe, giqe4_jump
from acutance.targets import Measurement, Record

__all__ = ["GiqeVersion", "Niirs", "Note", "niirs", "read_niirs_inputs"]

GiqeVersion = Literal[3, 4, 5]

_MIN_SNR = 5.0
_RER_RANGE = (0.2, 1.3)
"""Outside of these an equation is extrapolated: few images are that soft or that sharpened."""
_GSD_RANGE_M = (0.05, 10.0)
"""Bounds of ours: levels 1 to 9 of the scale are those of some 9 m to .1 m."""
_MIN_ELEVATION_DEG = 30.0
"""A bound of ours: below it the two sides of a pixel on the ground differ by more than two."""
_SCALE = (0.0, 9.0)
_POSSIBLE = {
    "gsd_m": (1e-3, 1e5),
    "rer_across": (1e-3, 2.0),
    "rer_along": (1e-3, 2.0),
    "snr": (1e-3, 1e9),
    "giqe_h": (1e-3, 100.0),
    "noise_gain": (1e-3, 1e3),
    "elevation_deg": (5.0, 90.0),
}
"""What any image may have, also one that was sharpened; the equations have no meaning beyond."""
_EXTRAPOLATED = "the equation is extrapolated, and its own deviation is not known there"
_NEAR_JUMP_STDS = 2.0
_STEP = 1e-4


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


@dataclass(frozen=True, eq=False)
class Niirs(Estimate):
    """A NIIRS with its standard deviation: that of the inputs and the equation's own.

    Parameters
    ----------
    version : {3, 4, 5}
        Of the General Image Quality Equation (GIQE).
    inputs_std : float
        The share of the measurement: of RER, overshoot and SNR.
    equation_std : float
        How far ratings scatter about the equation.
    inputs : GiqeInputs
        What it was computed from.
    notes : tuple of Note
        Where the equation was not made for such an image.

    Examples
    --------
    >>> print(niirs(gsd_m=0.7, rer=(0.45, 0.42), snr=80, elevation_deg=70))
    4.68 ± 0.30 (GIQE 5)
    """

    version: GiqeVersion = 5
    inputs_std: float = 0.0
    equation_std: float = 0.0
    inputs: GiqeInputs | None = None
    notes: tuple[Note, ...] = ()

    def __str__(self) -> str:
        plain = Estimate(self.value, self.std)
        noted = f", {'; '.join(note.name for note in self.notes)}" if self.notes else ""
        return f"{plain} (GIQE {self.version}{noted})"

    def to_dict(self) -> dict[str, Any]:
        """Value, deviations, interval, inputs and notes, for JSON."""
        own = self.inputs
        return {
            **super().to_dict(),
            "version": self.version,
            "inputs_std": self.inputs_std,
            "equation_std": self.equation_std,
            "inputs": None if own is None else dict(vars(own)),
            "notes": [{"name": one.name, "message": one.message} for one in self.notes],
        }


def niirs(
    measurement: Measurement | Record | None = None,
    *,
    gsd_m: float | tuple[float, float] | None = None,
    rer: float | Estimate | Sequence[float | Estimate] | None = None,
    snr: float | Estimate | None = None,
    elevation_deg: float = 90.0,
    version: GiqeVersion = 5,
    giqe_h: float | Estimate | None = None,
    noise_gain: float = 1.0,
) -> Niirs:
    """NIIRS by the General Image Quality Equation (GIQE).

    Parameters
    ----------
    measurement : Measurement or Record, optional
        Gives RER, overshoot H, GSD and SNR, unless they are stated.
    gsd_m : float or (float, float), optional
        Ground sampling distance normal to the line of sight in metres; of two their geometric
        mean counts.
    rer : float, Estimate or two of them, optional
        Relative edge response across and along; one number stands for both.
    snr : float or Estimate, optional
        Signal to noise ratio, before sharpening.
    elevation_deg : float, optional
        Of the line of sight over the horizon, 90 at nadir.
    version : {3, 4, 5}, optional
    giqe_h : float or Estimate, optional
        Edge height overshoot H of versions 3 and 4 (`Response.giqe_h`); without a measurement 1.
    noise_gain : float, optional
        Of the sharpening (versions 3 and 4).

    Returns
    -------
    Niirs
        An `Estimate` with notes.

    Raises
    ------
    OptionError
        If GSD, RER or SNR is missing or out of the range of any image.
    """
    _require(version, elevation_deg, noise_gain)
    known = read_niirs_inputs(measurement, gsd_m, rer, snr, giqe_h)
    values = [float(known[name]) for name in ("rer_across", "rer_along", "snr", "giqe_h")]
    inputs = _inputs(values, float(known["gsd_m"]), elevation_deg, noise_gain)
    spread = _inputs_std(inputs, values, known, version)
    value = giqe(inputs, version)
    return Niirs(
        value,
        math.hypot(spread, EQUATION_STD),
        version=version,
        inputs_std=spread,
        equation_std=EQUATION_STD,
        inputs=inputs,
        notes=(
            *_notes(inputs, value, version, float(known["rer_std"])),
            *((ONE_DIRECTION,) if known.get("one_direction") else ()),
        ),
    )


def read_niirs_inputs(
    measurement: Measurement | Record | None,
    gsd_m: float | tuple[float, float] | None,
    rer: float | Estimate | Sequence[float | Estimate] | None,
    snr: float | Estimate | None,
    giqe_h: float | Estimate | None,
) -> dict[str, Any]:
    """What the equations need, of a measurement or as stated, by name.

    Raises
    ------
    OptionError
        If something is missing, or out of the range of any image.
    """
    record = measurement.record if isinstance(measurement, Measurement) else measurement
    found: dict[str, Any] = {} if record is None else _of_record(record)
    if rer is not None:
        both = list(rer) if isinstance(rer, Sequence) else [rer, rer]
        if len(both) != 2:
            raise OptionError(f"rer has {len(both)} values: give one, or those across and along")
        found |= {
            "rer_across": both[0],
            "rer_along": both[1],
            "correlated": len({*map(id, both)}) == 1,
            "one_direction": False,
        }
    if gsd_m is not None:
        sides = list(gsd_m) if isinstance(gsd_m, Sequence) else [gsd_m, gsd_m]
        if len(sides) != 2:
            raise OptionError(f"gsd_m has {len(sides)} values: give one, or those of both sides")
        row_m, col_m = (_possible("gsd_m", side) for side in sides)
        found["gsd_m"] = math.sqrt(row_m * col_m)
    for name, value in (("snr", snr), ("giqe_h", giqe_h)):
        if value is not None:
            found[name] = value
    found.setdefault("giqe_h", 1.0)
    _require_numbers(found)
    found["rer_std"] = max(_std(found[name]) for name in ("rer_across", "rer_along"))
    return found


def _of_record(record: Record) -> dict[str, Any]:
    """Numbers of a measurement; one direction stands for both."""
    directions = [record.directions[name] for name in record.measured_directions]
    first, last = directions[0], directions[-1]
    heights = [one.giqe_h for one in directions if math.isfinite(one.giqe_h.value)]
    mean_h = math.exp(sum(math.log(max(one.value, 1e-3)) for one in heights) / max(len(heights), 1))
    pixel_m = record.image.pixel_gsd_m
    found = {
        "rer_across": first.rer,
        "rer_along": last.rer,
        "giqe_h": Estimate(mean_h, max((one.std for one in heights), default=0.0)),
        "correlated": True,
        "one_direction": len(directions) == 1,
    }
    if pixel_m is not None:
        found["gsd_m"] = math.sqrt(pixel_m[0] * pixel_m[1])
    return found | ({"snr": record.snr} if math.isfinite(record.snr) else {})


def _require_numbers(found: dict[str, Any]) -> None:
    missing = [name for name in ("gsd_m", "rer_across", "snr") if name not in found]
    if missing:
        words = {
            "gsd_m": "the ground sampling distance (gsd_m, --gsd-m)",
            "snr": "the SNR (snr, --snr)",
        }
        named = " and ".join(words.get(name, "the RER (rer, --rer)") for name in missing)
        raise OptionError(f"NIIRS needs {named}: state it, or give a measurement that has it")
    for name in ("gsd_m", "rer_across", "rer_along", "snr", "giqe_h"):
        _possible(name, found[name])


def _possible(name: str, given: Any) -> float:
    """A number that an image may have.

    Raises
    ------
    OptionError
        If it is none.
    """
    low, high = _POSSIBLE[name]
    try:
        value = float(given)
    except (TypeError, ValueError):
        raise OptionError(f"{name} is {given!r}: give a number") from None
    if isinstance(given, bool) or not low <= value <= high:
        raise OptionError(f"{name} is {value:g}: it has to be from {low:g} to {high:g}")
    return value


def _require(version: int, elevation_deg: float, noise_gain: float) -> None:
    if version not in (3, 4, 5):
        raise OptionError(f"version is {version!r}: there are versions 3, 4 and 5 of the GIQE")
    _possible("elevation_deg", elevation_deg)
    _possible("noise_gain", noise_gain)


def _inputs(
    values: Sequence[float], gsd_m: float, elevation_deg: float, noise_gain: float
) -> GiqeInputs:
    across, along, snr, giqe_h = values
    return GiqeInputs(gsd_m, across, along, snr, elevation_deg, giqe_h, noise_gain)


def _inputs_std(
    inputs: GiqeInputs, values: Sequence[float], known: dict[str, Any], version: GiqeVersion
) -> float:
    """Deviation from that of the inputs, to first order.

    RERs of one measurement may err together: they are taken to, which is the wider.
    """
    names = ("rer_across", "rer_along", "snr", "giqe_h")
    stds = [_std(known[name]) for name in names]

    def of(changed: Sequence[float]) -> float:
        again = _inputs(changed, inputs.gsd_m, inputs.elevation_deg, inputs.noise_gain)
        return giqe(again, version)

    terms = [_slope(of, values, i) * std for i, std in enumerate(stds)]
    rer = abs(terms[0] + terms[1]) if known.get("correlated") else math.hypot(*terms[:2])
    return math.hypot(rer, *terms[2:])


def _slope(function: Callable[[Sequence[float]], float], values: Sequence[float], i: int) -> float:
    """Derivative by one of the values, from below: away from the jump of version 4."""
    step = _STEP * values[i]
    moved = [value - step if k == i else value for k, value in enumerate(values)]
    return (function(values) - function(moved)) / step


def _std(value: float | Estimate) -> float:
    return value.std if isinstance(value, Estimate) and math.isfinite(value.std) else 0.0


def _notes(
    inputs: GiqeInputs, value: float, version: GiqeVersion, rer_std: float
) -> tuple[Note, ...]:
    """Where the equation was not made for such an image."""
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


ONE_DIRECTION = Note(
    "one direction",
    "the measurement shows one direction, whose RER stands for both: state the other (rer, --rer), "
    "or give a combination",
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
    return Note(
        "jump at RER 0.9",
        f"RER is {inputs.rer_mean:.3f}, and version 4 changes its coefficients at {JUMP_RER:g}: "
        f"it jumps there by {giqe4_jump(inputs):+.2f}",
    )


def _sharpened(inputs: GiqeInputs, version: GiqeVersion) -> Note | None:
    if version != 5 or (math.isclose(inputs.noise_gain, 1.0) and inputs.rer_weighted <= 1.0):
        return None
    return Note(
        "sharpened image",
        "version 5 is of images before sharpening, and has no term for overshoot or noise gain: "
        "give RER and SNR before it, or use version 4",
    )
