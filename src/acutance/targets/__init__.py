"""Targets: an image in, a `Measurement` out. One folder a kind of target.

What the kinds share stands here: `kinds` (their names and methods), `region` (the pixels of a
measurement), `options` (what callers choose), `check` and `check_table` (is the target good
enough), `processing_traces` (what processing left in its pixels, and `processing_checks` of it),
`slices` (an OTF along some directions, with covariance), `measurement` and its light half, `record`
(a direction of it: `recorded_direction`), `directions` (what these two have in common),
`uncertainty_budget` (what their deviations consist of), `target_result` (several measurements of
one target), and `conformity` (whether they meet a requirement). The kinds, none of which imports
another:

- `straight`: edges and pulses, along their normals
- `points`: mirrors, lamps, stars of the sky
- `pair`: two images of different resolution
- `periodic`: groups of bars, Siemens stars
- `combine`: several measurements of one sensor
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.names_on_use import names_on_use
from acutance.targets.kinds import KINDS, Kind

if TYPE_CHECKING:
    from acutance.targets.check import Check, Verdict
    from acutance.targets.check_table import QUESTIONS
    from acutance.targets.conformity import Conformity, ToleranceLimit
    from acutance.targets.measurement import Measurement
    from acutance.targets.question import Question
    from acutance.targets.record import ImageInfo, Record
    from acutance.targets.slices import OtfSlices
    from acutance.targets.target_result import EdgeGroup, Rejected, TargetResult
    from acutance.targets.uncertainty_budget import BudgetTerm

__all__ = [
    "KINDS",
    "QUESTIONS",
    "BudgetTerm",
    "Check",
    "Conformity",
    "EdgeGroup",
    "ImageInfo",
    "Kind",
    "Measurement",
    "OtfSlices",
    "Question",
    "Record",
    "Rejected",
    "TargetResult",
    "ToleranceLimit",
    "Verdict",
]

# The modules are loaded when a name is first used: the names of the kinds cost no numpy.
_HOMES = {
    "QUESTIONS": "check_table",
    "BudgetTerm": "uncertainty_budget",
    "Check": "check",
    "Conformity": "conformity",
    "EdgeGroup": "target_result",
    "ImageInfo": "record",
    "Measurement": "measurement",
    "OtfSlices": "slices",
    "Question": "question",
    "Record": "record",
    "Rejected": "target_result",
    "TargetResult": "target_result",
    "ToleranceLimit": "conformity",
    "Verdict": "check",
}

__getattr__ = names_on_use(__name__, _HOMES)
