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
_OBJECTS = {
    "ideal": "ideal: as sharp as the sensor shows",
    "soft": "soft",
    "strange": "neither",
}
_REASONS = 8
_WORDS = 12
"""Of a reason, as many words tell it from others."""


def scene_tables(measurement: SceneMeasurement) -> tuple[Table, ...]:
    """Edges by verdict, the shares of the objects, sharpness over the field, what was left out."""
    return (
        _edges_table(measurement), _objects_table(measurement), _field_table(measurement),
        _reasons_table(measurement),
    )  # fmt: skip


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
        (_OBJECTS[name], f"{100 * share.value:.1f} ± {100 * share.std:.1f}")
        for name, share in measurement.objects.items()
    )
    return Table(
        ("objects", "share / %"), rows, "lr", title="Objects",
        notes=("How soft the borders are on the ground, found together with the sensor.",),
    )  # fmt: skip


def _field_table(measurement: SceneMeasurement) -> Table:
    rows = []
    for place in measurement.over_field(*measurement.options["places"]):
        numbers = (
            str(getattr(one, name))
            for name in ("mtf_nyquist", "rer", "fwhm_px")
            for one in (place.across, place.along)
        )
        rows.append((f"{place.row:.0f}", f"{place.col:.0f}", *numbers))
    chance = measurement.field.chance_constant
    return Table(
        (
            "row", "column", "MTF at Nyquist across", "along", "RER across", "along",
            "FWHM / px across", "along",
        ),
        tuple(rows), "rrrrrrrr", title="Sharpness over the field",
        notes=(
            "In the middle of equal parts of the scene. The chance that sharpness is the same "
            f"everywhere is {chance:.2g}.",
        ),
    )  # fmt: skip


def _reasons_table(measurement: SceneMeasurement) -> Table:
    edges = measurement.edges
    short = [" ".join(one.split()[:_WORDS]) for one in edges.reason[~edges.used].tolist()]
    words, counts = np.unique(short, return_counts=True)
    order = np.argsort(-counts, kind="stable")[:_REASONS]
    rows = tuple((f"{words[i]} …", str(int(counts[i]))) for i in order)
    return Table(
        ("why edges are not used", "edges"), rows, "lr", title="Edges left out", page_only=True
    )
