"""The studies, run with their default sizes when the pages are built."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from textwrap import fill

from matplotlib.figure import Figure

from acutance.report import study_figure, study_text
from acutance.studies import STUDIES, StudyResult, run_study

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


FIGURES: dict[str, Callable[[], Figure]] = {
    f"study-{name}": partial(_figure, name) for name in STUDIES
}
TEXTS: dict[str, Callable[[], str]] = {
    f"study-{name}.inc": partial(_text, name) for name in STUDIES
}
