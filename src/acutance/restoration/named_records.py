"""Measurements that describe one sensor, by name, and what their failed checks warn of."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import PurePath
from statistics import median
from typing import Any

from acutance.errors import OptionError
from acutance.targets import Measurement, Record, TargetResult
from acutance.targets.combine import CombinedMeasurement
from acutance.targets.combine.inputs import records_of

__all__ = [
    "Measured",
    "combination_warnings",
    "measured_inputs",
    "median_snr",
    "named_records",
    "warnings_of",
]

Measured = Measurement | Record | TargetResult[Measurement] | Mapping[str, Any]
"""A measurement, its record, or its JSON document."""


def measured_inputs(
    given: Measured | Sequence[Measured], names: Sequence[str] | None, *, also: str = ""
) -> list[Measured]:
    """One measurement or several as a list, of the length of their names.

    Parameters
    ----------
    given : Measurement, Record, TargetResult, dict, or a sequence of them
    names : sequence of str or None
    also : str, optional
        What else the caller takes, for the message.

    Raises
    ------
    OptionError
        If one of them is no measurement, or names are missing.
    """
    inputs: list[Any] = [given]
    if isinstance(given, Sequence) and not isinstance(given, str | bytes):
        inputs = list(given)
    for one in inputs:
        if not isinstance(one, Measurement | Record | TargetResult | Mapping):
            raise OptionError(
                f"a {type(one).__name__} describes no sensor: give a measurement, its record or "
                f"JSON document, several of them{also}"
            )
    if names is not None and len(names) != len(inputs):
        raise OptionError(
            f"{len(names)} names were given for {len(inputs)} measurements: give one for each"
        )
    return inputs


def named_records(inputs: Sequence[Measured], names: Sequence[str] | None) -> dict[str, Record]:
    """Every single measurement, by the name of its file and region, or by its number and kind.

    Parameters
    ----------
    inputs : sequence of Measurement, Record, TargetResult or dict
        A document may hold several measurements.
    names : sequence of str or None
        Of their files.
    """
    found: dict[str, Record] = {}
    for number, one in enumerate(inputs, start=1):
        origin = f"measurement {number}" if names is None else PurePath(names[number - 1]).name
        own = records_of(one, origin)
        for place, record in enumerate(own, start=1):
            name = origin if names is not None else f"{origin} ({record.kind})"
            if len(own) > 1:
                name = f"{name}, {record.document.get('region') or place}"
            found[f"{name} ({number})" if name in found else name] = record
    return found


def median_snr(records: Iterable[Record]) -> float | None:
    """The median of those SNRs that are known: one without noise, or of a combination, has none."""
    known = [one.snr for one in records if math.isfinite(one.snr)]
    return median(known) if known else None


def warnings_of(record: Record) -> tuple[str, ...]:
    """What failed checks warn of: the verdict's sentence, of a combination each of them."""
    failed = record.failed_checks
    if record.kind == "combined" or not failed:
        return tuple(check.message for check in failed)
    sentence = record.verdict.sentence
    others = [check.name for check in failed if check.message != sentence]
    return (sentence + (f" (failed too: {', '.join(others)})" if others else ""),)


def combination_warnings(combined: CombinedMeasurement) -> tuple[str, ...]:
    """What a combination's own checks warn of: inputs that failed one have their own warnings."""
    return tuple(one.message for one in combined.failed_checks if one.name != "failed_inputs")
