"""Detecting and correcting a wrong pulse width (Figures 3.20-3.23, Table 3.3)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from acutance.arguments import require_types
from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.errors import OptionError, TargetError
from acutance.optics import Detector, Gaussian, Sensor
from acutance.simulate import pulse
from acutance.studies.result import Finding, StudyResult, printed_for
from acutance.studies.scatter import require_once
from acutance.studies.table import Cell, Table
from acutance.studies.targets import ESTIMATORS, measure_published_pulse
from acutance.studies.trials import Execution, Record, run_trials
from acutance.studies.width import WIDTH_FREQ_CPP
from acutance.targets.options import chosen_options
from acutance.targets.straight import measure_pulse
from acutance.targets.straight.pulse_spectrum import width_error_gain
from acutance.targets.straight.pulse_width import smoothest_width

__all__ = ["TABLE_3_3", "WidthCase", "WidthCorrectionOptions", "study_width_correction"]


@dataclass(frozen=True)
class WidthCase:
    """One image of QuickBird's blue band as the paper reports it.

    Parameters
    ----------
    date : str
    stated_m, corrected_m : float
        Width of the tarp before and after the correction; the simulated tarp has the second.
    original_mtf, corrected_mtf : float
        Printed MTF at Nyquist; the simulated sensor has the second.
    percent : float
        Printed change.
    snr : float
    """

    date: str
    stated_m: float
    corrected_m: float
    original_mtf: float
    corrected_mtf: float
    percent: float
    snr: float


TABLE_3_3 = (
    WidthCase("2002-07-20", 8.77, 8.85, 0.3333, 0.3399, 1.98, 62.2),
    WidthCase("2002-09-07", 8.83, 8.95, 0.3687, 0.3809, 3.30, 95.8),
)
"""The two rows of Table 3.3, with the widths and SNRs of their images."""


@dataclass(frozen=True)
class WidthCorrectionOptions:
    """The two images of Table 3.3, simulated with the corrected width as the true one.

    Parameters
    ----------
    cases : tuple of WidthCase
    draws : int
        Noisy images a case.
    gsd_m, angle_deg : float
    shape : (rows, cols)

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    cases: tuple[WidthCase, ...] = TABLE_3_3
    draws: int = 100
    gsd_m: float = 2.8
    angle_deg: float = 6.0
    shape: tuple[int, int] = (40, 36)

    def __post_init__(self) -> None:
        require_types(self)
        require_once(cases=[case.date for case in self.cases])
        if not self.cases or self.draws < 1:
            raise OptionError(
                f"there are {len(self.cases)} cases and {self.draws} draws: at least one of each"
            )


def study_width_correction(
    options: WidthCorrectionOptions | None = None, execution: Execution | None = None
) -> StudyResult:
    """Correct a wrong width by the smoothness of the ratio, and by the joint fit.

    Parameters
    ----------
    options : WidthCorrectionOptions, optional
    execution : Execution, optional

    Returns
    -------
    StudyResult
        Table "width-correction" has a row for each case: the MTF at Nyquist of the closed form and
        of the paper, and mean and scatter of width and MTF by both estimators. "trials"
        has every image; "curves" the MTF of an image of each case without noise, with the
        stated width and after both corrections.
    """
    chosen = chosen_options(options, WidthCorrectionOptions)
    how = chosen_options(execution, Execution)
    trials = [(case, case.snr) for case in chosen.cases for _ in range(chosen.draws)]
    trials += [(case, math.inf) for case in chosen.cases]
    records = run_trials("width-correction", chosen, trials, measure_correction_trial, how)
    noisy = len(trials) - len(chosen.cases)
    measured = Table.of_rows(
        {"date": case.date, **{name: record[name] for name in _NUMBERS}}
        for (case, _), record in zip(trials[:noisy], records[:noisy], strict=True)
    )
    table = Table.of_rows(
        _row(chosen, case, measured.where(date=case.date)) for case in chosen.cases
    )
    curves: dict[str, list[float]] = {"freq_cpp": list(WIDTH_FREQ_CPP)}
    for case, record in zip(chosen.cases, records[noisy:], strict=True):
        for name in ("truth", "stated", "smoothed", "ours"):
            curves[f"{name}_{case.date}"] = record[f"{name}_curve"]
    return StudyResult(
        "width-correction", "Detecting and correcting a wrong pulse width", chosen, how.seed,
        {"width-correction": table, "trials": measured, "curves": Table(curves)},
        _findings(chosen, table),
    )  # fmt: skip


_NUMBERS = (
    "published_width_px", "ours_width_px", "ours_width_std_px", "stated_mtf_nyquist",
    "published_mtf_nyquist", "ours_mtf_nyquist", "ours_mtf_nyquist_std",
)  # fmt: skip


def sensor_of(mtf_nyquist: float, gsd_m: float) -> Sensor:
    """A Gaussian and a pixel with a given MTF at Nyquist.

    Parameters
    ----------
    mtf_nyquist : float
        Below .637, that of the pixel alone.
    gsd_m : float
    """
    pixel = math.sin(math.pi * NYQUIST_CPP) / (math.pi * NYQUIST_CPP)
    if not 0 < mtf_nyquist < pixel:
        raise OptionError(
            f"an MTF at Nyquist of {mtf_nyquist:g}: it has to be above 0 and below the pixel's "
            f"own {pixel:.3f}"
        )
    sigma = math.sqrt(math.log(pixel / mtf_nyquist) / 2) / (math.pi * NYQUIST_CPP)
    return Sensor([Gaussian(sigma), Detector()], gsd_m=gsd_m)


def measure_correction_trial(
    options: WidthCorrectionOptions, trial: tuple[WidthCase, float], rng: np.random.Generator
) -> Record:
    """One image with the stated width, corrected both ways; without noise the curves as well."""
    case, snr = trial
    sensor = sensor_of(case.corrected_mtf, options.gsd_m)
    stated_px, true_px = case.stated_m / options.gsd_m, case.corrected_m / options.gsd_m
    quiet = math.isinf(snr)
    image, truth = pulse(
        sensor, width_px=true_px, angle_deg=options.angle_deg, shape=options.shape,
        offset_px=0.0 if quiet else float(rng.uniform(-0.5, 0.5)),
        snr=None if quiet else snr, rng=rng,
    )  # fmt: skip
    record: Record = dict.fromkeys(_NUMBERS, math.nan)
    try:
        # The fourth degree and the normal: without the biases that are no fault of the width.
        stated = measure_published_pulse(image, width_px=stated_px, order=4, distance="normal")
        found_px = smoothest_width(stated).chosen_px
        smoothed = measure_published_pulse(image, width_px=found_px, order=4, distance="normal")
        ours = measure_pulse(image, width_px=stated_px)
    except TargetError:
        if quiet:
            raise
        return record
    assert ours.width_px is not None
    record |= {
        "published_width_px": found_px,
        "ours_width_px": ours.width_px.value,
        "ours_width_std_px": ours.width_px.std,
        "stated_mtf_nyquist": stated.response.mtf_nyquist.value,
        "published_mtf_nyquist": smoothed.response.mtf_nyquist.value,
        "ours_mtf_nyquist": ours.mtf_nyquist.value,
        "ours_mtf_nyquist_std": ours.mtf_nyquist.std,
    }
    if quiet:
        curves = {
            "truth": truth.mtf, "stated": stated.response.mtf,
            "smoothed": smoothed.response.mtf, "ours": ours.mtf,
        }  # fmt: skip
        for name, mtf in curves.items():
            record[f"{name}_curve"] = mtf(WIDTH_FREQ_CPP).value.tolist()
    return record


def _row(options: WidthCorrectionOptions, case: WidthCase, measured: Table) -> dict[str, Cell]:
    stated_px, true_px = case.stated_m / options.gsd_m, case.corrected_m / options.gsd_m
    gain = float(width_error_gain(stated_px, true_px, NYQUIST_CPP))
    row: dict[str, Cell] = {
        "date": case.date,
        "stated_m": case.stated_m,
        "true_m": case.corrected_m,
        "printed_percent": case.percent,
        "closed_form_percent": 100 * (gain - 1),
        "printed_mtf_nyquist": case.original_mtf,
        "printed_corrected_mtf_nyquist": case.corrected_mtf,
        "closed_form_mtf_nyquist": case.original_mtf * gain,
        "stated_mtf_nyquist": float(np.nanmean(measured["stated_mtf_nyquist"])),
    }
    for name in ESTIMATORS:
        width = measured[f"{name}_width_px"] * options.gsd_m
        mtf = measured[f"{name}_mtf_nyquist"]
        row |= {
            f"{name}_width_m": float(np.nanmean(width)),
            f"{name}_width_std_m": _scatter(width),
            f"{name}_mtf_nyquist": float(np.nanmean(mtf)),
            f"{name}_mtf_nyquist_std": _scatter(mtf),
        }
    stated = np.abs(measured["ours_width_px"] - stated_px) / measured["ours_width_std_px"]
    row["ours_stated_width_std_m"] = options.gsd_m * float(
        np.nanmean(measured["ours_width_std_px"])
    )
    row["ours_detected_share"] = float(np.mean(stated > 3))
    return row


def _scatter(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(known.std(ddof=1)) if known.size > 1 else math.nan


def _findings(options: WidthCorrectionOptions, table: Table) -> tuple[Finding, ...]:
    found = []
    for case, row in zip(options.cases, table.rows(), strict=True):
        change = float(row["closed_form_percent"])
        found.append(
            Finding(
                f"correction_{case.date}_percent",
                change,
                f"{case.date}: {case.stated_m:g} to {case.corrected_m:g} m changes the MTF at "
                f"Nyquist by {change:+.2f} %",
                printed_for(options, case.percent, ("cases", "draws", "angle_deg", "shape")),
            )
        )
        for name, words in (("published", "the smoothest curve"), ("ours", "the joint fit")):
            width, std = float(row[f"{name}_width_m"]), float(row[f"{name}_width_std_m"])
            scatter = f" ± {std:.3f}" if math.isfinite(std) else ""
            found.append(
                Finding(
                    f"{name}_width_{case.date}_m",
                    width,
                    f"{case.date}: {words} finds {width:.3f}{scatter} m at SNR {case.snr:g}",
                    case.corrected_m,
                )
            )
        share = float(row["ours_detected_share"])
        found.append(
            Finding(
                f"detected_{case.date}",
                share,
                f"{case.date}: the joint fit contradicts the stated width by more than three "
                f"standard deviations in {100 * share:.0f} % of the images",
            )
        )
    return tuple(found)
