"""Angle of a pulse: where the published under-estimate comes from (Figure 3.12)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from acutance.arguments import require_types
from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.errors import OptionError, PhaseError
from acutance.optics import Sensor, preset
from acutance.simulate import pulse
from acutance.studies.result import Finding, StudyResult, printed_for
from acutance.studies.scatter import require_once
from acutance.studies.table import Table
from acutance.studies.targets import measure_published_pulse
from acutance.studies.trials import Execution, Record, run_trials
from acutance.targets.options import chosen_options
from acutance.targets.straight import measure_pulse
from acutance.targets.straight.published.local_polynomial import window_gain

__all__ = ["ANGLE_TERMS", "AngleOptions", "study_angle"]

ANGLE_TERMS = ("window", "width", "row_distance", "rest")
"""Causes of the published error, in the order they are switched off."""

_PUBLISHED_AT_6_DEG_PERCENT = -4.1
"""Read from Figure 3.12 of the report."""


@dataclass(frozen=True)
class AngleOptions:
    """The paper's parameters; what it does not print is the image's size.

    Parameters
    ----------
    sensor : Sensor
    angles_deg : tuple of float
        2 to 14 degrees in steps of 0.1.
    places : int
        Images an angle, the pulse at evenly spread places on the pixel grid: how the samples
        fall into the published windows changes the result by some tenths of a percent.
    width_px : float
    shape : (rows, cols)
    pulse_dn : (dark, bright)

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    sensor: Sensor = field(default_factory=lambda: preset("generic-2005"))
    angles_deg: tuple[float, ...] = tuple(round(2 + 0.1 * i, 1) for i in range(121))
    places: int = 5
    width_px: float = 3.0
    shape: tuple[int, int] = (60, 44)
    pulse_dn: tuple[float, float] = (100.0, 1200.0)

    def __post_init__(self) -> None:
        require_types(self)
        require_once(angles_deg=self.angles_deg)
        angles_known = self.angles_deg and all(0 < angle <= 30 for angle in self.angles_deg)
        if not angles_known or self.places < 1:
            least, most = min(self.angles_deg, default=0.0), max(self.angles_deg, default=0.0)
            raise OptionError(
                f"there are {len(self.angles_deg)} angles, from {least:g} to {most:g} deg, and "
                f"{self.places} places: there has to be a place and an angle, all above 0 and at "
                "most 30"
            )


def study_angle(
    options: AngleOptions | None = None, execution: Execution | None = None
) -> StudyResult:
    """Measure pulses of many angles without noise, and take the published error apart.

    The published pipeline is run with its causes of error switched off one after the other:
    the local polynomial of second degree replaced by one of fourth, the stated width divided by
    the cosine as the row's own, the distance taken along the normal. The ratio of one run to
    the next is the term that was switched off.

    Parameters
    ----------
    options : AngleOptions, optional
    execution : Execution, optional

    Returns
    -------
    StudyResult
        Table "angle" has a row for each angle: the values of both estimators, the terms in
        percent, and the closed form of each (``_predicted``), means over the places; "trials"
        every image.
    """
    chosen = chosen_options(options, AngleOptions)
    how = chosen_options(execution, Execution)
    trials = [
        (angle, place / chosen.places)
        for angle in chosen.angles_deg
        for place in range(chosen.places)
    ]
    records = run_trials("angle", chosen, trials, measure_angle_trial, how)
    measured = Table.of_rows(
        {"angle_deg": angle, "offset_px": offset, **record, **_terms(record)}
        for (angle, offset), record in zip(trials, records, strict=True)
    )
    table = Table.of_rows(
        {**_mean(measured.where(angle_deg=angle)), **_predicted(chosen, angle)}
        for angle in chosen.angles_deg
    )
    return StudyResult(
        "angle", "Angle of the target and the MTF at Nyquist", chosen, how.seed,
        {"angle": table, "trials": measured}, _findings(chosen, table),
    )  # fmt: skip


def _mean(measured: Table) -> dict[str, float]:
    """Means over the places at which the published pipeline works in all its variants."""
    whole = np.isfinite(measured["published_percent"] + measured["rest_percent"])
    used = whole if whole.any() else np.ones_like(whole)
    return {
        name: float(measured[name][used].mean()) for name in measured.columns if name != "offset_px"
    }


def measure_angle_trial(
    options: AngleOptions, trial: tuple[float, float], rng: np.random.Generator
) -> Record:
    """One noise-free pulse of an angle, at a place, by both estimators."""
    del rng
    angle_deg, offset_px = trial
    dark, bright = options.pulse_dn
    image, truth = pulse(
        options.sensor, width_px=options.width_px, angle_deg=angle_deg, shape=options.shape,
        dark=dark, bright=bright, offset_px=offset_px,
    )  # fmt: skip
    w = options.width_px
    variants = {
        "published": _published(image, width_px=w),
        "cosine_corrected": _published(image, width_px=w, width="axis"),
        "order_4": _published(image, width_px=w, order=4),
        "order_4_axis": _published(image, width_px=w, order=4, width="axis"),
        "order_4_normal": _published(image, width_px=w, order=4, distance="normal"),
    }
    ours = measure_pulse(image, width_px=w).mtf_nyquist.value
    return {"truth": truth.mtf_nyquist.value, "ours": ours, **variants}


def _published(image: Floats, **how: Any) -> float:
    """MTF at Nyquist of the published pipeline, ``nan`` where it refuses the sample phases."""
    try:
        return measure_published_pulse(image, **how).response.mtf_nyquist.value
    except PhaseError:
        return math.nan


def _terms(record: Record) -> dict[str, float]:
    ratios = (
        record["published"] / record["order_4"],
        record["order_4"] / record["order_4_axis"],
        record["order_4_axis"] / record["order_4_normal"],
        record["order_4_normal"] / record["truth"],
    )
    terms = {
        f"{name}_percent": 100 * (ratio - 1)
        for name, ratio in zip(ANGLE_TERMS, ratios, strict=True)
    }
    return {
        **terms,
        "published_percent": 100 * (record["published"] / record["truth"] - 1),
        "ours_percent": 100 * (record["ours"] / record["truth"] - 1),
    }


def _predicted(options: AngleOptions, angle_deg: float) -> dict[str, float]:
    """Closed forms of the terms, at the angle itself."""
    stretched = NYQUIST_CPP / math.cos(math.radians(angle_deg))
    mtf = options.sensor.mtf(angle_deg)
    window = float(window_gain(NYQUIST_CPP, 2) / window_gain(NYQUIST_CPP, 4))
    width = float(np.sinc(options.width_px * stretched) / np.sinc(options.width_px * NYQUIST_CPP))
    distance = mtf(stretched).value / mtf(NYQUIST_CPP).value
    return {
        "window_predicted_percent": 100 * (window - 1),
        "width_predicted_percent": 100 * (width - 1),
        "row_distance_predicted_percent": 100 * (distance - 1),
    }


def _findings(options: AngleOptions, table: Table) -> tuple[Finding, ...]:
    angles, named = table["angle_deg"], set()
    printed = printed_for(
        options, _PUBLISHED_AT_6_DEG_PERCENT, ("angles_deg", "places", "shape", "pulse_dn")
    )
    known = np.isfinite(table["rest_percent"])
    found = []
    for wanted in (6.0, 14.0) if known.any() else ():
        i = int(np.argmin(np.where(known, np.abs(angles - wanted), np.inf)))
        if angles[i] in named:
            continue
        named.add(angles[i])
        total = float(table["published_percent"][i])
        parts = ", ".join(
            f"{name.replace('_', ' ')} {table[f'{name}_percent'][i]:+.2f}" for name in ANGLE_TERMS
        )
        found.append(
            Finding(
                f"published_at_{wanted:g}_deg_percent",
                total,
                f"at {angles[i]:g} deg the published estimator is {total:+.1f} % off: {parts} %",
                printed if angles[i] == 6.0 else None,
            )
        )
    known = np.isfinite(table["published_percent"])
    if np.unique(angles[known]).size > 1:
        intercept = _at_no_angle(angles[known], table["published_percent"][known])
        found.append(
            Finding(
                "published_at_0_deg_percent",
                intercept,
                f"its quadratic meets no angle at all at {intercept:+.2f} %: the part that does "
                "not come from the angle is the window's",
            )
        )
    worst = float(np.max(np.abs(table["ours_percent"])))
    found.append(
        Finding("ours_worst_percent", worst, f"our estimator is at most {worst:.3f} % off")
    )
    return tuple(found)


def _at_no_angle(angles: Floats, percent: Floats) -> float:
    """The constant of a constant and a quadratic through the errors."""
    design = np.column_stack([np.ones_like(angles), angles**2])
    return float(np.linalg.lstsq(design, percent, rcond=None)[0][0])
