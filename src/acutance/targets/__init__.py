"""Targets: an image in, a `Measurement` out. One folder a kind of target.

What the kinds share stands here: `region` (the pixels a measurement starts from), `options` (what
callers choose), `check` and `check_table` (what is asked of a target), `slices` (an OTF along some
directions, with covariance), `measurement` and its light half, `record`, and `target_result`
(several measurements of one target). The kinds, which do not know one another:

- `straight`: edges and pulses, along their normals
- `points`: mirrors, lamps, stars of the sky
- `pair`: two images of different resolution
- `periodic`: groups of bars, Siemens stars
- `combine`: several measurements of one sensor
"""

from acutance.targets.check import Check, Verdict
from acutance.targets.check_table import QUESTIONS, Question
from acutance.targets.measurement import Measurement
from acutance.targets.record import ImageInfo, Record
from acutance.targets.slices import PlaneSlices
from acutance.targets.target_result import EdgeGroup, Rejected, TargetResult

__all__ = [
    "QUESTIONS",
    "Check",
    "EdgeGroup",
    "ImageInfo",
    "Measurement",
    "PlaneSlices",
    "Question",
    "Record",
    "Rejected",
    "TargetResult",
    "Verdict",
]
