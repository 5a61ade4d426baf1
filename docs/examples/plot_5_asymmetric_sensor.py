"""
The phase of an asymmetric sensor
=================================

A charge trail blurs to one side. The MTF does not show it; the phase of the OTF and the LSF do.
"""

# sphinx_gallery_thumbnail_path = "generated/thumbnail-plot_5_asymmetric_sensor.png"

import numpy as np
from matplotlib.figure import Figure

import acutance as ac

# %%
# The truth is complex, and so is the measurement. The phase is relative to the LSF's centroid.
sensor = ac.Sensor([ac.optics.Gaussian(0.35), ac.optics.Detector(), ac.optics.Exponential(0.6)])
rng = np.random.default_rng(3)
results = {}
for polarity in ("rising", "falling"):
    image, truth = ac.simulate.edge(
        sensor, angle_deg=5, polarity=polarity, shape=(60, 40), snr=120, rng=rng
    )
    results[polarity] = ac.measure_edge(image), truth

# %%
# The normal points from dark to bright, so an edge of the other polarity sees the trail on the
# other side: the MTF is the same, the phase changes its sign.
figure = Figure(figsize=(10.5, 4.4), layout="constrained")
left, right = figure.subplots(1, 2)
for i, (polarity, (found, truth)) in enumerate(results.items()):
    near = np.abs(found.lsf.distance_px) < 5
    left.plot(found.lsf.distance_px[near], found.lsf.value[near], color=f"C{i}", label=polarity)
    inside = found.mtf.freq_cpp <= 0.6
    right.plot(found.mtf.freq_cpp[inside], found.mtf.phase_rad[inside], color=f"C{i}")
    right.plot(truth.mtf.freq_cpp[inside], truth.mtf.phase_rad[inside], "k--", lw=1)
    print(f"{polarity:8} MTF at Nyquist {found.mtf_nyquist}, truth {truth.mtf_nyquist}")
left.set(title="LSF", xlabel="normal distance, px", ylabel="1/px")
left.legend()
right.set(title="Phase (dashed: truth)", xlabel="frequency, cycles per pixel", ylabel="radians")

# %%
# A half extent belongs to one side as well.
for polarity, (found, _) in results.items():
    dark, bright = found.response.half_extent_dark_px, found.response.half_extent_bright_px
    print(f"{polarity:8} 5-50 %: {dark} px, 50-95 %: {bright} px")

# %%
# The figure as a file.
figure.savefig("asymmetric-sensor.png", dpi=110)
print("wrote asymmetric-sensor.png")
