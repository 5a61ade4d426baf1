"""
How many rows do I need?
========================

The standard deviation of the MTF at Nyquist against the length of the edge and its SNR, as the
method predicts it and as the scatter of repetitions shows it.
"""

# sphinx_gallery_thumbnail_path = "generated/thumbnail-plot_4_how_many_rows.png"

import numpy as np
from matplotlib.figure import Figure

import acutance as ac

sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
rng = np.random.default_rng(11)
rows = np.array([20, 40, 80])
draws = 24

# %%
# A few draws for every size are enough to see the law; the benchmarks have thousands.
found = {}
for snr in (50, 100, 200):
    for count in rows:
        values = []
        for _ in range(draws):
            image, truth = ac.simulate.edge(
                sensor, angle_deg=7, shape=(count, 36), offset_px=rng.uniform(-0.5, 0.5),
                snr=snr, rng=rng,
            )  # fmt: skip
            values.append(ac.measure_edge(image).mtf_nyquist)
        found[snr, count] = values

# %%
# Lines: the stated deviations. Marks: root mean square of the errors. Both fall with the root of
# the rows and with the SNR.
figure = Figure(figsize=(7.5, 4.8), layout="constrained")
axes = figure.subplots()
for i, snr in enumerate((50, 100, 200)):
    stated = [np.mean([one.std for one in found[snr, count]]) for count in rows]
    errors = [[one.value - truth.mtf_nyquist.value for one in found[snr, count]] for count in rows]
    axes.loglog(rows, stated, color=f"C{i}", label=f"SNR {snr}")
    axes.loglog(rows, np.sqrt(np.mean(np.square(errors), axis=1)), "o", color=f"C{i}")
axes.set_xticks(rows, [str(count) for count in rows])
axes.set_yticks([0.002, 0.005, 0.01, 0.02], ["0.002", "0.005", "0.01", "0.02"])
axes.set(xlabel="rows of the edge", ylabel="standard deviation of the MTF at Nyquist")
axes.minorticks_off()
axes.grid(True, alpha=0.4)
axes.legend()

# %%
# The figure as a file.
figure.savefig("rows.png", dpi=110)
print("wrote rows.png")
