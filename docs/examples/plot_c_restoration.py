"""
Sharpening an image from its own edges
======================================

Two edges tell how a sensor blurs across and along. A kernel made from them sharpens the image; what
it will do, and what it costs, is known before it is applied.
"""

# sphinx_gallery_thumbnail_path = "generated/thumbnail-plot_c_restoration.png"

import numpy as np
from matplotlib.figure import Figure

import acutance as ac

# %%
# A sensor that smears along track, its edges, and a landscape it took.
sensor = ac.Sensor(
    [ac.optics.Gaussian(0.5), ac.optics.Detector(), ac.optics.Smear(1.0, "along")], gsd_m=0.7
)
rng = np.random.default_rng(3)
edges = [
    ac.measure_edge(
        ac.simulate.edge(
            sensor, shape=(90, 90), angle_deg=6, snr=100, orientation=direction, rng=rng
        )[0]
    )
    for direction in ("across", "along")
]
image, _ = ac.simulate.landscape(sensor, shape=(300, 300), snr=100, rng=rng)

# %%
# One number is asked for, here the noise gain. All others follow, with their deviations.
filter = ac.design_restoration(edges, noise_gain=1.8)
for name in ("across", "along"):
    before, after = filter.before.directions[name], filter.after.directions[name]
    print(f"MTF at Nyquist {name}: {before.mtf_nyquist} -> {after.mtf_nyquist}")
print(f"overshoot {filter.after.overshoot}, SNR {filter.snr:.0f} -> {filter.snr_after:.0f}")
print(f"change of NIIRS (GIQE 4): {filter.niirs_change[4]}")

# %%
# The image before and after, in the same greys.
sharp = ac.restore(image, filter)
figure = Figure(figsize=(10.5, 5.2), layout="constrained")
low, high = np.percentile(image, (0.5, 99.5))
for axes, pixels, title in zip(
    figure.subplots(1, 2), (image, sharp), ("as taken", "restored"), strict=True
):
    axes.imshow(pixels[60:200, 60:200], cmap="gray", vmin=low, vmax=high)
    axes.set(title=title)
    axes.set_axis_off()

# %%
# The proof: an edge that was not used, before and after.
pixels, _ = ac.simulate.edge(sensor, shape=(130, 130), angle_deg=8, snr=100, rng=rng)
proof = ac.verify_restoration(
    ac.Image.from_array(pixels),
    ac.Image.from_array(ac.restore(pixels, filter)),
    filter,
    [(15, 15, 100, 100)],
)
for edge in proof.edges:
    print(f"MTF at Nyquist: before {edge.before}, predicted {edge.predicted}, found {edge.after}")

# %%
# The figure as a file.
figure.savefig("restoration.png", dpi=110)
print("wrote restoration.png")
