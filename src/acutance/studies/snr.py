"""System noise: how large an SNR an edge and a pulse need (Figure 3.8)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from acutance.arguments import require_types
from acutance.errors import OptionError
from acutance.optics import Sensor, preset
from acutance.simulate import Noise, edge, pulse
from acutance.studies.result import Finding, StudyResult, printed_for
from acutance.studies.scatter import (
    error_columns,
    find_minimum,
    find_refusal,
    require_limit,
    require_once,
)
from acutance.studies.table import Cell, Table
from acutance.studies.targets import (
    ESTIMATOR_WORDS,
    ESTIMATORS,
    Estimator,
    measure_both_edges,
    measure_both_pulses,
)
from acutance.studies.trials import Execution, Record, run_trials
from acutance.targets.options import chosen_options

__all__ = ["SnrOptions", "SnrTrial", "study_snr"]

Target = Literal["edge", "pulse"]
_TARGETS: tuple[Target, ...] = ("edge", "pulse")
_PUBLISHED_MINIMUM = {"edge": 100.0, "pulse": 50.0}
"""SNR the report requires (Figure 3.8)."""

_NOT_PRINTED = ("noise_dn", "draws", "shape", "edge_dn", "pulse_dn")
"""Options that do not change what the printed numbers mean."""

_HIGH_SNR = 200.0
"""From here on the mean error counts as bias."""


@dataclass(frozen=True)
class SnrOptions:
    """The paper's parameters; what it does not print is the image's size.

    The published errors depend on how the samples fall into the windows, so every image has its
    target somewhere else on the pixel grid.

    Parameters
    ----------
    sensor : Sensor
    noise_dn : tuple of float
        Standard deviations of the system noise: 2 to 100 DN.
    draws : int
        Images a level and target; the paper has one.
    limit_percent : float
        Largest error of the MTF at Nyquist, rms, that is good enough.
    angle_deg, width_px : float
    shape : (rows, cols)
    edge_dn, pulse_dn : (dark, bright)

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    sensor: Sensor = field(default_factory=lambda: preset("generic-2005"))
    noise_dn: tuple[float, ...] = tuple(float(sigma) for sigma in range(2, 101))
    draws: int = 10
    limit_percent: float = 5.0
    angle_deg: float = 6.0
    width_px: float = 3.0
    shape: tuple[int, int] = (60, 40)
    edge_dn: tuple[float, float] = (200.0, 1200.0)
    pulse_dn: tuple[float, float] = (100.0, 1200.0)

    def __post_init__(self) -> None:
        require_types(self)
        require_once(noise_dn=self.noise_dn)
        if not self.noise_dn or min(self.noise_dn) <= 0 or self.draws < 1:
            raise OptionError(
                f"there are {len(self.noise_dn)} levels of noise, the least "
                f"{min(self.noise_dn, default=0):g}, and {self.draws} draws: every level has to be "
                "above 0, and there has to be a draw"
            )
        require_limit(self.limit_percent)


@dataclass(frozen=True)
class SnrTrial:
    """One image: of which target, with how much noise."""

    target: Target
    noise_dn: float


def study_snr(options: SnrOptions | None = None, execution: Execution | None = None) -> StudyResult:
    """Measure an edge and a pulse under system noise, by both estimators.

    Parameters
    ----------
    options : SnrOptions, optional
    execution : Execution, optional

    Returns
    -------
    StudyResult
        Table "snr" has a row for each target and noise level; "trials" every measurement.
    """
    chosen = chosen_options(options, SnrOptions)
    how = chosen_options(execution, Execution)
    trials = [
        SnrTrial(target, sigma)
        for target in _TARGETS
        for sigma in chosen.noise_dn
        for _ in range(chosen.draws)
    ]
    records = run_trials("snr", chosen, trials, measure_snr_trial, how)
    measured = Table.of_rows(
        {"target": trial.target, "noise_dn": trial.noise_dn, **record}
        for trial, record in zip(trials, records, strict=True)
    )
    table = Table.of_rows(
        _level(measured.where(target=target, noise_dn=sigma), target, sigma)
        for target in _TARGETS
        for sigma in chosen.noise_dn
    )
    return StudyResult(
        "snr", "System noise and the MTF at Nyquist", chosen, how.seed,
        {"snr": table, "trials": measured}, _findings(chosen, table, measured),
    )  # fmt: skip


def measure_snr_trial(options: SnrOptions, trial: SnrTrial, rng: np.random.Generator) -> Record:
    """One image by both estimators, with its true SNR and MTF at Nyquist."""
    noise, offset = Noise(read=trial.noise_dn), float(rng.uniform(-0.5, 0.5))
    if trial.target == "edge":
        dark, bright = options.edge_dn
        image, truth = edge(
            options.sensor, angle_deg=options.angle_deg, shape=options.shape,
            dark=dark, bright=bright, offset_px=offset, noise=noise, rng=rng,
        )  # fmt: skip
        signal, found = bright - dark, measure_both_edges(image)
        true_mtf = truth.mtf_nyquist.value
    else:
        dark, bright = options.pulse_dn
        image, pulse_truth = pulse(
            options.sensor, width_px=options.width_px, angle_deg=options.angle_deg,
            shape=options.shape, dark=dark, bright=bright, offset_px=offset, noise=noise, rng=rng,
        )  # fmt: skip
        signal = float(pulse_truth.prf(0.0)) * abs(bright - dark)
        found = measure_both_pulses(image, width_px=options.width_px)
        true_mtf = pulse_truth.mtf_nyquist.value
    return {"snr": signal / trial.noise_dn, "truth": true_mtf, **found}


def _level(measured: Table, target: Target, sigma: float) -> dict[str, Cell]:
    truth = float(measured["truth"][0])
    row: dict[str, Cell] = {
        "target": target,
        "noise_dn": sigma,
        "snr": float(measured["snr"][0]),
        "truth": truth,
    }
    for name in ESTIMATORS:
        row |= error_columns(name, measured[f"{name}_mtf_nyquist"], truth)
    stated = measured["ours_mtf_nyquist_std"]
    known = stated[np.isfinite(stated)]
    row["ours_stated_percent"] = float(100 * known.mean() / truth) if known.size else float("nan")
    return row


def _findings(options: SnrOptions, table: Table, trials: Table) -> tuple[Finding, ...]:
    found: list[Finding] = []
    for target in _TARGETS:
        for name in ESTIMATORS:
            found += _answers(
                options, target, name, table.where(target=target), trials.where(target=target)
            )
    return tuple(found)


def _answers(
    options: SnrOptions, target: Target, name: Estimator, rows: Table, trials: Table
) -> Iterator[Finding]:
    """What one estimator needs on one target, or why there is no answer."""
    who, limit = f"{target}, {ESTIMATOR_WORDS[name]}", options.limit_percent
    printed = printed_for(options, _PUBLISHED_MINIMUM[target], _NOT_PRINTED)
    for refused in find_refusal(name, who, rows, trials):
        yield replace(refused, name=f"refused_{target}_{name}")
    yield from find_minimum(
        f"minimum_snr_{target}_{name}", f"{who}: an rms error below {limit:g} %", rows,
        f"{name}_rms_percent", limit, printed if name == "published" else None,
    )  # fmt: skip
    yield from find_minimum(
        f"minimum_snr_scatter_{target}_{name}",
        f"{who}: a scatter below {limit:g} %, whatever the bias,", rows,
        f"{name}_std_percent", limit,
    )  # fmt: skip
    highest = float(rows["snr"].max())
    quiet = rows["snr"] >= min(_HIGH_SNR, highest)
    where = "high SNR" if highest >= _HIGH_SNR else f"the highest SNR that was tried, {highest:.0f}"
    biases = rows[f"{name}_bias_percent"][quiet]
    if np.isfinite(biases).any():
        bias = float(np.nanmean(biases))
        yield Finding(
            f"bias_{target}_{name}_percent", bias, f"{who}: a bias of {bias:+.1f} % at {where}"
        )
