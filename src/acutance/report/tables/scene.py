"""A scene in tables: what became of its edges, and what its objects are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.report.html import Table

if TYPE_CHECKING:
    from acutance.scan import SceneMeasurement

__all__ = ["scene_tables"]

VERDICTS = {
    "good": "measured, and used",
    "usable": "measured, and used: the intervals allow for what was found",
    "doubtful": "measured, not used: something beside the edge may bias it",
    "invalid": "measured, not used: the numbers are not the sensor's",
    "rejected": "not measured",
}
_REASONS = 8
_WORDS = 12
"""Of a reason, as many words tell it from others."""


def scene_tables(measurement: SceneMeasurement) -> tuple[Table, ...]:
    """Edges by verdict, the shares of the objects, the most frequent reasons."""
    return _edges_table(measurement), _objects_table(measurement), _reasons_table(measurement)


def _edges_table(measurement: SceneMeasurement) -> Table:
    edges = measurement.edges
    rows = []
    for word, meaning in VERDICTS.items():
        own = edges.verdict == word
        if own.any():
            snr = edges.snr[own & np.isfinite(edges.snr)]
            rows.append((
                word, str(int(own.sum())), f"{np.median(edges.length_px[own]):.0f}",
                f"{np.median(snr):.0f}" if snr.size else "", meaning,
            ))  # fmt: skip
    return Table(
        ("verdict", "edges", "length / px", "SNR", "meaning"), tuple(rows), "lrrrl",
        title="Edges of the scene",
        notes=(f"{edges.size} were found, {int(edges.used.sum())} are used. Medians.",),
    )  # fmt: skip


def _objects_table(measurement: SceneMeasurement) -> Table:
    rows = tuple(
        (_object_words(name), f"{100 * share.value:.1f} ± {100 * share.std:.1f}")
        for name, share in measurement.objects.items()
    )
    return Table(
        ("objects", "share / %"), rows, "lr", title="Objects",
        notes=("How soft the borders are on the ground, found together with the sensor.",),
    )  # fmt: skip


def _object_words(name: str) -> str:
    if name.startswith("soft "):
        return f"soft, about {name.removeprefix('soft ')}"
    return {"ideal": "ideal: as sharp as the sensor shows", "strange": "neither"}[name]


def _reasons_table(measurement: SceneMeasurement) -> Table:
    edges = measurement.edges
    short = [" ".join(one.split()[:_WORDS]) for one in edges.reason[~edges.used].tolist()]
    words, counts = np.unique(short, return_counts=True)
    order = np.argsort(-counts, kind="stable")[:_REASONS]
    rows = tuple((f"{words[i]} …", str(int(counts[i]))) for i in order)
    return Table(
        ("why edges are not used", "edges"), rows, "lr", title="Edges left out", page_only=True
    )
