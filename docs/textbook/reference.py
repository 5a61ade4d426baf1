"""Pages of the API, and the commands' own help, from the public names of the package."""

from __future__ import annotations

import importlib
import inspect
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from typer.main import get_command

import acutance
from acutance.cli.app import app
from textbook.rst import heading, list_table

__all__ = [
    "called_names",
    "help_texts",
    "object_pages",
    "other_names",
    "package_pages",
    "result_names",
]

# Pages of the API, the public face of the packages first, then modules worth a page of their own.
PACKAGES = (
    "targets",
    "targets.straight",
    "targets.straight.published",
    "targets.points",
    "targets.pair",
    "targets.periodic",
    "targets.combine",
    "simulate",
    "optics",
    "raster",
    "raster.metadata",
    "report",
    "report.archive",
    "studies",
    "scan",
    "archive",
    "archive.trends",
    "archive.comparisons",
    "archive.published",
    "batch",
    "restoration",
    "execution",
    "curves",
    "curves.metrics",
    "curves.reading",
    "geometry",
    "geometry.angles",
    "targets.kinds",
    "targets.check_table",
    "targets.straight.fit_edge",
    "targets.straight.fit_pulse",
    "targets.straight.pulse_width",
    "targets.points.fit",
    "numerics.noise",
    "numerics.clipping",
    "numerics.repeated_pixels",
    "numerics.jpeg_blocks",
    "numerics.periodic_noise",
    "numerics.normal_equations",
    "numerics.process_modes",
)


CALLS = (
    "measure_edge",
    "measure_edges",
    "each_edge",
    "measure_pulse",
    "measure_pulses",
    "each_pulse",
    "measure_points",
    "measure_bars",
    "measure_star",
    "measure_biresolution",
    "combine",
    "scan_scene",
    "scan_bands",
    "Archive",
    "run_batch",
    "design_restoration",
    "restore",
    "verify_restoration",
    "niirs",
    "open_image",
    "read_statement",
    "sites",
    "Sensor",
    "optics",
    "simulate",
    "report",
)
RESULTS = (
    "Measurement",
    "StraightMeasurement",
    "PointsMeasurement",
    "BarsMeasurement",
    "StarMeasurement",
    "BiresolutionMeasurement",
    "CombinedMeasurement",
    "SceneMeasurement",
    "BandScenes",
    "BatchSummary",
    "ImageStatement",
    "RestorationFilter",
    "RestoredImage",
    "RestorationProof",
    "Niirs",
    "TargetResult",
    "Rejected",
    "Record",
    "Check",
    "Verdict",
    "Estimate",
    "Estimates",
    "Response",
    "Mtf",
    "Esf",
    "Lsf",
)


def called_names() -> str:
    """What is called: measuring, combining, opening, simulating, reporting."""
    return _names(CALLS)


def result_names() -> str:
    """What calls return."""
    return _names(RESULTS)


def other_names() -> str:
    """The other names of ``import acutance as ac``, errors left out."""
    # Errors have a page of their own, and no page of a package.
    listed = {*CALLS, *RESULTS, *acutance.errors.__all__, "errors", "__version__"}
    return _names([name for name in acutance.__all__ if name not in listed])


def _names(names: Sequence[str]) -> str:
    """Names of ``import acutance as ac``, linked to where they are described."""
    rows = []
    for name in names:
        found = getattr(acutance, name)
        if inspect.ismodule(found):
            link = f":doc:`acutance.{name} </generated/acutance.{name}>`"
        else:
            link = f":py:obj:`{name} <{acutance._HOMES[name]}.{name}>`"
        summary = (inspect.getdoc(found) or "").split("\n")[0]
        rows.append([link, summary])
    return list_table(["name", "what it is"], rows, (25, 75))


def package_pages() -> dict[str, str]:
    """A page for each package: its public names, each with a page of its own."""
    pages = {}
    for name in PACKAGES:
        module = importlib.import_module(f"acutance.{name}")
        kinds: dict[str, list[str]] = {"Classes": [], "Functions": [], "Data": []}
        for public in module.__all__:
            found = getattr(module, public)
            kind = "Classes" if inspect.isclass(found) else "Functions"
            kinds[kind if hasattr(found, "__qualname__") else "Data"].append(public)
        summary = (inspect.getdoc(module) or "").strip()
        text = [heading(f"acutance.{name}"), summary, "", f".. currentmodule:: acutance.{name}", ""]
        for kind, names in kinds.items():
            if kind == "Data" or not names:
                continue
            text += [
                heading(kind, "-"),
                ".. autosummary::",
                "   :toctree: api",
                "   :nosignatures:",
            ]
            text += ["", *(f"   {public}" for public in names), ""]
        if kinds["Data"]:
            listed = ", ".join(f"``{public}``" for public in kinds["Data"])
            text += [heading("Data", "-"), listed, ""]
        pages[f"acutance.{name}"] = "\n".join(text)
    return pages


def object_pages() -> set[str]:
    """File names of the pages that describe one class or function each."""
    modules = [importlib.import_module(f"acutance.{name}") for name in PACKAGES]
    return {f"{module.__name__}.{name}.rst" for module in modules for name in module.__all__}


def help_texts() -> dict[str, Callable[[], str]]:
    """``help-NAME.inc`` for every command: "help-acutance.inc", "help-simulate-edge.inc"."""
    return {
        f"help-{'-'.join(words) or 'acutance'}.inc": _help(words)
        for words in _commands(get_command(app), [])
    }


def _commands(command: Any, words: list[str]) -> Iterator[list[str]]:
    """The words that call a command, and those of every command below it."""
    yield words
    for name, inner in getattr(command, "commands", {}).items():
        yield from _commands(inner, [*words, name])


def _help(arguments: list[str]) -> Callable[[], str]:
    def text() -> str:
        code = "from acutance.cli.app import run; run()"
        done = subprocess.run(
            [sys.executable, "-c", code, *arguments, "--help"],
            capture_output=True, text=True, check=True,
            env={**os.environ, "COLUMNS": "88", "NO_COLOR": "1"},
        )  # fmt: skip
        return done.stdout

    return text
