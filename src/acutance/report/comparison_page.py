"""Several measurements of one target, side by side."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from acutance.curves import Estimate
from acutance.report.grids import write_grid
from acutance.report.page import INK, NAME_WITH_ROOM, PALETTE, new_page, split_page, styled
from acutance.report.panels import TOP_BESIDE_ZEROS, band_edges, mark_frequencies, mark_zeros
from acutance.report.wording import MISSING, describe_image, metric_words, numbers_of, word_estimate
from acutance.targets.straight.pulse_response import prf_fwhm

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from acutance.curves import Response
    from acutance.curves.grid import Floats
    from acutance.targets.measurement import Measurement

__all__ = ["COMPARED", "comparison_figure", "edge_labels", "true_numbers"]

MOST_BESIDE_ZEROS = 0.2
COMPARED = ("mtf_nyquist", "rer", "fwhm_px", "mtf50_cpp", "mtf_area", "overshoot")


def edge_labels(measurements: Sequence[Measurement]) -> tuple[str, ...]:
    """Short names that tell measurements apart: methods, or numbers where methods repeat."""
    methods = [one.method for one in measurements]
    if len(set(methods)) == len(methods):
        return tuple(methods)
    return tuple(f"{number} {method}" for number, method in enumerate(methods, start=1))


def comparison_figure(
    measurements: Sequence[Measurement],
    *,
    truth: Response | None = None,
    true_width_px: float | None = None,
) -> Figure:
    """Several measurements of one target side by side: curves, differences, numbers.

    Parameters
    ----------
    measurements : sequence of Measurement
    truth : Response, optional
        The true curves of a simulated target. Differences are taken to it, or to the first
        measurement where the truth is not known.
    true_width_px : float, optional
        The true width of a simulated pulse.
    """
    labels = edge_labels(measurements)
    responses = {label: one.response for label, one in zip(labels, measurements, strict=True)}
    name, reference = ("truth", truth) if truth is not None else next(iter(responses.items()))
    with styled():
        table_in = 0.35 + 0.22 * (len(labels) + (truth is not None))
        figure = new_page(13.0, 6.4 + table_in)
        upper, lower = split_page(figure, 2, 1, heights=(6.4, table_in))
        left, right = split_page(upper, 1, 2, widths=(1.15, 1.0))
        width = measurements[0].width_px
        mtfs = left.subplots()
        _draw_mtfs(mtfs, responses, truth, math.inf if width is None else TOP_BESIDE_ZEROS)
        mtf_axes, esf_axes = right.subplots(2, 1)
        _draw_mtf_differences(mtf_axes, responses, reference, name)
        if width is not None:
            mark_zeros(mtfs, width.value)
            low, high = mtf_axes.get_ylim()
            mtf_axes.set_ylim(max(low, -MOST_BESIDE_ZEROS), min(high, MOST_BESIDE_ZEROS))
        _draw_esf_differences(esf_axes, responses, reference, name)
        numbers = {label: numbers_of(one) for label, one in zip(labels, measurements, strict=True)}
        _write_comparison(lower.subplots(), numbers, true_numbers(truth, true_width_px))
        figure.suptitle(
            f"One target measured by {len(labels)} methods\n"
            f"{describe_image(measurements[0], NAME_WITH_ROOM)}",
            x=0.012,
            ha="left",
            fontsize=11,
        )
    return figure


def _draw_mtfs(
    axes: Axes, responses: Mapping[str, Response], truth: Response | None, most: float
) -> None:
    top = max(float(response.mtf.value.max()) for response in responses.values())
    mark_frequencies(axes, next(iter(responses.values())).gsd_m, min(top, most))
    for (label, response), color in zip(responses.items(), _colors(len(responses)), strict=True):
        mtf = response.mtf
        low, high = band_edges(mtf.value, mtf.std)
        axes.fill_between(mtf.freq_cpp, low, high, color=color, alpha=0.18, linewidth=0)
        axes.plot(mtf.freq_cpp, mtf.value, color=color, label=label)
    if truth is not None:
        axes.plot(truth.mtf.freq_cpp, truth.mtf.value, "k--", linewidth=1.3, label="truth")
    axes.set_title("Modulation transfer function")
    axes.legend(loc="upper right")


def _colors(count: int) -> list[str]:
    return [PALETTE[i % len(PALETTE)] for i in range(count)]


def _draw_mtf_differences(
    axes: Axes, responses: Mapping[str, Response], reference: Response, name: str
) -> None:
    freq = reference.mtf.freq_cpp
    for (label, response), color in zip(responses.items(), _colors(len(responses)), strict=True):
        mtf = response.mtf
        if response is not reference:
            value = np.interp(freq, mtf.freq_cpp, mtf.value) - reference.mtf.value
            std = np.interp(freq, mtf.freq_cpp, mtf.std)
            _draw_difference(axes, freq, value, std, color, label)
    _mark_zero(axes)
    axes.axvline(0.5, color=INK, linewidth=1, dashes=(5, 3))
    axes.set(xlim=(0.0, 1.0), xlabel="frequency [cycles/pixel]", title=f"MTF less {name}")


def _draw_esf_differences(
    axes: Axes, responses: Mapping[str, Response], reference: Response, name: str
) -> None:
    places = np.linspace(-5.0, 5.0, 501)
    base, _ = _esf_at(reference, places)
    for (label, response), color in zip(responses.items(), _colors(len(responses)), strict=True):
        if response is not reference:
            value, std = _esf_at(response, places)
            _draw_difference(axes, places, value - base, std, color, label)
    _mark_zero(axes)
    axes.set(xlim=(-5, 5), xlabel="distance along the normal [px]", title=f"ESF less {name}")


def _draw_difference(
    axes: Axes, places: Floats, value: Floats, std: Floats, color: str, label: str
) -> None:
    low, high = band_edges(value, std)
    axes.fill_between(places, low, high, color=color, alpha=0.18, linewidth=0)
    axes.plot(places, value, color=color, label=label)


def _mark_zero(axes: Axes) -> None:
    axes.axhline(0.0, color=INK, linewidth=1, dashes=(4, 3), zorder=1)


def _esf_at(response: Response, places: Floats) -> tuple[Floats, Floats]:
    esf = response.esf
    value = np.interp(places, esf.distance_px, esf.value, left=0.0, right=1.0)
    return value, np.interp(places, esf.distance_px, esf.std)


def true_numbers(truth: Response | None, true_width_px: float | None) -> dict[str, Estimate]:
    """What is known of a simulated target, under the names its measurements have."""
    widths = {} if true_width_px is None else {"width": Estimate(true_width_px)}
    if truth is None:
        return {f"{name}_px": width for name, width in widths.items()}
    if true_width_px is not None:
        widths["prf_fwhm"] = prf_fwhm(truth, true_width_px, np.empty(0))
    known = {f"{name}_px": width for name, width in widths.items()}
    if truth.gsd_m is not None:
        known |= {f"{name}_m": truth.gsd_m * width for name, width in widths.items()}
    return {**known, **truth.metrics()}


def _write_comparison(
    axes: Axes, numbers: Mapping[str, Mapping[str, Estimate]], truth: Mapping[str, Estimate]
) -> None:
    pulses = all("width_px" in each for each in numbers.values())
    names = (*(("width_px",) if pulses else ()), *COMPARED)
    rows = [("", "", *(metric_words(name).label_with_unit for name in names))]
    marks = [INK]
    if truth:
        known = (word_estimate(truth[name]).value if name in truth else MISSING for name in names)
        rows.append(("–", "truth", *known))
        marks.append(INK)
    for (label, each), color in zip(numbers.items(), _colors(len(numbers)), strict=True):
        rows.append(("■", label, *(word_estimate(each[name]).value_and_std for name in names)))
        marks.append(color)
    places = (0.01, 0.03, *np.linspace(0.27, 1.0, len(names)))
    write_grid(axes, rows, places=places, align="ll" + "r" * len(names), marks=marks)
