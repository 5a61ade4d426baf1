"""
Compare methods with the truth
==============================

The published methods have biases of their own. On a simulated edge they show, because the truth is
known; on a real one, the methods can only be compared with each other.
"""

# sphinx_gallery_thumbnail_path = "generated/thumbnail-plot_2_compare_methods.png"

import numpy as np

import acutance as ac
from acutance import report
from acutance.targets.straight import METHODS
from acutance.targets.straight.published import SdsuOptions

# %%
# A sensor with a tenth of its light in a halo: wide wings that short windows cut.
sensor = ac.simulate.reference_systems()["halo"]
image, truth = ac.simulate.edge(
    sensor, angle_deg=8, shape=(60, 60), snr=150, rng=np.random.default_rng(5)
)
measurements = [ac.measure_edge(image, method=method) for method in METHODS]
print(report.text(measurements))

# %%
# Differences are taken to the truth here. Standard deviations of the published methods are scatter
# only: their biases are not in it.
figure = report.draw(report.compare(measurements, truth=truth.response))

# %%
# What a paper leaves open is an option of its method.
for distance in ("row", "normal"):
    options = ac.EdgeOptions(method_options=SdsuOptions(distance=distance))
    found = ac.measure_edge(image, method="sdsu-2005", options=options)
    print(f"sdsu-2005, {distance:6} distance: {found.mtf_nyquist}")
print(f"truth:                      {truth.mtf_nyquist}")

# %%
# The figure as a file.
figure.savefig("methods.png", dpi=110)
print("wrote methods.png")
