"""Studies that characterise targets and estimators, and plans of targets."""

from acutance.studies.angle import AngleOptions, study_angle
from acutance.studies.bound import Design, MetricBound, equivalent_blur, free_bound, shape_bound
from acutance.studies.catalogue import STUDIES, Study, run_study
from acutance.studies.ground_noise import GroundNoiseOptions, study_ground_noise
from acutance.studies.mirror_layout import MirrorLayout, lay_out_mirrors
from acutance.studies.mirrors import MirrorPlan, MirrorPlanOptions, plan_mirrors
from acutance.studies.plan import plan_target
from acutance.studies.plan_options import PlanOptions
from acutance.studies.result import Finding, StudyResult
from acutance.studies.scatter import minimum_snr
from acutance.studies.snr import SnrOptions, study_snr
from acutance.studies.table import Table
from acutance.studies.trials import Execution, run_trials
from acutance.studies.width import WidthOptions, study_width
from acutance.studies.width_correction import (
    TABLE_3_3,
    WidthCase,
    WidthCorrectionOptions,
    study_width_correction,
)

__all__ = [
    "STUDIES",
    "TABLE_3_3",
    "AngleOptions",
    "Design",
    "Execution",
    "Finding",
    "GroundNoiseOptions",
    "MetricBound",
    "MirrorLayout",
    "MirrorPlan",
    "MirrorPlanOptions",
    "PlanOptions",
    "SnrOptions",
    "Study",
    "StudyResult",
    "Table",
    "WidthCase",
    "WidthCorrectionOptions",
    "WidthOptions",
    "equivalent_blur",
    "free_bound",
    "lay_out_mirrors",
    "minimum_snr",
    "plan_mirrors",
    "plan_target",
    "run_study",
    "run_trials",
    "shape_bound",
    "study_angle",
    "study_ground_noise",
    "study_snr",
    "study_width",
    "study_width_correction",
]
