"""Targets: an image in, a `Measurement` out. One folder a kind of target.

What the kinds share stands here: `region` (the pixels a measurement starts from), `arguments` and
`option_types` (what callers hand in), `slices` (an OTF along some directions, with covariance) and
`measurement` (what comes out). The kinds, which do not know one another:

- `straight`: edges and pulses, along their normals
- `points`: mirrors, lamps, stars of the sky
- `pair`: two images of different resolution
- `periodic`: groups of bars, Siemens stars
- `combine`: several measurements of one sensor
"""

from acutance.targets.measurement import Check, ImageInfo, Measurement, Samples
from acutance.targets.measurement2d import Measurement2d
from acutance.targets.slices import PlaneSlices

__all__ = ["Check", "ImageInfo", "Measurement", "Measurement2d", "PlaneSlices", "Samples"]
