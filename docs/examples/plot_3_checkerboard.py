"""
All edges of a checkerboard
===========================

A two by two checkerboard has four inner edges, two in each direction. They are found, measured and
averaged by direction, with a test whether they agree.
"""

# sphinx_gallery_thumbnail_path = "generated/thumbnail-plot_3_checkerboard.png"

import numpy as np

import acutance as ac
from acutance import report

# %%
# A site on grass, next to a road.
sensor = ac.Sensor([ac.optics.Gaussian(0.45), ac.optics.Detector(), ac.optics.Smear(0.5, "along")])
scene = ac.simulate.site(sensor, np.random.default_rng(9))
result = ac.measure_edges(scene.image)
print(report.text(result))

# %%
# Where they are, and the mean of each direction.
figure = report.draw(result, backdrop=scene.image)

# %%
# The motion blurs along the rows' axis only: the two directions differ, as they should.
for orientation, group in result.groups.items():
    truth = next(e.truth for e in scene.edges if e.truth.orientation == orientation)
    number = group.metrics["mtf_nyquist"]
    print(
        f"{orientation:6} {len(group.measurements)} edges: {number}, truth {truth.mtf_nyquist},"
        f" chance of a larger chi-square {group.p_value['mtf_nyquist']:.2f}"
    )

# %%
# The figure as a file.
figure.savefig("checkerboard.png", dpi=110)
print("wrote checkerboard.png")
