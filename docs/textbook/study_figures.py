"""The studies, run with their default sizes when the pages are built."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from textwrap import fill

from matplotlib.figure import Figure

from acutance.report import study_figure, study_text
from acutance.report.studies.study import plan_text
from acutance.studies import STUDIES, PlanOptions, StudyResult, plan_target, run_study

__all__ = ["FIGURES", "TEXTS"]


@cache
def _result(name: str) -> StudyResult:
    return run_study(name)


def _figure(name: str) -> Figure:
    return study_figure(_result(name))


def _text(name: str) -> str:
    lines = study_text(_result(name)).splitlines()
    wrapped = (fill(line, 92, subsequent_indent="      ") for line in lines)
    return "\n".join(wrapped) + "\n"


@cache
def _plan() -> StudyResult:
    return plan_target(PlanOptions(target="pulse", snr=70.0, draws=60))


def _plan_figure() -> Figure:
    return study_figure(_plan())


def _plan_text() -> str:
    return plan_text(_plan()) + "\n"


FIGURES: dict[str, Callable[[], Figure]] = {
    **{f"study-{name}": partial(_figure, name) for name in STUDIES},
    "study-plan": _plan_figure,
}
TEXTS: dict[str, Callable[[], str]] = {
    **{f"study-{name}.inc": partial(_text, name) for name in STUDIES},
    "study-plan.inc": _plan_text,
}
