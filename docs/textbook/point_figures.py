"""Figures of the page on point sources."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import acutance as ac
from acutance.report.paper import BLUE, FAINT, INK, VERMILION, new_page
from acutance.studies import lay_out_mirrors

__all__ = ["FIGURES"]

_TWO_SIDED_95 = 1.96


def layouts_and_phases() -> Figure:
    """Slanted columns as in the QuickBird report, the square of Li et al., and their phases."""
    figure = new_page(10.4, 4.6)
    plans = {
        "20 at 10.2 by 1.25 px": lay_out_mirrors(20, pixel_m=(0.7, 0.7)).places_px,
        "4 by 4 at 5.25 px": ac.simulate.mirror_square((0.0, 0.0)),
    }
    axes = figure.subplots(1, 4, width_ratios=(0.8, 1.1, 1.1, 1.1))
    for i, (title, places) in enumerate(plans.items()):
        ground, phases = axes[2 * i], axes[2 * i + 1]
        ground.plot(places[:, 1], places[:, 0], "o", ms=5, color=BLUE)
        ground.set(title=title, xlabel="across, px", ylabel="along, px", aspect="equal")
        ground.margins(0.15)
        ground.invert_yaxis()
        _draw_phases(phases, places)
    return figure


def _draw_phases(axes: Axes, places: np.ndarray) -> None:
    within = np.mod(places + 1e-9, 1.0)
    axes.plot([0, 1, 1, 0, 0], [0, 0, 1, 1, 0], color=INK, lw=1)
    axes.plot(within[:, 1], within[:, 0], "o", ms=6, color=VERMILION)
    axes.set(title="places within a pixel", xlabel="across, px", xlim=(-0.08, 1.08),
             ylim=(1.08, -0.08), aspect="equal")  # fmt: skip


def phases_make_a_finer_grid() -> Figure:
    """One source's pixels along a line, and those of 20 sources about their fitted places."""
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
    image, _ = ac.simulate.points(sensor, snr=80, rng=np.random.default_rng(4))
    found = ac.measure_points(image)
    fit = found.details.fit
    assert fit is not None
    figure = new_page(10.4, 4.2)
    one, all_of_them = figure.subplots(1, 2, sharey=True)
    x, y = fit.stamps.offsets(fit.places)
    owner = fit.stamps.owner
    background = fit.fitted - fit.light
    peak = float(fit.model.psf(np.zeros(1), np.zeros(1))[0])
    places = np.linspace(-3, 3, 301)
    model = fit.model.psf(places, np.zeros_like(places)) / peak
    near = (np.abs(y) <= 0.5) & (np.abs(x) < 3)
    # The nearest row passes the source at up to half a pixel: the model has the difference.
    raised = (fit.model.psf(x, np.zeros_like(y)) - fit.model.psf(x, y)) / peak
    value = (fit.stamps.value - background) / fit.peaks[owner] + raised
    for axes, chosen, title in (
        (one, near & (owner == owner[near][0]), "the row nearest to one source"),
        (all_of_them, near, "the nearest rows of all sources"),
    ):
        axes.plot(places, model, color=BLUE, lw=1.3, label="fitted PSF")
        axes.plot(x[chosen], value[chosen], ".", ms=5, color=VERMILION, label="pixels")
        axes.set(title=title, xlabel="distance from the source, px")
        axes.legend()
    one.set_ylabel("share of the peak")
    return figure


def mirrors_and_truth() -> Figure:
    """20 mirrors seen by a smeared sensor: the image, and both slices with the truth."""
    sensor = ac.Sensor(
        [ac.optics.Gaussian(0.35), ac.optics.Smear(0.9, "along"), ac.optics.Detector()]
    )
    image, truth = ac.simulate.points(sensor, snr=80, rng=np.random.default_rng(5))
    found = ac.measure_points(image)
    figure = new_page(10.4, 4.4)
    scene, mtf, error = figure.subplots(1, 3, width_ratios=(0.62, 1.2, 1.2))
    scene.imshow(image, cmap="gray")
    scene.set(title="20 mirrors", xlabel="column", ylabel="row")
    scene.grid(False)
    for name, response, color in (
        ("across", found.across, BLUE),
        ("along", found.along, VERMILION),
    ):
        curve, true = response.mtf, truth.response(name).mtf
        half = _TWO_SIDED_95 * curve.std
        mtf.fill_between(curve.freq_cpp, curve.value - half, curve.value + half, color=color,
                         alpha=0.25, lw=0)  # fmt: skip
        mtf.plot(curve.freq_cpp, curve.value, color=color, label=name)
        mtf.plot(true.freq_cpp, true.value, "--", color=INK, lw=1.1)
        at_ours = np.interp(curve.freq_cpp, true.freq_cpp, true.value)
        error.fill_between(curve.freq_cpp, -half, half, color=color, alpha=0.2, lw=0)
        error.plot(curve.freq_cpp, curve.value - at_ours, color=color, label=name)
    mtf.plot([], [], "--", color=INK, lw=1.1, label="truth")
    mtf.axvline(0.5, color=FAINT, lw=1)
    error.axhline(0, color=INK, lw=1, ls="--")
    mtf.set(title="Slices of the OTF, 95 % intervals", xlabel="frequency, cycles per pixel",
            ylabel="MTF", xlim=(0, 1), ylim=(-0.02, 1.02))  # fmt: skip
    error.set(title="Measured less true", xlabel="frequency, cycles per pixel", xlim=(0, 1))
    for axes in (mtf, error):
        axes.legend()
    return figure


FIGURES: dict[str, Callable[[], Figure]] = {
    "point-layouts": layouts_and_phases,
    "point-mirrors": mirrors_and_truth,
    "point-phases": phases_make_a_finer_grid,
}
