"""NIIRS of an image from its sharpness, sampling distance and SNR, with what is not known of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from numbers import Integral
from typing import Any

from acutance.curves import Estimate
from acutance.errors import OptionError
from acutance.raster.gsd import GSD_RANGE_M
from acutance.restoration.giqe import EQUATION_STD, GiqeInputs, giqe
from acutance.restoration.named_records import (
    Measured,
    combination_warnings,
    measured_inputs,
    median_snr,
    named_records,
    warnings_of,
)
from acutance.restoration.niirs_notes import (
    NO_OVERSHOOT,
    ONE_DIRECTION,
    GiqeVersion,
    Note,
    equation_notes,
)
from acutance.targets import Record
from acutance.targets.check import VerdictWord
from acutance.targets.combine import combine
from acutance.targets.own_mtf import require_own_mtf

__all__ = ["Niirs", "niirs"]

_POSSIBLE = {
    "gsd_m": GSD_RANGE_M,
    "rer_across": (1e-3, 2.0),
    "rer_along": (1e-3, 2.0),
    "snr": (1e-3, 1e9),
    "giqe_h": (1e-3, 100.0),
    "noise_gain": (1e-3, 1e3),
    "elevation_deg": (5.0, 90.0),
}
"""What any image may have, also one that was sharpened; the equations have no meaning beyond."""
_STEP = 1e-4
_SAME = 1e-4
"""Share by which numbers that are stated differ by rounding alone."""


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
        What the checks of the measurement warn of, and where the equation was not made for such an
        image.
    verdict : {"good", "usable", "doubtful", "invalid"} or None
        Of the measurement, or of the combination; ``None`` of stated numbers.
    measured_gsd_m, measured_snr : float or None
        GSD and SNR of the measurement, where others were stated.
    measured_rer : (float, float) or None
        RER of the measurement across and along, where another was stated.

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
    verdict: VerdictWord | None = None
    measured_gsd_m: float | None = None
    measured_rer: tuple[float, float] | None = None
    measured_snr: float | None = None

    def __str__(self) -> str:
        plain = Estimate(self.value, self.std)
        noted = f", {'; '.join(note.name for note in self.notes)}" if self.notes else ""
        return f"{plain} (GIQE {self.version}{noted})"

    def to_dict(self) -> dict[str, Any]:
        """Value, deviations, interval, inputs, verdict and notes, for JSON."""
        own = self.inputs
        return {
            **super().to_dict(),
            "version": self.version,
            "inputs_std": self.inputs_std,
            "equation_std": self.equation_std,
            "inputs": None if own is None else dict(vars(own)),
            "measured_gsd_m": self.measured_gsd_m,
            "measured_rer": None if self.measured_rer is None else list(self.measured_rer),
            "measured_snr": self.measured_snr,
            "verdict": self.verdict,
            "notes": [{"name": one.name, "message": one.message} for one in self.notes],
        }


def niirs(
    measurement: Measured | Sequence[Measured] | None = None,
    *,
    gsd_m: float | tuple[float, float] | None = None,
    rer: float | Estimate | Sequence[float | Estimate] | None = None,
    snr: float | Estimate | None = None,
    elevation_deg: float = 90.0,
    version: GiqeVersion = 5,
    giqe_h: float | Estimate | None = None,
    noise_gain: float = 1.0,
    names: Sequence[str] | None = None,
) -> Niirs:
    """NIIRS by the General Image Quality Equation (GIQE).

    Parameters
    ----------
    measurement : Measurement, Record, dict, or a sequence of them, optional
        Gives RER, overshoot H, GSD and SNR, unless they are stated. Several are combined
        (`acutance.combine`), and their median SNR counts.
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
    names : sequence of str, optional
        What to call the measurements in notes: the names of their files.

    Returns
    -------
    Niirs
        An `Estimate` with notes.

    Raises
    ------
    OptionError
        If GSD, RER or SNR is missing or out of the range of any image, measurements do not belong
        together, or one is the ratio of two sensors' MTFs.
    """
    _require(version, elevation_deg, noise_gain)
    source = _Source() if measurement is None else _Source.of(measurement, names)
    known = _read_inputs(source.numbers, gsd_m, rer, snr, giqe_h)
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
            *source.warnings,
            *equation_notes(inputs, value, version, float(known["rer_std"])),
            *((ONE_DIRECTION,) if known.get("one_direction") else ()),
            *((NO_OVERSHOOT,) if version == 5 and giqe_h is not None else ()),
        ),
        verdict=source.verdict,
        measured_gsd_m=_other(source.numbers.get("gsd_m"), inputs.gsd_m),
        measured_rer=_other_rer(source.rer, (inputs.rer_across, inputs.rer_along)),
        measured_snr=_other(source.numbers.get("snr"), inputs.snr),
    )


@dataclass(frozen=True, eq=False)
class _Source:
    """What measurements give: numbers by name, the verdict, what it warns of."""

    numbers: Mapping[str, Any] = field(default_factory=dict)
    verdict: VerdictWord | None = None
    warnings: tuple[Note, ...] = ()

    @property
    def rer(self) -> tuple[float, float] | None:
        """RER across and along, if something was measured."""
        found = self.numbers
        return (float(found["rer_across"]), float(found["rer_along"])) if found else None

    @classmethod
    def of(cls, given: Measured | Sequence[Measured], names: Sequence[str] | None) -> _Source:
        """Of one measurement, or of several combined."""
        inputs = measured_inputs(given, names)
        records = named_records(inputs, names)
        for name, one in records.items():
            require_own_mtf(one, name)
        is_nameless = len(records) == 1 and names is None
        warnings = [
            Note(f"{one.verdict.word} measurement", words if is_nameless else f"{name}: {words}")
            for name, one in records.items()
            for words in warnings_of(one)
        ]
        if len(records) == 1:
            (record,) = records.values()
        else:
            both = combine(list(records.values()), names=list(records))
            record = both.record
            warnings += [Note("combination", words) for words in combination_warnings(both)]
        # Next to no noise has no SNR that could be told: its terms in the equation vanish.
        snr = median_snr(records.values())
        known = {} if snr is None else {"snr": min(snr, _POSSIBLE["snr"][1])}
        return cls(_of_record(record) | known, record.verdict.word, tuple(warnings))


def _other(measured: float | None, used: float) -> float | None:
    """A number of the measurement, if that used is another."""
    if measured is None or math.isclose(measured, used, rel_tol=_SAME):
        return None
    return measured


def _other_rer(
    measured: tuple[float, float] | None, used: tuple[float, float]
) -> tuple[float, float] | None:
    """Both RERs of the measurement, if one that is used is another."""
    if measured is None or all(_other(*pair) is None for pair in zip(measured, used, strict=True)):
        return None
    return measured


def _read_inputs(
    measured: Mapping[str, Any],
    gsd_m: float | tuple[float, float] | None,
    rer: float | Estimate | Sequence[float | Estimate] | None,
    snr: float | Estimate | None,
    giqe_h: float | Estimate | None,
) -> dict[str, Any]:
    """What the equations need, measured or as stated, by name.

    Raises
    ------
    OptionError
        If something is missing, or out of the range of any image.
    """
    found = dict(measured)
    if rer is not None:
        both = list(rer) if isinstance(rer, tuple | list) else [rer, rer]
        if len(both) != 2:
            raise OptionError(f"rer has {len(both)} values: give one, or those across and along")
        found |= {
            "rer_across": both[0],
            "rer_along": both[1],
            "correlated": len({*map(id, both)}) == 1,
            "one_direction": False,
        }
    if gsd_m is not None:
        sides = list(gsd_m) if isinstance(gsd_m, tuple | list) else [gsd_m, gsd_m]
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
    found: dict[str, Any] = {
        "rer_across": first.rer,
        "rer_along": last.rer,
        "giqe_h": Estimate(mean_h, max((one.std for one in heights), default=0.0)),
        "correlated": True,
        "one_direction": len(directions) == 1,
    }
    if pixel_m is not None:
        found["gsd_m"] = math.sqrt(pixel_m[0] * pixel_m[1])
    return found


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
    if not isinstance(version, Integral) or version not in (3, 4, 5):
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
    parts = [[std if k == i else 0.0 for k, std in enumerate(stds)] for i in range(len(stds))]
    if known.get("correlated"):
        parts[:2] = [[*stds[:2], 0.0, 0.0]]

    def of(changed: Sequence[float]) -> float:
        again = _inputs(changed, inputs.gsd_m, inputs.elevation_deg, inputs.noise_gain)
        return giqe(again, version)

    return math.hypot(*(_change(of, values, part, version) for part in parts))


def _change(
    function: Callable[[Sequence[float]], float], values: Sequence[float], stds: Sequence[float],
    version: GiqeVersion,
) -> float:  # fmt: skip
    """By how much NIIRS changes when inputs move together, each by its deviation: to first order.

    Version 5 has a kink where both RERs are equal, at which either side alone would count one of
    them too much: the mean of both sides is taken. Version 4 jumps, and the side without the jump
    has the slope.
    """
    largest = max(std / value for std, value in zip(stds, values, strict=True))
    if largest == 0.0:
        return 0.0
    step = _STEP / largest
    below, above = (
        (function([value + side * std for value, std in zip(values, stds, strict=True)])
         - function(values)) / side
        for side in (-step, step)
    )  # fmt: skip
    return 0.5 * (below + above) if version == 5 else min(below, above, key=abs)


def _std(value: float | Estimate) -> float:
    return value.std if isinstance(value, Estimate) and math.isfinite(value.std) else 0.0
