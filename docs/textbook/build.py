"""Write everything the pages include."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from acutance.report import save_figure
from acutance.report.paper import styled
from textbook import (
    benchmarks,
    biresolution_figures,
    combine_figures,
    edge_figures,
    method_figures,
    plane_figures,
    point_figures,
    reference,
    star_figures,
    study_figures,
    tables,
)

__all__ = ["write_all"]

FIGURES: dict[str, Callable[[], Figure]] = {
    "pixel-grid": plane_figures.pixel_grid,
    "metrics": plane_figures.metrics_on_curves,
    "edge-curves": edge_figures.measured_and_truth,
    "tail-and-support": edge_figures.what_truncation_does,
    "prior-directions": edge_figures.prior_directions,
    "step-gains": method_figures.gains_of_steps,
    "method-errors": method_figures.errors_of_methods,
    "reference-systems": plane_figures.reference_systems,
    **biresolution_figures.FIGURES,
    **combine_figures.FIGURES,
    **point_figures.FIGURES,
    **star_figures.FIGURES,
    **study_figures.FIGURES,
}

TEXTS: dict[str, Callable[[], str]] = {
    "closed-forms.inc": tables.closed_forms,
    "slices.inc": tables.slices,
    "phases.inc": tables.phases,
    "phase-error.inc": tables.phase_error,
    "row-distances.inc": tables.row_distances,
    "checks.inc": tables.checks,
    "questions.inc": tables.questions,
    **{
        f"questions-{kind}.inc": tables.questions_of(kind)
        for kind in ("pulse", "points", "biresolution", "bars", "star", "combined")
    },
    "methods.inc": tables.methods,
    "blocks.inc": tables.blocks,
    "systems.inc": tables.systems,
    "sites.inc": tables.sites,
    "calls.inc": reference.called_names,
    "results.inc": reference.result_names,
    "other-names.inc": reference.other_names,
    **reference.help_texts(),
    **study_figures.TEXTS,
}


def write_all(folder: Path) -> None:
    """Write figures, tables, help texts, the API's pages and the benchmarks' pages."""
    folder.mkdir(exist_ok=True)
    _forget_old_pages(folder)
    for name, text in TEXTS.items():
        _write(folder / name, text())
    for name, text in reference.package_pages().items():
        _write(folder / f"{name}.rst", text)
    for name, text in benchmarks.pages(folder.parent / "benchmarks").items():
        _write(folder / f"benchmark-{name}.rst", text)
    for name, draw in FIGURES.items():
        with styled():
            figure = draw()
        save_figure(figure, folder / f"{name}.svg")


def _forget_old_pages(folder: Path) -> None:
    """Delete pages of an earlier build about what is no longer there."""
    current = reference.object_pages()
    old = [page for page in folder.glob("api/*.rst") if page.name not in current]
    for page in [*old, *folder.glob("benchmark-*.rst"), *folder.glob("acutance.*.rst")]:
        page.unlink()


def _write(path: Path, text: str) -> None:
    """Write a file only if its text changes, so that unchanged pages are not built again."""
    if not path.is_file() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
