"""The studies by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from acutance.errors import OptionError
from acutance.studies.angle import AngleOptions, study_angle
from acutance.studies.ground_noise import GroundNoiseOptions, study_ground_noise
from acutance.studies.result import StudyResult
from acutance.studies.snr import SnrOptions, study_snr
from acutance.studies.trials import Execution
from acutance.studies.width import WidthOptions, study_width
from acutance.studies.width_correction import WidthCorrectionOptions, study_width_correction

__all__ = ["STUDIES", "Study", "run_study"]


@dataclass(frozen=True)
class Study:
    """One study.

    Parameters
    ----------
    options : type
        Frozen dataclass with the paper's parameters as defaults.
    run : function of (options, execution)
    """

    options: type[Any]
    run: Callable[[Any, Execution | None], StudyResult]


STUDIES: dict[str, Study] = {
    "snr": Study(SnrOptions, study_snr),
    "ground-noise": Study(GroundNoiseOptions, study_ground_noise),
    "angle": Study(AngleOptions, study_angle),
    "width": Study(WidthOptions, study_width),
    "width-correction": Study(WidthCorrectionOptions, study_width_correction),
}


def run_study(name: str, options: Any = None, execution: Execution | None = None) -> StudyResult:
    """Run a study by its name.

    Parameters
    ----------
    name : {"snr", "ground-noise", "angle", "width", "width-correction"}
    options : frozen dataclass, optional
        Of the study's own kind; the paper's parameters unless given.
    execution : Execution, optional
        Seed, processes, folder and progress.

    Raises
    ------
    OptionError
        If there is no such study, or the options are another's.
    """
    if isinstance(name, str) and name == "plan":
        raise OptionError("a plan has functions of its own: plan_target and plan_mirrors")
    if not isinstance(name, str) or name not in STUDIES:
        raise OptionError(f"there is no study {name!r}: the studies are {', '.join(STUDIES)}")
    study = STUDIES[name]
    if options is not None and not isinstance(options, study.options):
        raise OptionError(
            f"options are {type(options).__name__}: the study {name} takes {study.options.__name__}"
        )
    return study.run(options, execution)
