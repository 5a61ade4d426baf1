"""
A scene with soft borders
=========================

No target is known, and half of the borders are soft on the ground. The median of the edges takes
their softness for the sensor's; a scan estimates both together.
"""

# sphinx_gallery_thumbnail_path = "generated/thumbnail-plot_b_scene.png"

import numpy as np
from matplotlib.figure import Figure

import acutance as ac

# %%
# Fields without roads and neighbours. Half of their borders are blurred by Gaussians of 0.15 to
# 1.5 px.
sensor = ac.simulate.reference_systems()["gaussian"]
options = ac.simulate.LandscapeOptions(
    density_per_mpx=60,
    soft=0.5,
    softness_px=(0.15, 1.5),
    roofs=0.0,
    roads=0.0,
    side_roads=0.0,
    neighbours=0.0,
)
image, truth = ac.simulate.landscape(
    sensor, shape=(900, 900), options=options, snr=100, rng=np.random.default_rng(2)
)
soft = np.mean([edge.softness_px > 0 for edge in truth.edges])
print(f"{len(truth.edges)} edges, {100 * soft:.0f} % of them soft")

# %%
# Every edge is found and measured; good and usable ones are used.
scene = ac.scan_scene(image)
edges = scene.edges
print(f"{edges.size} edges found, {edges.used.sum()} used; verdict: {scene.verdict.word}")
print(f"ideal objects: {scene.objects['ideal']}")

# %%
# The median of the edges within 45 degrees of either direction, the scan, and the truth.
nearer_across = np.abs(np.cos(np.radians(edges.normal_deg))) > np.sqrt(0.5)
for name, own in (("across", nearer_across), ("along", ~nearer_across)):
    median = np.median(edges.mtf_nyquist[edges.used & own])
    scanned = scene.directions[name].mtf_nyquist
    true = sensor.response(0.0, name).mtf_nyquist
    print(f"MTF at Nyquist {name}: median {median:.4f}, scan {scanned}, truth {true}")

# %%
# The used edges, sharp ones bright; and how sharp each is beside the three answers.
median = np.median(edges.mtf_nyquist[edges.used])
scanned, true = scene.across.mtf_nyquist, sensor.response().mtf_nyquist.value
figure = Figure(figsize=(10.5, 4.6), layout="constrained")
ground, histogram = figure.subplots(1, 2)
ground.imshow(image, cmap="gray")
marks = ground.scatter(
    edges.col[edges.used],
    edges.row[edges.used],
    c=edges.mtf_nyquist[edges.used],
    s=18,
    cmap="plasma",
)
figure.colorbar(marks, ax=ground, label="MTF at Nyquist of the edge", shrink=0.8)
ground.set(xlabel="column", ylabel="row", title="Used edges")
bins = np.linspace(0.0, 0.4, 41)
histogram.hist(edges.mtf_nyquist[edges.used], bins, color="0.85", edgecolor="0.6")
low, high = scanned.interval(0.95)
histogram.axvspan(low, high, color="tab:blue", alpha=0.25)
histogram.axvline(scanned.value, color="tab:blue", label=f"scan {scanned}")
histogram.axvline(median, color="tab:orange", label=f"median {median:.4f}")
histogram.axvline(true, color="k", linestyle="--", label=f"truth {true:.4f}")
histogram.set(xlabel="MTF at Nyquist", ylabel="edges", title="How sharp the edges are")
histogram.legend(loc="upper left", bbox_to_anchor=(0.08, 1.0))

# %%
# The figure as a file.
figure.savefig("scene.png", dpi=110)
print("wrote scene.png")
