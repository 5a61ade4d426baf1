"""
A landscape and its edges
=========================

Fields, roofs and roads beside one another, with the truth of every edge: where it is, and what lies
beside it. Here the edges are measured in regions of one width, whatever they hold.
"""

# sphinx_gallery_thumbnail_path = "generated/thumbnail-plot_a_landscape.png"

import numpy as np
from matplotlib.figure import Figure

import acutance as ac
from acutance.raster import Region

# %%
# A landscape of default shares: two fifths of the borders are clean.
sensor = ac.simulate.reference_systems()["gaussian"]
options = ac.simulate.LandscapeOptions(soft=0.0, curved=0.0)
image, truth = ac.simulate.landscape(
    sensor, shape=(700, 700), options=options, snr=150, rng=np.random.default_rng(1)
)
print(f"{len(truth.edges)} edges of {len(truth.parcels)} parcels")

# %%
# Measured within 15 px on either side; the truth names what lies there.
errors: dict[str, list[float]] = {}
for edge in truth.edges:
    if edge.contrast < 250:
        continue
    try:
        found = ac.measure_edge(image, roi=Region(edge.region(15.0)))
    except ac.AcutanceError:
        continue
    error = found.mtf_nyquist.value - edge.mtf_nyquist.value
    errors.setdefault(edge.kind(15.0), []).append(error)
for kind, of_kind in sorted(errors.items()):
    print(f"{kind:10} {len(of_kind):3} edges, median error {np.median(np.abs(of_kind)):.4f}")

# %%
# The image with its clean edges, and the errors by what lies beside.
figure = Figure(figsize=(10, 4.6), layout="constrained")
scene, scatter = figure.subplots(1, 2)
scene.imshow(image, cmap="gray")
for edge in truth.edges:
    if edge.kind(15.0) == "clean":
        corners = edge.region(15.0)
        scene.fill(corners[:, 1], corners[:, 0], fill=False, edgecolor="tab:green", linewidth=1)
scene.set(xlabel="column", ylabel="row", title="clean edges")
for place, (_, of_kind) in enumerate(sorted(errors.items())):
    scatter.plot(of_kind, np.full(len(of_kind), place), "o", alpha=0.6)
scatter.set(
    yticks=range(len(errors)),
    yticklabels=sorted(errors),
    xlabel="error of the MTF at Nyquist",
    xlim=(-0.2, 0.2),
)
scatter.axvline(0.0, color="0.6", linewidth=1)

# %%
# The figure as a file.
figure.savefig("landscape.png", dpi=110)
print("wrote landscape.png")
