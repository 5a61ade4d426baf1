"""
Twenty mirrors and their PSF
============================

Mirrors in two slanted columns sample the PSF at every fifth of a pixel. What is no mirror is named.
"""

# sphinx_gallery_thumbnail_path = "generated/thumbnail-plot_7_mirrors.png"

import numpy as np
from matplotlib.figure import Figure

import acutance as ac

# %%
# A sensor that moves during the exposure blurs along the columns; one pixel of its detector is hot.
sensor = ac.Sensor([ac.optics.Gaussian(0.35), ac.optics.Smear(1.0, "along"), ac.optics.Detector()])
image, truth = ac.simulate.points(sensor, snr=80, rng=np.random.default_rng(3))
image[60, 40] += 900.0
found = ac.measure_points(image)
print(len(found.sources), "sources")
for spot in found.rejected:
    print(f"{spot.reason} at row {spot.row:.0f}, column {spot.col:.0f}: {spot.message}")

# %%
# Both directions come from one 2-D OTF, with their standard deviations.
for name, response in (("across", found.across), ("along", found.along)):
    true = truth.response(name)
    print(f"{name:6} MTF at Nyquist {response.mtf_nyquist}, truth {true.mtf_nyquist.value:.4f}")
    print(f"{name:6} FWHM {response.fwhm_px} px, truth {true.fwhm_px.value:.3f} px")

# %%
# The PSF, and every place with three times its standard deviation.
distance, psf = found.psf()
figure = Figure(figsize=(10.5, 4.6), layout="constrained")
left, middle, right = figure.subplots(1, 3, width_ratios=(0.6, 1, 1))
left.imshow(image, cmap="gray", vmax=truth.background + 600)
left.plot(found.positions[:, 1], found.positions[:, 0], "o", mfc="none", mec="C1", ms=10)
left.plot([spot.col for spot in found.rejected], [spot.row for spot in found.rejected], "rx")
left.set(title="Sources, and what is none", xlabel="column", ylabel="row")
extent = (distance[0], distance[-1], distance[-1], distance[0])
middle.imshow(psf / psf.max(), cmap="Blues", extent=extent)
middle.contour(distance, distance, psf / psf.max(), levels=(0.05, 0.25, 0.5), colors="k")
middle.set(title="PSF", xlabel="across, px", ylabel="along, px", xlim=(-2.5, 2.5), ylim=(2.5, -2.5))
error = (
    found.positions
    - truth.positions[
        [int(np.argmin(np.hypot(*(truth.positions - place).T))) for place in found.positions]
    ]
)
std = np.array([(one.row.std, one.col.std) for one in found.sources])
right.errorbar(error[:, 1], error[:, 0], 3 * std[:, 0], 3 * std[:, 1], fmt="o")
right.axhline(0, color="k", lw=0.8)
right.axvline(0, color="k", lw=0.8)
right.set(title="Errors of the places", xlabel="across, px", ylabel="along, px")

# %%
# The figure as a file.
figure.savefig("mirrors.png", dpi=110)
print("wrote mirrors.png")
