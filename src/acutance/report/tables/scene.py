"""A scene in tables: what became of its edges, and what its objects are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.report.html import Table
from acutance.report.labels import word_softness
from acutance.report.tables.scene_reasons import reasons_table
from acutance.scan.softness import NEARLY_IDEAL_PX

if TYPE_CHECKING:
    from acutance.scan import SceneMeasurement

__all__ = ["scene_tables", "word_chance"]

VERDICTS = {
    "good": "measured, and used",
    "usable": "measured, and used: the intervals allow for what was found",
    "doubtful": "measured, not used: something beside the edge may bias it",
    "invalid": "measured, not used: the numbers are not the sensor's",
    "rejected": "not measured",
}
_OBJECTS = {
    "ideal": f"blurred by {NEARLY_IDEAL_PX:g} px at most",
    "soft": "blurred borders on the ground",
    "strange": "neither: too sharp, or of another shape",
}
_OF_PRODUCT = {
    "interpolation": "interpolated by cubic convolution",
    "resampling": "interpolated by splines",
    "phase": "interpolated at one phase of its pixels",
}
"""Terms of forms that are none of an instrument."""
_MIN_WEIGHT = 0.02
_MAX_FORMS = 5
_MIN_CHANCE = 1e-4


def word_chance(chance: float) -> str:
    """A probability: "0.37", "below 0.0001"."""
    return f"{chance:.2g}" if chance >= _MIN_CHANCE else f"below {_MIN_CHANCE:.4f}"


def scene_tables(measurement: SceneMeasurement) -> tuple[Table, ...]:
    """Edges, objects, forms of the sensor, sharpness over the field, what was left out."""
    return (
        _edges_table(measurement), _objects_table(measurement), _directions_table(measurement),
        _forms_table(measurement), _field_table(measurement),
        reasons_table(measurement.edges),
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
        (name, f"{100 * share.value:.1f} ± {100 * share.std:.1f}", _OBJECTS[name])
        for name, share in measurement.objects.items()
    )
    return Table(
        ("objects", "share / %", "meaning"), rows, "lrl", title="Objects",
        notes=(
            "How soft the borders are on the ground, found together with the sensor. "
            + _in_common(measurement.options),
        ),
    )  # fmt: skip


def _directions_table(measurement: SceneMeasurement) -> Table:
    rows = []
    for one in measurement.ideal_by_direction:
        share = f"{100 * one.share.value:.0f} ± {100 * one.share.std:.0f}"
        rows.append((f"{one.normal_deg:.1f}", str(one.edges), share))
    return Table(
        ("normal / °", "edges", "ideal / %"), tuple(rows), "rrr",
        title="Ideal objects by direction",
        notes=(
            "Objects of one direction may be softer than others: what they are is asked of every "
            "direction by itself. The fewer are ideal, the wider the interval of the sensor there.",
        ),
        page_only=True,
    )  # fmt: skip


def _forms_table(measurement: SceneMeasurement) -> Table:
    told = [(name, weight) for name, weight in measurement.forms.items() if weight >= _MIN_WEIGHT]
    rows = tuple((name, f"{weight:.2f}", _form_meaning(name)) for name, weight in told[:_MAX_FORMS])
    return Table(
        ("form", "weight", "meaning"), rows, "lrl", title="Forms of the sensor",
        notes=(
            "The sensor is the mean over forms, each by its weight. Where the image was "
            "interpolated onto its grid, the numbers are those of the product: the instrument "
            "was sharper.",
        ),
    )  # fmt: skip


def _form_meaning(name: str) -> str:
    """What a form says of the image."""
    terms = name.split(" x ")
    how = [words for term, words in _OF_PRODUCT.items() if term in terms]
    return f"{how[0]}: the product, not the instrument" if how else ""


def _in_common(options: Mapping[str, Any]) -> str:
    """What became of the softness that all objects have in common."""
    softness = word_softness(options)
    if softness:
        return (
            f"Of what all of them have in common {softness} are stated: the numbers are those of "
            "the sensor behind it. The edges themselves are told as they are in the image."
        )
    return (
        "What all of them have in common counts as the sensor's: a softness of 0.1 px lowers the "
        "MTF at Nyquist by 5 %, of 0.2 px by 18 %. Where more is known, it can be stated "
        "(--target-softness-m)."
    )


def _field_table(measurement: SceneMeasurement) -> Table:
    title = "Sharpness over the field"
    if not measurement.field.is_fitted:
        note = (
            "The edges are too few to show how sharpness changes over the field: one sensor is "
            "taken for all of it."
        )
        return Table((), (), "", title=title, notes=(note,))
    rows = []
    for place in measurement.over_field(*measurement.options["places"]):
        numbers = (
            str(getattr(one, name))
            for name in ("mtf_nyquist", "rer", "fwhm_px")
            for one in (place.across, place.along)
        )
        rows.append((f"{place.row:.0f}", f"{place.col:.0f}", *numbers))
    chance = word_chance(measurement.field.chance_constant)
    where = "In the middle of equal parts of the scene."
    if len({row[2:] for row in rows}) == 1:
        # Equal to the last digit that is told: one row says it.
        rows, where = [("all", "all", *rows[0][2:])], "The same in all parts of the scene."
    return Table(
        (
            "row", "column", "MTF at Nyquist across", "along", "RER across", "along",
            "FWHM / px across", "along",
        ),
        tuple(rows), "rrrrrrrr", title=title,
        notes=(
            f"{where} The chance that sharpness is the same everywhere is {chance}.",
        ),
    )  # fmt: skip
