"""
Measure a simulated edge
========================

Simulate a sensor and a target, measure the edge, and look at every step.
"""

# sphinx_gallery_thumbnail_path = "generated/thumbnail-plot_1_measure_edge.png"

import numpy as np

import acutance as ac
from acutance import report

# %%
# A sensor is a product of OTF blocks: here optics, detector, motion and electronics.
sensor = ac.Sensor(
    [
        ac.optics.Gaussian(0.39),
        ac.optics.Detector(1.0),
        ac.optics.Smear(0.25, "along"),
        ac.optics.Butterworth(1.4),
    ],
    gsd_m=1.0,
)
image, truth = ac.simulate.edge(
    sensor, angle_deg=6, shape=(60, 40), snr=100, rng=np.random.default_rng(2)
)

# %%
# The measurement, as text. The GSD is only needed for what is reported in metres.
measurement = ac.measure_edge(image, gsd_m=1.0)
print(report.text(measurement))

# %%
# Every number and its true value.
for name, estimate in measurement.metrics().items():
    true = getattr(truth.response, name)
    print(f"{name:22}{estimate:>20}   truth {true.value:.4f}")

# %%
# The same steps as a figure, and the curves as arrays.
figure = report.draw(measurement)
print(measurement.mtf.freq_cpp[::25], measurement.mtf.value[::25].round(4))

# %%
# The figure as a file.
figure.savefig("measured-edge.png", dpi=110)
print("wrote measured-edge.png")
