"""Uneven ground: how large a contrast a pulse needs (Table 3.2, Figure 3.11)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from acutance.arguments import require_types
from acutance.errors import OptionError
from acutance.optics import Sensor, preset
from acutance.simulate import GroundNoise, pulse
from acutance.studies.result import Finding, StudyResult, printed_for
from acutance.studies.scatter import (
    error_columns,
    find_minimum,
    find_refusal,
    require_limit,
    require_once,
)
from acutance.studies.table import Cell, Table
from acutance.studies.targets import ESTIMATOR_WORDS, ESTIMATORS, Estimator, measure_both_pulses
from acutance.studies.trials import Execution, Record, run_trials
from acutance.targets.options import chosen_options

__all__ = ["GroundNoiseOptions", "study_ground_noise"]

LEVELS_DN = (
    (1100.0, 400.0), (1000.0, 500.0), (950.0, 550.0), (900.0, 600.0), (850.0, 650.0),
    (825.0, 675.0), (800.0, 700.0), (790.0, 710.0), (780.0, 720.0), (775.0, 725.0),
    (770.0, 730.0),
)  # fmt: skip
"""Table 3.2: level of the pulse and of the ground."""

_PUBLISHED_MINIMUM = 50.0
_PUBLISHED_BIAS_PERCENT = -6.0
"""SNR the report requires on such ground, and the bias it finds there (Figure 3.11)."""

_NOT_PRINTED = ("runs", "shape")
"""Options that do not change what the printed numbers mean."""


@dataclass(frozen=True)
class GroundNoiseOptions:
    """The paper's parameters; what it does not print is the image's size.

    Every image has its target somewhere else on the pixel grid.

    Parameters
    ----------
    sensor : Sensor
    levels_dn : tuple of (pulse, ground)
    runs : int
        Images a contrast, each with ground of its own.
    limit_percent : float
        Largest error of the MTF at Nyquist, rms, that is good enough.
    ground : GroundNoise
        Twenty white fields of 1 to 20 sub-pixels, variance 100 each.
    angle_deg, width_px : float
    shape : (rows, cols)

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    sensor: Sensor = field(default_factory=lambda: preset("generic-2005"))
    levels_dn: tuple[tuple[float, float], ...] = LEVELS_DN
    runs: int = 20
    limit_percent: float = 5.0
    ground: GroundNoise = field(default_factory=GroundNoise)
    angle_deg: float = 6.0
    width_px: float = 3.0
    shape: tuple[int, int] = (60, 40)

    def __post_init__(self) -> None:
        require_types(self)
        require_once(levels_dn=self.levels_dn)
        if not self.levels_dn or self.runs < 1:
            raise OptionError(
                f"levels_dn is {self.levels_dn} and runs is {self.runs}: there have to be a "
                "contrast and a run"
            )
        require_limit(self.limit_percent)


def study_ground_noise(
    options: GroundNoiseOptions | None = None, execution: Execution | None = None
) -> StudyResult:
    """Measure a pulse on uneven ground, by both estimators.

    Parameters
    ----------
    options : GroundNoiseOptions, optional
    execution : Execution, optional

    Returns
    -------
    StudyResult
        Table "ground-noise" has a row for each contrast, its SNR by the noise that such ground
        makes in images; "trials" every measurement.
    """
    chosen = chosen_options(options, GroundNoiseOptions)
    how = chosen_options(execution, Execution)
    trials = [levels for levels in chosen.levels_dn for _ in range(chosen.runs)]
    records = run_trials("ground-noise", chosen, trials, measure_ground_trial, how)
    measured = Table.of_rows(
        {"pulse_dn": levels[0], "ground_dn": levels[1], **record}
        for levels, record in zip(trials, records, strict=True)
    )
    noise_dn = chosen.ground.std_seen_by(chosen.sensor)
    table = Table.of_rows(
        _contrast(measured.where(pulse_dn=bright, ground_dn=dark), bright, dark, noise_dn)
        for bright, dark in chosen.levels_dn
    )
    return StudyResult(
        "ground-noise", "Uneven ground and the MTF at Nyquist", chosen, how.seed,
        {"ground-noise": table, "trials": measured}, _findings(chosen, table, measured),
    )  # fmt: skip


def measure_ground_trial(
    options: GroundNoiseOptions, levels: tuple[float, float], rng: np.random.Generator
) -> Record:
    """One image by both estimators, with its true signal and MTF at Nyquist."""
    bright, dark = levels
    image, truth = pulse(
        options.sensor, width_px=options.width_px, angle_deg=options.angle_deg,
        shape=options.shape, dark=dark, bright=bright, offset_px=float(rng.uniform(-0.5, 0.5)),
        ground_noise=options.ground, rng=rng,
    )  # fmt: skip
    found = measure_both_pulses(image, width_px=options.width_px)
    signal_dn = float(truth.prf(0.0)) * abs(bright - dark)
    return {"signal_dn": signal_dn, "truth": truth.mtf_nyquist.value, **found}


def _contrast(measured: Table, bright: float, dark: float, noise_dn: float) -> dict[str, Cell]:
    truth = float(measured["truth"][0])
    row: dict[str, Cell] = {
        "pulse_dn": bright,
        "ground_dn": dark,
        "difference_dn": bright - dark,
        "snr": float(measured["signal_dn"][0]) / noise_dn,
        "truth": truth,
    }
    for name in ESTIMATORS:
        row |= error_columns(name, measured[f"{name}_mtf_nyquist"], truth)
    return row


def _findings(options: GroundNoiseOptions, table: Table, trials: Table) -> tuple[Finding, ...]:
    noise_dn = options.ground.std_seen_by(options.sensor)
    highest_snr = float(table["snr"].max())
    found = [
        Finding(
            "highest_snr",
            highest_snr,
            f"ground that varies by {options.ground.std:.1f} DN makes a noise of {noise_dn:.1f} DN "
            f"in images, so the highest contrast has an SNR of {highest_snr:.0f}",
        )
    ]
    minimum = printed_for(options, _PUBLISHED_MINIMUM, ("levels_dn", *_NOT_PRINTED))
    for name in ESTIMATORS:
        who, limit = ESTIMATOR_WORDS[name], options.limit_percent
        found += find_refusal(name, who, table, trials)
        found += find_minimum(
            f"minimum_snr_{name}", f"{who}: an rms error below {limit:g} %", table,
            f"{name}_rms_percent", limit, minimum if name == "published" else None,
        )  # fmt: skip
        found += find_minimum(
            f"minimum_snr_scatter_{name}",
            f"{who}: a scatter below {limit:g} %, whatever the bias,", table,
            f"{name}_std_percent", limit,
        )  # fmt: skip
        found += _bias(options, name, table)
    return tuple(found)


def _bias(options: GroundNoiseOptions, name: Estimator, table: Table) -> tuple[Finding, ...]:
    """The bias at the highest contrast; nothing where the estimator refused it."""
    highest = int(np.argmax(table["snr"]))
    bias = float(table[f"{name}_bias_percent"][highest])
    if math.isnan(bias):
        return ()
    # Of images that the estimator refused there is no error.
    measured = options.runs - int(table[f"{name}_refused"][highest])
    known = float(table[f"{name}_std_percent"][highest]) / math.sqrt(measured)
    scatter = f" ± {known:.1f}" if math.isfinite(known) else ""
    printed = printed_for(options, _PUBLISHED_BIAS_PERCENT, ("limit_percent", *_NOT_PRINTED))
    return (
        Finding(
            f"bias_{name}_percent",
            bias,
            f"{ESTIMATOR_WORDS[name]}: a bias of {bias:+.1f}{scatter} % at the highest contrast",
            printed if name == "published" else None,
        ),
    )
