"""Faces of an MTF budget: text, JSON document and figure."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.arguments import require_class
from acutance.report.paper import INK, PALETTE, new_page, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from acutance.optics import Budget, Sensor

__all__ = ["budget_document", "budget_figure", "budget_text", "sensor_document"]


def sensor_document(sensor: Sensor) -> dict[str, Any]:
    """A sensor's GSD and blocks with their parameters, for JSON."""
    require_class("Sensor", sensor=sensor)
    blocks = [{"block": type(one).__name__, **asdict(one)} for one in sensor.blocks]  # type: ignore[call-overload]
    return {"gsd_m": sensor.gsd_m, "gsd_along_m": sensor.gsd_along_m, "blocks": blocks}


def budget_document(budget: Budget) -> dict[str, Any]:
    """The document ``acutance/budget/1``: every block's MTF at one frequency, and the whole."""
    require_class("Budget", budget=budget)
    return {
        "schema": "acutance/budget/1",
        "freq_cpp": budget.freq_cpp,
        "freq_cpm": None if budget.freq_cpm is None else list(budget.freq_cpm),
        "sensor": sensor_document(budget.sensor),
        "rows": [
            {
                "block": type(row.block).__name__,
                "description": row.description,
                "across": row.across,
                "along": row.along,
                "formula": row.formula,
                "source": row.source,
            }
            for row in budget.rows
        ],
        "total": {"across": budget.across, "along": budget.along},
    }


def budget_text(budget: Budget) -> str:
    """A budget as a table for the terminal: one block a line, the whole below."""
    require_class("Budget", budget=budget)
    metres = "" if budget.freq_cpm is None else _in_metres(budget)
    lines = [f"MTF at {budget.freq_cpp:g} cycles per pixel{metres}", ""]
    width = max(len(row.description) for row in budget.rows)
    lines.append(f"{'block':<{width}}  across   along  formula; source")
    for row in budget.rows:
        words = "; ".join(word for word in (row.formula, row.source) if word)
        line = f"{row.description:<{width}}  {row.across:.4f}  {row.along:.4f}  {words}"
        lines.append(line.rstrip())
    lines.append(f"{'all':<{width}}  {budget.across:.4f}  {budget.along:.4f}")
    return "\n".join(lines)


def _in_metres(budget: Budget) -> str:
    across, along = budget.freq_cpm or (0.0, 0.0)
    if across == along:
        return f" ({across:.4g} cycles per metre)"
    return f" ({across:.4g} cycles per metre across, {along:.4g} along)"


def budget_figure(budget: Budget) -> Figure:
    """Curves of every block and of the whole, across and along, up to 1 cycle per pixel."""
    require_class("Budget", budget=budget)
    with styled():
        page = new_page(9.0, 4.6)
        panels = page.subplots(1, 2, sharey=True)
        _draw(panels[0], budget, "across")
        _draw(panels[1], budget, "along")
        panels[0].set_ylabel("MTF")
        handles, labels = panels[0].get_legend_handles_labels()
        page.legend(handles, labels, loc="outside lower center", ncols=2)
    return page


def _draw(axes: Axes, budget: Budget, direction: str) -> None:
    from acutance.optics import Sensor

    freq, still = np.linspace(0.0, 1.0, 201), np.zeros(201)
    u, v = (freq, still) if direction == "across" else (still, freq)
    for i, row in enumerate(budget.rows):
        curve = np.abs(Sensor([row.block]).otf(u, v))
        style = "-" if i < len(PALETTE) else "--"
        axes.plot(
            freq, curve, style, color=PALETTE[i % len(PALETTE)], lw=1.3, label=row.description
        )
    axes.plot(freq, np.abs(budget.sensor.otf(u, v)), color=INK, lw=2.6, label="all")
    whole = budget.across if direction == "across" else budget.along
    axes.plot([budget.freq_cpp], [whole], "o", color=INK)
    # In the title no curve can cross it.
    axes.set_title(f"{direction.capitalize()}: {whole:.4f} at {budget.freq_cpp:g} c/px")
    axes.set_xlabel("Frequency [cycles per pixel]")
    axes.set_xlim(0, 1)
    axes.set_ylim(bottom=0)
