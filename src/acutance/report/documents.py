"""Measurements as JSON documents, and the schema they keep to."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import fields
from importlib.resources import files
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from acutance.optics import Sensor
    from acutance.simulate import PulseTruth, Truth
    from acutance.targets.measurement import Measurement
    from acutance.targets.straight import TargetResult

__all__ = [
    "comparison_document",
    "json_text",
    "measurement_document",
    "measurement_schema",
    "target_document",
    "truth_document",
]


def measurement_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of the document ``acutance/measurement/1``."""
    source = files("acutance.report") / "schemas" / "measurement-1.json"
    schema: dict[str, Any] = json.loads(source.read_text(encoding="utf-8"))
    return schema


def measurement_document(measurement: Measurement, *, covariance: bool = False) -> dict[str, Any]:
    """The document ``acutance/measurement/1``, with the covariance factors when asked.

    The factors are lists of n rows and k columns. The columns of ``factor`` of the ESF and the
    LSF, and of ``factor_real`` and ``factor_imag`` of the MTF, belong to the same k standard
    normal variables, so any combination of the curves has a standard deviation.
    """
    document = measurement.to_dict()
    if covariance:
        transfer = measurement.mtf.otf_factor
        document["mtf"] |= {
            "factor_real": transfer.real.tolist(),
            "factor_imag": transfer.imag.tolist(),
        }
        document["lsf"] |= {"factor": measurement.lsf.covariance_factor.tolist()}
        document["esf"] |= {"factor": measurement.esf.covariance_factor.tolist()}
    return document


def comparison_document(
    measurements: Sequence[Measurement], *, covariance: bool = False
) -> dict[str, Any]:
    """The document ``acutance/comparison/1``: one target measured in several ways."""
    return {
        "schema": "acutance/comparison/1",
        "measurements": [measurement_document(one, covariance=covariance) for one in measurements],
    }


def target_document(result: TargetResult, *, covariance: bool = False) -> dict[str, Any]:
    """The document ``acutance/target/1``: every edge, the means by direction, what was rejected.

    The edges of a group are counted from 0, in the order of "measurements".
    """
    place = {id(one): i for i, one in enumerate(result.measurements)}
    return {
        "schema": "acutance/target/1",
        "measurements": [
            measurement_document(one, covariance=covariance) for one in result.measurements
        ],
        "groups": {
            orientation: {
                "edges": [place[id(one)] for one in group.measurements],
                "metrics": {name: mean.to_dict() for name, mean in group.metrics.items()},
                "chi_square": dict(group.chi_square),
                "degrees_of_freedom": group.degrees_of_freedom,
                "p_value": dict(group.p_value),
            }
            for orientation, group in result.groups.items()
        },
        "rejected": [
            {"stage": one.stage, "reason": one.reason, "values": dict(one.values)}
            for one in result.rejected
        ],
    }


def truth_document(truth: Truth | PulseTruth, sensor: Sensor) -> dict[str, Any]:
    """The document ``acutance/truth/1``: what a perfect measurement of a simulation returns.

    Numbers and curves stand under the names they have in a measurement; the line of a pulse is its
    middle.
    """
    numbers = {name: number.value for name, number in truth.response.metrics().items()}
    return {
        "schema": "acutance/truth/1",
        "orientation": truth.orientation,
        "sensor": {
            "gsd_m": sensor.gsd_m,
            "blocks": [{"block": type(one).__name__, **_fields(one)} for one in sensor.blocks],
        },
        "line": truth.line.to_dict(),
        "angle_deg": truth.line.angle_deg,
        **_levels(truth),
        "noise": None if truth.noise is None else _fields(truth.noise),
        **numbers,
        "mtf": _without_std(truth.mtf.to_dict()),
        "lsf": _without_std(truth.lsf.to_dict()),
        "esf": _without_std(truth.esf.to_dict()),
    }


def _levels(truth: Truth | PulseTruth) -> dict[str, float | None]:
    """Levels of a target, and the width of a pulse."""
    from acutance.simulate import Truth

    if isinstance(truth, Truth):
        return {"dark": truth.dark, "bright": truth.bright}
    return {
        "dark": truth.left,
        "bright": truth.level,
        "dark_behind": truth.right,
        "width_px": truth.width_px,
        "width_m": truth.width_m,
        "prf_fwhm_px": truth.prf_fwhm_px,
    }


def _fields(described: Any) -> dict[str, Any]:
    return {one.name: getattr(described, one.name) for one in fields(described)}


def _without_std(curve: dict[str, list[float]]) -> dict[str, list[float]]:
    return {name: values for name, values in curve.items() if name != "std"}


def json_text(document: Mapping[str, Any]) -> str:
    """Strict JSON, indented by one: what is not a finite number becomes null.

    Lists of numbers stay on one line each, so that a reader can scroll.
    """
    return _render(_finite(document), 0)


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _render(value: Any, depth: int) -> str:
    nested = isinstance(value, list) and any(isinstance(item, dict | list) for item in value)
    if not value or not (isinstance(value, dict) or nested):
        return json.dumps(value, ensure_ascii=False, allow_nan=False)
    inner, outer = " " * (depth + 1), " " * depth
    if isinstance(value, dict):
        items = [
            f"{json.dumps(key, ensure_ascii=False)}: {_render(item, depth + 1)}"
            for key, item in value.items()
        ]
        opening, closing = "{", "}"
    else:
        items = [_render(item, depth + 1) for item in value]
        opening, closing = "[", "]"
    body = f",\n{inner}".join(items)
    return f"{opening}\n{inner}{body}\n{outer}{closing}"
