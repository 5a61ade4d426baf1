"""
A sensor measured against a finer one
=====================================

No target, only the same fields seen twice: at 20 m and at 10 m.
"""

# sphinx_gallery_thumbnail_path = "generated/thumbnail-plot_8_two_resolutions.png"

import numpy as np
from matplotlib.figure import Figure

import acutance as ac

# %%
# The low sensor is smeared along its track. Its image is displaced, darker, and noisy.
fine = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
coarse = ac.Sensor([*fine.blocks, ac.optics.Smear(0.8, "along")])
low, high, truth = ac.simulate.pair(
    coarse, fine, ratio=2, shift_px=(0.4, -1.2), gain=0.8, snr=100, rng=np.random.default_rng(4)
)
m = ac.measure_biresolution(low, high, reference_mtf=fine)
for name, found in (("across", m.across), ("along", m.along)):
    true = truth.response(name).mtf_nyquist
    print(f"{name}: MTF at Nyquist {found.mtf_nyquist}, truth {true}")
print("shift:", *m.shift_px, " gain:", round(m.gain, 3))
print("failed checks:", [check.name for check in m.failed_checks])

# %%
# Without the reference the result is the quotient of both MTFs, and a check fails. At a ratio
# of 2 that is a third too large at Nyquist.
bare = ac.measure_biresolution(low, high)
print("MTF_low / MTF_high at Nyquist:", bare.along.mtf_nyquist)
print(next(check.message for check in bare.failed_checks))

# %%
# Blue and orange: measured, with 95 % intervals. Dashed: the truth. Dotted: not divided out.
figure = Figure(figsize=(10.5, 4.4), layout="constrained")
left, right = figure.subplots(1, 2)
left.imshow(low, cmap="gray", interpolation="nearest")
left.set_title("The low image")
for i, name in enumerate(("across", "along")):
    mtf, true = getattr(m, name).mtf, truth.response(name).mtf
    right.plot(mtf.freq_cpp, mtf.value, color=f"C{i}", label=name)
    right.fill_between(
        mtf.freq_cpp,
        mtf.value - 1.96 * mtf.std,
        mtf.value + 1.96 * mtf.std,
        color=f"C{i}",
        alpha=0.2,
        lw=0,
    )
    right.plot(true.freq_cpp, true.value, "k--", lw=1)
    quotient = getattr(bare, name).mtf
    right.plot(quotient.freq_cpp, quotient.value, ":", color=f"C{i}")
right.set(xlim=(0, 0.8), ylim=(0, 1.05), title="MTF", xlabel="cycles per low pixel")
right.legend()

# %%
# The figure as a file.
figure.savefig("two-resolutions.png", dpi=110)
print("wrote two-resolutions.png")
