"""Several measurements of one sensor as one two-dimensional optical transfer function (OTF).

In the order data take: `inputs` (records of measurements), `pixel_size` (do they have the same
pixels), `curves` (the OTF of each), `sensor_forms` (products of OTF blocks: `sensor_terms`,
`aberration_term` of the `pupil_means` over what `pupil_overlap` describes, `processing_terms`,
`resampling_term`, `detector_terms`; worked out side by side by `form_products`), `correction`
(smooth corrections of them), `lit_curves` (all curves about one OTF), `form_fit` (where forms fit
best), `fit` (all forms, weighted), `shared_pixels` (which inputs used the same), `checks`,
`combination` (the public function).
"""

from acutance.targets.combine.combination import combine
from acutance.targets.combine.combined_measurement import CombinedMeasurement, CombinedPart
from acutance.targets.combine.options import CombineOptions

__all__ = [
    "CombineOptions",
    "CombinedMeasurement",
    "CombinedPart",
    "combine",
]
