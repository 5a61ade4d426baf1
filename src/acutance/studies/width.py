"""Width of a pulse: measured wrong, or laid out wrong (Figures 3.13-3.19, 3.24)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from acutance.arguments import require_types
from acutance.curves.grid import FREQ_CPP
from acutance.curves.metrics import NYQUIST_CPP
from acutance.errors import OptionError
from acutance.optics import Sensor, preset
from acutance.simulate import pulse
from acutance.studies.result import Finding, StudyResult
from acutance.studies.scatter import require_once
from acutance.studies.table import Table
from acutance.studies.targets import ESTIMATORS, measure_published_pulse
from acutance.studies.trials import Execution, Record, run_trials
from acutance.targets.options import chosen_options
from acutance.targets.straight import measure_pulse
from acutance.targets.straight.pulse_spectrum import width_error_gain

__all__ = ["WIDTH_FREQ_CPP", "WidthOptions", "WidthTrial", "study_width"]

WIDTH_FREQ_CPP: tuple[float, ...] = tuple(FREQ_CPP[FREQ_CPP <= NYQUIST_CPP].tolist())
"""Frequencies of the curves, to Nyquist."""

_REPORTED_CPP = (0.3, 0.4, NYQUIST_CPP)
"""Where the paper looks: on either side of the spectrum's first zero, and at Nyquist."""


_WORDS = {"measured": "a wrong stated", "true": "another true"}
_LARGE_PERCENT = 1000.0


@dataclass(frozen=True)
class WidthTrial:
    """One pulse.

    Parameters
    ----------
    error : {"measured", "true"}
        Which of the two widths is not the nominal one: "measured" is the human measurement
        error (3.6.1), "true" the systematic width error (3.6.2).
    width_px : float
        The other width.
    """

    error: Literal["measured", "true"]
    width_px: float

    def widths_px(self, nominal_px: float) -> tuple[float, float]:
        """True and stated width."""
        if self.error == "measured":
            return nominal_px, self.width_px
        return self.width_px, nominal_px


@dataclass(frozen=True)
class WidthOptions:
    """The paper's parameters; what it does not print is the image's size.

    Parameters
    ----------
    sensor : Sensor
    widths_px : tuple of float
        2.75 to 3.25 px in steps of 0.05.
    nominal_px : float
        Changes are told from this width, which is measured in any case.
    angle_deg : float
    shape : (rows, cols)
    pulse_dn : (dark, bright)

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    sensor: Sensor = field(default_factory=lambda: preset("generic-2005"))
    widths_px: tuple[float, ...] = tuple(round(2.75 + 0.05 * i, 2) for i in range(11))
    nominal_px: float = 3.0
    angle_deg: float = 6.0
    shape: tuple[int, int] = (60, 40)
    pulse_dn: tuple[float, float] = (100.0, 1200.0)

    def __post_init__(self) -> None:
        require_types(self)
        require_once(widths_px=self.widths_px)
        if not self.widths_px or min(*self.widths_px, self.nominal_px) <= 0:
            raise OptionError(
                f"widths_px are {self.widths_px} and nominal_px is {self.nominal_px:g}: there has "
                "to be a width, all above 0"
            )


def study_width(
    options: WidthOptions | None = None, execution: Execution | None = None
) -> StudyResult:
    """Measure noise-free pulses whose stated and true widths differ, by both estimators.

    Parameters
    ----------
    options : WidthOptions, optional
    execution : Execution, optional

    Returns
    -------
    StudyResult
        Table "width" has a row for each pulse: MTF at 0.3, 0.4 and 0.5 c/px by both
        estimators, the closed form of the ratio, and the width our joint fit found. "curves"
        has the MTF of every pulse, a row for each frequency.
    """
    chosen = chosen_options(options, WidthOptions)
    how = chosen_options(execution, Execution)
    widths_px = chosen.widths_px
    if chosen.nominal_px not in widths_px:
        widths_px = tuple(sorted((*widths_px, chosen.nominal_px)))
    trials = [WidthTrial(error, width) for error in ("measured", "true") for width in widths_px]
    records = run_trials("width", chosen, trials, measure_width_trial, how)
    table = Table.of_rows(
        _row(chosen, trial, record) for trial, record in zip(trials, records, strict=True)
    )
    curves: dict[str, list[float]] = {"freq_cpp": list(WIDTH_FREQ_CPP), "truth": _truth(chosen)}
    for trial, record in zip(trials, records, strict=True):
        for name in ESTIMATORS:
            curves[f"{name}_{trial.error}_{trial.width_px:g}"] = record[name]
    return StudyResult(
        "width", "Width of the pulse and the MTF", chosen, how.seed,
        {"width": table, "curves": Table(curves)}, _findings(table),
    )  # fmt: skip


def measure_width_trial(
    options: WidthOptions, trial: WidthTrial, rng: np.random.Generator
) -> Record:
    """One noise-free pulse by both estimators: curves to Nyquist, and the fitted width."""
    del rng
    true_px, stated_px = trial.widths_px(options.nominal_px)
    dark, bright = options.pulse_dn
    image, _ = pulse(
        options.sensor, width_px=true_px, angle_deg=options.angle_deg, shape=options.shape,
        dark=dark, bright=bright,
    )  # fmt: skip
    published = measure_published_pulse(image, width_px=stated_px)
    ours = measure_pulse(image, width_px=stated_px)
    assert ours.width_px is not None
    return {
        "published": published.response.mtf(WIDTH_FREQ_CPP).value.tolist(),
        "ours": ours.mtf(WIDTH_FREQ_CPP).value.tolist(),
        "ours_width_px": ours.width_px.value,
        "ours_width_std_px": ours.width_px.std,
    }


def _truth(options: WidthOptions) -> list[float]:
    truth: list[float] = options.sensor.mtf(options.angle_deg)(WIDTH_FREQ_CPP).value.tolist()
    return truth


def _row(options: WidthOptions, trial: WidthTrial, record: Record) -> dict[str, float | str]:
    true_px, stated_px = trial.widths_px(options.nominal_px)
    gain = width_error_gain(true_px, stated_px, _REPORTED_CPP)
    row: dict[str, float | str] = {
        "error": trial.error,
        "true_px": true_px,
        "stated_px": stated_px,
        "ours_width_px": record["ours_width_px"],
        "ours_width_std_px": record["ours_width_std_px"],
    }
    truth = _truth(options)
    for freq, one in zip(_REPORTED_CPP, gain.tolist(), strict=True):
        at = round(freq / FREQ_CPP[1])
        row |= {
            f"truth_{freq:g}": truth[at],
            f"published_{freq:g}": record["published"][at],
            f"ours_{freq:g}": record["ours"][at],
            f"ratio_gain_{freq:g}": one,
        }
    return row


def _findings(table: Table) -> tuple[Finding, ...]:
    found = []
    for error in ("measured", "true"):
        rows = table.where(error=error)
        nominal = int(np.argmin(np.abs(rows["true_px"] - rows["stated_px"])))
        for freq in _REPORTED_CPP:
            value = rows[f"published_{freq:g}"]
            change = 100 * (value / value[nominal] - 1)
            found.append(
                Finding(
                    f"published_{error}_{freq:g}_percent",
                    float(np.max(np.abs(change))),
                    f"{_WORDS[error]} width: the published MTF at {freq:g} c/px changes by "
                    f"{_per_cent(change.min())} to {_per_cent(change.max())} %",
                )
            )
    off = float(np.max(np.abs(table["ours_width_px"] - table["true_px"])))
    worst = max(
        float(np.max(np.abs(table[f"ours_{f:g}"] - table[f"truth_{f:g}"]))) for f in _REPORTED_CPP
    )
    found += [
        Finding("ours_width_px", off, f"our joint fit finds the true width to {off:.4f} px"),
        Finding("ours_worst", worst, f"and the MTF at these frequencies to {worst:.5f}"),
    ]
    return tuple(found)


def _per_cent(change: float) -> str:
    """A change in words: at a zero of the pulse's spectrum the published ratio has no bounds."""
    return f"{change:+.1f}" if change < _LARGE_PERCENT else f"more than +{_LARGE_PERCENT:.0f}"
