"""Plan a target: which accuracy to expect of an edge or a pulse before it is bought."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.optics import Sensor
from acutance.simulate import edge, pulse
from acutance.studies.bound import Design, equivalent_blur, free_bound, shape_bound
from acutance.studies.plan_options import MAX_ROWS, MIN_ROWS, PlanOptions
from acutance.studies.result import Finding, StudyResult
from acutance.studies.table import Cell, Table
from acutance.studies.trials import Execution, Record, run_trials
from acutance.targets.options import chosen_options
from acutance.targets.straight import measure_edge, measure_pulse

__all__ = ["PLAN_METRICS", "plan_target"]

PLAN_METRICS = ("mtf_nyquist", "rer", "fwhm_px", "width_px")

_ROWS_SHARES = (0.5, 1.0, 1.5, 2.0)
"""Numbers of rows compared with a single one that is planned."""

_ROOM_PX = 10.0
"""Plateau beyond the target on either side, or three times the FWHM if that is more."""

_NEAR_THE_BEST = 0.1
"""Designs whose error is within this share of the least are named as good ones."""


def plan_target(
    options: PlanOptions | None = None, execution: Execution | None = None
) -> StudyResult:
    """Expected standard deviations of MTF at Nyquist, RER, FWHM and of a pulse's width.

    Parameters
    ----------
    options : PlanOptions, optional
    execution : Execution, optional

    Returns
    -------
    StudyResult
        Table "plan" has a row for each design: the plan, then rows, angle and width varied one
        at a time. Of every metric the Cramér-Rao bound of a blur of known shape (``_bound``),
        the scatter of our estimator (``_std``), its rms error (``_rms``) and what it states
        itself (``_stated``); of the MTF at Nyquist also the bound of a free LSF (``_free``).
    """
    chosen = chosen_options(options, PlanOptions)
    how = chosen_options(execution, Execution)
    listed = list(_designs(chosen))
    # The plan comes once in every list: its images are simulated once.
    designs = list({repr(design): design for _, design in listed}.values())
    trials = [design for design in designs for _ in range(chosen.draws)]
    records = run_trials("plan", chosen, trials, measure_plan_trial, how)
    rows = {
        repr(design): _row(chosen, design, records[i * chosen.draws : (i + 1) * chosen.draws])
        for i, design in enumerate(designs)
    }
    table = Table.of_rows({"varied": varied, **rows[repr(design)]} for varied, design in listed)
    title = f"Plan of {'an edge' if chosen.target == 'edge' else 'a pulse'}"
    return StudyResult("plan", title, chosen, how.seed, {"plan": table}, _findings(chosen, table))


def _designs(options: PlanOptions) -> Iterator[tuple[str, Design]]:
    """The plan, then every design that differs from it in one thing, by that thing's name."""
    rows, angle, width = options.rows[0], options.angles_deg[0], _planned_width(options)
    is_pulse = options.target == "pulse"
    plan = Design(options.target, rows, angle, width if is_pulse else math.nan)
    yield "plan", _wide_enough(plan, options.sensor)
    more_rows = options.rows[1:] or [
        min(max(MIN_ROWS, round(share * rows)), MAX_ROWS) for share in _ROWS_SHARES
    ]
    more_angles = options.angles_deg[1:] or (2.0, 4.0, 6.0, 8.0, 11.0, 14.0)
    single = len(options.widths_px) == 1
    more_widths = (1.5, 2.0, 2.5, 3.0, 3.5, 4.0) if single else options.widths_px
    for count in sorted({rows, *more_rows}):
        yield "rows", _wide_enough(replace(plan, rows=count), options.sensor)
    for tilt in _with_own(angle, more_angles):
        yield "angle", _wide_enough(replace(plan, angle_deg=tilt), options.sensor)
    for size in _with_own(width, more_widths) if is_pulse else ():
        yield "width", _wide_enough(replace(plan, width_px=size), options.sensor)


def _with_own(own: float, others: Sequence[float]) -> list[float]:
    """The plan's own number and others, rising; one that differs by rounding is the own one.

    A width in metres over the GSD is seldom exactly a number of pixels.
    """
    different = [one for one in set(others) if not math.isclose(one, own)]
    return sorted([own, *different])


def _planned_width(options: PlanOptions) -> float:
    """Of several widths the one with the least bound of a free LSF, in pixels.

    Of those with none, whose spectrum is zero at Nyquist, the one with the least bound of a blur
    of known shape.
    """
    rows, angle = options.rows[0], options.angles_deg[0]
    blur = equivalent_blur(options.sensor, angle)

    def bound(width: float) -> tuple[float, float]:
        design = _wide_enough(Design("pulse", rows, angle, width), options.sensor)
        free = free_bound(blur, design, options.snr, options.window_px)
        return free, shape_bound(blur, design, options.snr).mtf_nyquist

    several = len(options.widths_px) > 1 and options.target == "pulse"
    return min(options.widths_px, key=bound) if several else options.widths_px[0]


def _wide_enough(design: Design, sensor: Sensor) -> Design:
    """The design in rows that reach 10 px, or three blurs, beyond the target."""
    room = _room_px(design.angle_deg, sensor)
    across = 0.0 if math.isnan(design.width_px) else design.width_px
    leaning = design.rows * math.tan(math.radians(design.angle_deg))
    return replace(design, cols=math.ceil(leaning + across + 2 * room))


def _room_px(angle_deg: float, sensor: Sensor) -> float:
    """Plateau along the normal on either side of the target."""
    return max(_ROOM_PX, 3 * sensor.response(angle_deg).fwhm_px.value)


def measure_plan_trial(options: PlanOptions, design: Design, rng: np.random.Generator) -> Record:
    """One simulated target of a design by our estimator, somewhere on the pixel grid."""
    shape, offset = (design.rows, design.cols), float(rng.uniform(-0.5, 0.5))
    try:
        if options.target == "edge":
            image, edge_truth = edge(
                options.sensor, angle_deg=design.angle_deg, shape=shape, offset_px=offset,
                snr=options.snr, rng=rng,
            )  # fmt: skip
            found, truth = measure_edge(image), edge_truth.response
        else:
            image, pulse_truth = pulse(
                options.sensor, width_px=design.width_px, angle_deg=design.angle_deg,
                shape=shape, offset_px=offset, snr=options.snr, rng=rng,
            )  # fmt: skip
            found, truth = measure_pulse(image, width_px=design.width_px), pulse_truth.response
    except TargetError:
        return {f"{name}_{part}": math.nan for name in PLAN_METRICS for part in ("error", "std")}
    width = found.width_px or Estimate(math.nan, math.nan)
    pairs = {
        "mtf_nyquist": (found.mtf_nyquist, truth.mtf_nyquist.value),
        "rer": (found.rer, truth.rer.value),
        "fwhm_px": (found.fwhm_px, truth.fwhm_px.value),
        "width_px": (width, design.width_px),
    }
    return {f"{name}_error": one.value - true for name, (one, true) in pairs.items()} | {
        f"{name}_std": one.std for name, (one, _) in pairs.items()
    }


def _row(options: PlanOptions, design: Design, records: list[Record]) -> dict[str, Cell]:
    gsd_m = options.sensor.gsd_along_normal_m(design.angle_deg) or math.nan
    blur = equivalent_blur(options.sensor, design.angle_deg)
    bound = shape_bound(blur, design, options.snr)
    row: dict[str, Cell] = {
        "rows": design.rows,
        "length_m": _length_m(design, options.sensor),
        "angle_deg": design.angle_deg,
        "target_width_px": design.width_px,
        "target_width_m": design.width_px * gsd_m,
        "mtf_nyquist_free": free_bound(blur, design, options.snr, options.window_px),
    }
    for name in PLAN_METRICS:
        error = np.array([record[f"{name}_error"] for record in records])
        stated = np.array([record[f"{name}_std"] for record in records])
        known = np.isfinite(error)
        several = np.count_nonzero(known) > 1
        row |= {
            f"{name}_bound": float(getattr(bound, name)),
            f"{name}_std": float(error[known].std(ddof=1)) if several else math.nan,
            f"{name}_rms": float(np.sqrt(np.mean(error[known] ** 2))) if several else math.nan,
            f"{name}_stated": float(stated[known].mean()) if several else math.nan,
        }
    row["refused"] = sum(math.isnan(record["mtf_nyquist_error"]) for record in records)
    return row


def _length_m(design: Design, sensor: Sensor) -> float:
    """Length on the ground of a line that crosses the rows: it runs along the track, mostly."""
    row_m, col_m = sensor.pixel_m or (math.nan, math.nan)
    leaning = math.tan(math.radians(design.angle_deg))
    return design.rows * math.hypot(row_m, leaning * col_m)


def _findings(options: PlanOptions, table: Table) -> tuple[Finding, ...]:
    """The answers: what to expect, how many rows, which angle, which width."""
    simulated = options.draws > 1
    kind = "mtf_nyquist_rms" if simulated else "mtf_nyquist_free"
    expected = float(table[kind][0])
    found = [_expected(options, table, expected)]
    if refused := int(table["refused"][0]):
        found.append(_refused(refused, options.draws))
    found.append(_room(options))
    widths = dict.fromkeys(options.widths_px)
    if len(widths) > 1 and options.target == "pulse":
        found.append(_width_taken(list(widths), table))
    if options.accuracy is not None and math.isfinite(expected):
        found.append(_rows_needed(options.accuracy, expected, int(table["rows"][0])))
    # The rms of n draws is uncertain by one part in sqrt(2 n).
    slack = 1 + max(_NEAR_THE_BEST, 2 / math.sqrt(options.draws) if simulated else 0.0)
    varied = {"angle": ("angle_deg", "deg"), "width": ("target_width_px", "px")}
    for name, (column, unit) in varied.items():
        own = table.where(varied=name)
        if not (len(own) and np.isfinite(own[kind]).any()):
            continue
        value, choice = own[kind], own[column]
        best = float(choice[int(np.nanargmin(value))])
        good = ", ".join(f"{one:.3g}" for one in choice[value <= slack * np.nanmin(value)])
        beside = _beside_plan(expected, value, slack, simulated)
        error = "error" if simulated else "bound"
        metres = float(own["target_width_m"][int(np.nanargmin(value))])
        on_ground = f" ({metres:.3g} m)" if name == "width" and math.isfinite(metres) else ""
        found.append(
            Finding(
                f"best_{column}",
                best,
                f"{name}: {best:.3g} {unit}{on_ground} has the smallest {error}; within "
                f"{100 * (slack - 1):.0f} % of it: {good} {unit}{beside}",
            )
        )
    return tuple(found)


def _expected(options: PlanOptions, table: Table, expected: float) -> Finding:
    """The error of the MTF at Nyquist that is to be expected of the plan."""
    how = "bound of a free LSF"
    if options.draws > 1:
        stated = float(table["mtf_nyquist_stated"][0])
        itself = f", which states ± {stated:.4f}" if math.isfinite(stated) else ""
        how = f"rms error of our estimator{itself}"
    rows, width = int(table["rows"][0]), float(table["target_width_px"][0])
    across = "" if math.isnan(width) else f" of a pulse {width:.3g} px wide"
    design = f"{rows} rows{across} at {options.angles_deg[0]:g} deg and an SNR of {options.snr:g}"
    if math.isfinite(expected):
        answer = f"{expected:.4f} ({how}) from {design}"
    else:
        advice = "choose another design"
        if math.isinf(expected):
            advice = "the spectrum of such a pulse is zero there; choose another width"
        answer = f"no number ({how}) from {design}: {advice}"
    return Finding("expected_mtf_nyquist", expected, f"MTF at Nyquist: {answer}")


def _width_taken(widths_px: Sequence[float], table: Table) -> Finding:
    """Which of several widths is planned, and why."""
    listed, width = ", ".join(f"{one:.3g}" for one in widths_px), float(table["target_width_px"][0])
    free = math.isfinite(float(table["mtf_nyquist_free"][0]))
    least = "a free LSF" if free else "a known shape (none has one of a free LSF)"
    text = (
        f"plan: of the widths {listed} px, {width:.3g} px has the least bound of {least} and is "
        "taken; name one alone to plan another"
    )
    return Finding("planned_width_px", width, text)


def _refused(refused: int, draws: int) -> Finding:
    """How many images of the plan gave no number: errors are those of the others alone."""
    others = "; errors are those of the others" if refused < draws else ""
    text = (
        f"refused: {refused} of {draws} simulated images of the plan could not be measured{others}"
        ": raise the SNR, or the rows"
    )
    return Finding("refused", refused, text)


def _room(options: PlanOptions) -> Finding:
    """How far the ground has to be level beside the target."""
    angle = options.angles_deg[0]
    room_px, gsd_m = _room_px(angle, options.sensor), options.sensor.gsd_along_normal_m(angle)
    on_ground = "" if gsd_m is None else f" ({room_px * gsd_m:.3g} m)"
    whose = "of the edge" if options.target == "edge" else "of the pulse, beyond its own width"
    text = (
        f"room: {room_px:.3g} px{on_ground} of level ground on either side {whose}, along its "
        "normal and over its whole length"
    )
    return Finding("room_px", room_px, text)


def _beside_plan(planned: float, errors: Floats, slack: float, simulated: bool) -> str:
    """Whether the plan is one of the good designs, where another has the smallest error.

    What was simulated is by chance in part, and bounds are not.
    """
    if not math.isfinite(planned):
        return "; the plan has none"
    excess = planned / float(np.nanmin(errors)) - 1
    if not excess > 0:
        return ""
    if 1 + excess <= slack:
        chance = ": what is between them may be chance" if simulated else ""
        return f"; the plan is one of them{chance}"
    return f"; that of the plan is {100 * excess:.0f} % larger"


def _rows_needed(accuracy: float, expected: float, rows: int) -> Finding:
    """The rows of a wanted accuracy, where they can be measured and planned."""
    # A product is infinite where a power would be an error.
    ratio = expected / accuracy
    needed = math.ceil(max(MIN_ROWS, min(rows * ratio * ratio, MAX_ROWS + 1)))
    asked = f"rows: a standard deviation of {accuracy:g}"
    if needed > MAX_ROWS:
        text = (
            f"{asked} needs more than the {MAX_ROWS} of them that are planned: raise the SNR, or "
            "measure several targets"
        )
    elif needed == MIN_ROWS:
        text = f"{asked} needs no more than {needed} of them, the fewest that can be measured"
    else:
        text = f"{asked} needs about {needed} of them (it falls with their square root)"
    return Finding("rows_needed", needed if needed <= MAX_ROWS else math.inf, text)
