"""From a measured MTF to a sharper image, and what it costs.

A filter, from what is known of a sensor to what its kernel does, in this order:

- `named_records.py` measurements and documents by name, and what their failed checks warn of
- `known_otf.py` the OTF over the plane, of measurements, documents or a described sensor;
  `sliced_otf.py` the plane of a document, through the slices it holds
- `scene_spectrum.py`, `measured_scene.py` the power of the scene: natural, stated, or of an image
- `kernel_family.py` kernels of least expected error, one for each weight of the noise
- `knobs.py` noise gain, MTF at Nyquist or overshoot choose among them; `trade.py` all others
- `filtered_otf.py` the sensor with the kernel behind it, covariance included; `aliasing.py`
- `giqe.py`, `interpretability.py`, `niirs_notes.py`, `niirs_change.py` the General Image Quality
  Equation
- `design.py` puts it together; `restoration_filter.py` is the result and its document

An image, filtered:

- `filling.py` what stands in the place of pixels without data
- `window_filter.py` one window; `applying.py` an array or a file (windows and files: ``raster/``)
- `filter_match.py` whether a filter is of such pixels and bands
- `proof.py` edges before and after, beside the prediction
- `verification.py` how they are measured
"""

from acutance.restoration.applying import RestoredImage, restore, restore_array
from acutance.restoration.design import design_restoration
from acutance.restoration.interpretability import Niirs, niirs
from acutance.restoration.proof import RestorationProof
from acutance.restoration.restoration_filter import RestorationFilter
from acutance.restoration.scene_spectrum import NaturalScene
from acutance.restoration.verification import verify_restoration
from acutance.restoration.window_filter import PixelCounts

__all__ = [
    "NaturalScene",
    "Niirs",
    "PixelCounts",
    "RestorationFilter",
    "RestorationProof",
    "RestoredImage",
    "design_restoration",
    "niirs",
    "restore",
    "restore_array",
    "verify_restoration",
]
