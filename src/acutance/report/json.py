"""Results as JSON documents, and the schema of a measurement."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from acutance.arguments import require_flags
from acutance.report.check_words import common_verdict
from acutance.report.comparison import Comparison, Result, as_result
from acutance.report.requirements import Required, with_requirements
from acutance.targets import Rejected, TargetResult
from acutance.targets.json_text import json_text

if TYPE_CHECKING:
    from acutance.curves import Response
    from acutance.curves.grid import Floats
    from acutance.targets.measurement import Measurement

__all__ = ["document", "json_text", "measurement_schema"]

WRITTEN_TO = 1e-5
"""Places of curves are written with so much rounding at most."""


def measurement_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of the document ``acutance/measurement/1``."""
    source = files("acutance.report") / "schemas" / "measurement-1.json"
    schema: dict[str, Any] = json.loads(source.read_text(encoding="utf-8"))
    return schema


def document(
    result: Result, covariance: bool = False, *, required: Required = ()
) -> dict[str, Any]:
    """Any result as a JSON document.

    A measurement is ``acutance/measurement/1``; several of one target are
    ``acutance/comparison/1``; all edges of a target are ``acutance/target/1``, where those of a
    group are counted from 0 in the order of "measurements".

    Parameters
    ----------
    result : Measurement, TargetResult, Comparison or sequence of Measurement
    covariance : bool, optional
        Add covariance factors to the curves: lists of n rows and k columns. The columns of
        ``factor`` of the ESF and the LSF, and of ``factor_real`` and ``factor_imag`` of the MTF,
        of both directions belong to the same k standard normal variables, so that any combination
        of the curves has a standard deviation.
    required : sequence of ToleranceLimit or str, optional
        Requirements to be answered in "requirements": "mtf_nyquist >= 0.09".
    """
    require_flags(covariance=covariance)
    found = as_result(result)
    if isinstance(found, TargetResult):
        own = _target_document(found, covariance)
    elif isinstance(found, Comparison):
        own = _comparison_document(found, covariance)
    else:
        own = _measurement_document(found, covariance)
    return with_requirements(own, found, required)


def _comparison_document(comparison: Comparison, covariance: bool) -> dict[str, Any]:
    return {
        "schema": "acutance/comparison/1",
        "measurements": [_measurement_document(one, covariance) for one in comparison.measurements],
        "rejected": _rejected_documents(comparison.rejected),
    }


def _measurement_document(measurement: Measurement, covariance: bool) -> dict[str, Any]:
    content = measurement.to_dict()
    if not covariance:
        return content
    if "orientation" in content:
        return _with_factors(content, measurement.response)
    return content | {
        name: _with_factors(content[name], response)
        for name, response in measurement.directions.items()
    }


def _with_factors(content: Mapping[str, Any], response: Response) -> dict[str, Any]:
    """A direction's part of a document with the covariance factors of its curves."""
    mtf, lsf, esf = (content[name] for name in ("mtf", "lsf", "esf"))
    transfer = response.mtf.otf_factor[_places(response.mtf.freq_cpp, mtf["freq_cpp"])]
    rows = _places(response.lsf.distance_px, lsf["distance_px"])
    return {
        **content,
        "mtf": mtf | {"factor_real": transfer.real.tolist(), "factor_imag": transfer.imag.tolist()},
        "lsf": lsf | {"factor": response.lsf.covariance_factor[rows].tolist()},
        "esf": esf | {"factor": response.esf.covariance_factor[rows].tolist()},
    }


def _places(grid: Floats, written: Sequence[float]) -> NDArray[np.intp]:
    """Where a curve's grid has the places that a document holds, which may be fewer."""
    return np.searchsorted(grid, np.asarray(written) - WRITTEN_TO)


def _target_document(result: TargetResult[Any], covariance: bool) -> dict[str, Any]:
    place = {id(one): i for i, one in enumerate(result.measurements)}
    return {
        "schema": "acutance/target/1",
        "verdict": common_verdict(result.measurements).to_dict(),
        "measurements": [_measurement_document(one, covariance) for one in result.measurements],
        "groups": {
            orientation: {
                "edges": [place[id(one)] for one in group.measurements],
                "metrics": {name: mean.to_dict() for name, mean in group.metrics.items()},
                "chi_square": dict(group.chi_square),
                "degrees_of_freedom": group.degrees_of_freedom,
                "p_value": dict(group.p_value),
                "left_out": [place[id(one)] for one in group.left_out],
            }
            for orientation, group in result.groups.items()
        },
        "rejected": _rejected_documents(result.rejected),
    }


def _rejected_documents(rejected: Sequence[Rejected]) -> list[dict[str, Any]]:
    return [
        {"stage": one.stage, "reason": one.reason, "values": dict(one.values)} for one in rejected
    ]
