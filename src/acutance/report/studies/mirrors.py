"""A plan of mirrors in words and as a drawing."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from acutance.archive.counted import counted
from acutance.arguments import require_class
from acutance.curves.aligned_columns import align_columns
from acutance.report.labels import MISSING, format_number
from acutance.report.paper import BLUE, FAINT, INK, new_page, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from acutance.curves.grid import Floats
    from acutance.studies import MirrorPlan

__all__ = ["mirror_plan_figure", "mirror_plan_text"]

NUMBERS = {
    "mtf_nyquist": "MTF at Nyquist",
    "rer": "RER",
    "fwhm_px": "FWHM [px]",
    "position_px": "place [px]",
}

_ENOUGH_DRAWS = 20
_MUCH_WIDER = 1.5
"""Root mean square error over stated deviation; 20 draws show it to a sixth."""

_SURELY_BIASED = 4.0
"""Mean error over its own standard deviation: by chance in one of 16 000 plans."""


def mirror_plan_text(plan: MirrorPlan) -> str:
    """A plan of mirrors as text: layout, mirrors, phases, what to expect."""
    require_class("MirrorPlan", plan=plan)
    layout, options = plan.layout, plan.options
    along_m, across_m = layout.pixel_m
    if options.count == 1:
        # One mirror has no distance to another, and no steps.
        where, steps = "1 mirror in 1 column", ""
    elif options.arrangement == "columns":
        columns = counted(options.column_count, "column")
        apart = (
            f", {layout.apart_px:.2f} px ({_metres(layout.apart_px * across_m)} m) apart"
            if options.column_count > 1
            else ""
        )
        where = f"{options.count} mirrors in {columns}{apart}"
        steps = (
            f"\n  steps of {layout.step_px[1]:g} px across and {layout.step_px[0]:g} px along "
            f"({_metres(layout.step_px[1] * across_m)} by "
            f"{_metres(layout.step_px[0] * along_m)} m), "
            f"{layout.angle_deg:.1f} degrees against the image's columns"
        )
    else:
        where = f"{counted(options.count, 'mirror')} in a square"
        steps = (
            f"\n  pitch {layout.step_px[0]:g} px "
            f"({_metres(layout.step_px[0] * across_m)} m across, "
            f"{_metres(layout.step_px[0] * along_m)} m along)"
        )
    changes = (-0.05, -0.02, 0.0, 0.02, 0.05)
    gaps = ", ".join(f"{layout.gap_px(change):.2f} ({change:+.0%})" for change in changes)
    blocks = [
        f"{where}{steps}\n  largest gap of the phases, px, if the GSD is other than planned: "
        f"{gaps}",
        f"mirrors: radius of curvature {_metres(plan.radius_m)} m, cap at least "
        f"{_metres(plan.diameter_m)} m across\n"
        f"  for a brightest pixel as bright as ground of reflectance {options.level:g} on "
        f"ground of {options.ground:g};\n  the brightest pixel holds {100 * plan.peak_share:.0f} % "
        "of a mirror's light",
        _expected(plan),
        *_images(plan),
        *(f"note: {note}" for note in plan.notes),
    ]
    return "\n\n".join(blocks)


def _metres(length_m: float) -> str:
    """A length to three digits at least: light goes with the square of a radius."""
    return f"{length_m:.2f}" if length_m >= 1 else f"{length_m:#.3g}"


def _expected(plan: MirrorPlan) -> str:
    bound = format_number(plan.position_std_px, 2)
    if not plan.std:
        place = f"place of a mirror at SNR {plan.options.snr:g}: no better than ± {bound} px"
        return f"{place}{_none_measured(plan)}"
    rows: list[tuple[str, ...]] = [
        ("to expect", "error (rms)", "", "of it bias", "", "std stated", ""),
        ("", *("across", "along") * 3),
    ]
    for name, words in NUMBERS.items():
        cells = [
            format_number(numbers.get(f"{name} {direction}", float("nan")), 2) or MISSING
            for numbers in (plan.scatter, plan.bias, plan.std)
            for direction in ("across", "along")
        ]
        rows.append((words, *cells))
    refused = f", {plan.refused} of them refused" if plan.refused else ""
    return (
        align_columns(rows, "lrrrrrr", indent="")
        + f"\n  at SNR {plan.options.snr:g}, {plan.options.draws} simulated images{refused}; "
        f"places no better than ± {bound} px" + _narrow(plan) + _biased(plan)
    )


def _none_measured(plan: MirrorPlan) -> str:
    """That no error can be told, where every simulated image was refused."""
    if not plan.refused:
        return ""
    return (
        f"\nto expect: no number: none of {plan.refused} simulated images could be measured; raise "
        "the SNR"
    )


def _images(plan: MirrorPlan) -> list[str]:
    """How many images give the wanted accuracy, if one is wanted."""
    needed, wanted = plan.images_needed, plan.options.accuracy
    if needed is None:
        return []
    asked = f"images: an error of {wanted:g} of the MTF at Nyquist, across and along, needs"
    if math.isinf(needed):
        return [f"{asked} a larger SNR or more mirrors:\n  the bias of these is as large"]
    if needed == 1:
        return [f"{asked} one image of these mirrors"]
    return [f"{asked} the mean of {needed:.0f} images of these mirrors"]


def _narrow(plan: MirrorPlan) -> str:
    """Which stated deviations are too small for this sensor, if there are draws enough."""
    if plan.options.draws - plan.refused < _ENOUGH_DRAWS:
        return ""
    names = [
        f"{words} {direction}"
        for name, words in NUMBERS.items()
        for direction in ("across", "along")
        if plan.scatter[f"{name} {direction}"] > _MUCH_WIDER * plan.std[f"{name} {direction}"]
    ]
    if not names:
        return ""
    return (
        f"\n  of this sensor a measurement states too little for {', '.join(names)}:\n  plan with "
        "the error, not with the deviation that a result prints"
    )


def _biased(plan: MirrorPlan) -> str:
    """Numbers with a bias that neither more mirrors nor more images average out."""
    measured = plan.options.draws - plan.refused
    if measured < _ENOUGH_DRAWS:
        return ""
    names = []
    for key, bias in plan.bias.items():
        scatter = math.sqrt(max(plan.scatter[key] ** 2 - bias**2, 0.0))
        if abs(bias) > plan.std[key] and abs(bias) > _SURELY_BIASED * scatter / math.sqrt(measured):
            name, _, direction = key.rpartition(" ")
            names.append(f"{NUMBERS[name]} {direction} {format_number(bias, 2)}")
    if not names:
        return ""
    return (
        f"\n  bias, which more images do not average out: {', '.join(names)};\n  a larger SNR "
        "lowers it"
    )


def mirror_plan_figure(plan: MirrorPlan) -> Figure:
    """The mirrors on the ground, and their phases within the pixel."""
    require_class("MirrorPlan", plan=plan)
    layout = plan.layout
    with styled():
        figure = new_page(9.6, 4.8)
        ground, phases = figure.subplots(1, 2)
        metres = layout.places_m
        ground.plot(metres[:, 1], metres[:, 0], "o", color=BLUE)
        _number(ground, metres)
        # As much room on all sides, also around a layout of one column.
        (top, left), (bottom, right) = metres.min(axis=0), metres.max(axis=0)
        room = 0.12 * max(bottom - top, right - left)
        ground.set(
            xlim=(left - room, right + room), ylim=(bottom + room, top - room), aspect="equal",
            xlabel="across [m]", ylabel="along [m]", title="On the ground",
        )  # fmt: skip
        places = layout.phases
        phases.plot([0, 1, 1, 0, 0], [0, 0, 1, 1, 0], color=FAINT, lw=1)
        phases.plot(places[:, 1], places[:, 0], "o", color=BLUE)
        _number(phases, places)
        phases.set(
            xlim=(-0.08, 1.08), ylim=(1.08, -0.08), aspect="equal", xlabel="across [px]",
            ylabel="along [px]", title=f"Phases: largest gap {layout.gap_px():.2f} px",
        )  # fmt: skip
    return figure


def _number(axes: Axes, places: Floats) -> None:
    for number, (down, right) in enumerate(places.tolist(), start=1):
        axes.annotate(
            str(number), (right, down), (5, 3), textcoords="offset points", fontsize=7, color=INK
        )
