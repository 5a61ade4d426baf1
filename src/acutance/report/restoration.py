"""A restoration filter, its proof and NIIRS: text, JSON and page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from acutance.arguments import require_class
from acutance.report.figures.restoration import restoration_panels
from acutance.report.html import Headline, Section, Table, Verdict, render_page
from acutance.report.labels import format_number, word_estimate, write_fixed
from acutance.report.page import panel_plate
from acutance.report.tables.restoration import niirs_table, proof_table, restoration_tables
from acutance.report.text import table_text

if TYPE_CHECKING:
    from acutance.curves import Estimate
    from acutance.restoration import RestorationFilter, RestorationProof
    from acutance.restoration.interpretability import Niirs
    from acutance.targets.check import VerdictWord

__all__ = ["niirs_text", "proof_text", "restoration_page", "restoration_text"]

_MAX_SOURCES = 4
_KNOBS = {
    "noise_gain": "noise gain",
    "mtf_nyquist": "MTF at Nyquist",
    "overshoot": "overshoot",
}


def restoration_text(filter: RestorationFilter) -> str:
    """A filter for a terminal: what it is, sharpness before and after, what it costs.

    Parameters
    ----------
    filter : RestorationFilter
    """
    require_class("RestorationFilter", filter=filter)
    tables = [one for one in restoration_tables(filter) if not one.page_only]
    notes = [f"note: {note}" for note in filter.notes]
    return "\n\n".join(
        (
            f"restoration, {_title(filter)}\n  of {'; '.join(filter.sources)}",
            *map(table_text, tables),
            *(["\n".join(notes)] if notes else []),
        )
    )


def restoration_page(filter: RestorationFilter, *, command: str | None = None) -> str:
    """A filter as one self-contained HTML page: the sheet.

    Parameters
    ----------
    filter : RestorationFilter
    command : str, optional
        The command line.
    """
    require_class("RestorationFilter", filter=filter)
    plates = tuple(map(panel_plate, restoration_panels(filter)))
    sharpness, cost, trade, kernel = restoration_tables(filter)
    content = (
        Section("Result", headlines=_headlines(filter), verdicts=_verdicts(filter)),
        Section("What it does and what it costs", plates=plates),
        *map(Section.of_table, (sharpness, cost, trade, kernel)),
        Section("How it was designed", tables=(_provenance(filter),), command=command),
    )
    return render_page("Restoration filter", _title(filter), content, _facts(filter))


def proof_text(proof: RestorationProof) -> str:
    """Edges before and after for a terminal.

    Parameters
    ----------
    proof : RestorationProof
    """
    require_class("RestorationProof", proof=proof)
    refused = [f"{one}" for one in proof.rejected]
    verdict = f"The image {proof.sentence}."
    notes = [f"note: {note}" for note in proof.notes]
    return "\n".join((table_text(proof_table(proof)), *refused, verdict, *notes))


def niirs_text(found: Niirs) -> str:
    """A NIIRS for a terminal: the number, what it was computed from, its notes.

    Parameters
    ----------
    found : Niirs
    """
    require_class("Niirs", found=found)
    notes = [f"note: {note}" for note in found.notes]
    return "\n\n".join((table_text(niirs_table(found)), *(["\n".join(notes)] if notes else [])))


def _title(filter: RestorationFilter) -> str:
    asked = filter.document.get("asked") or {}
    for name, value in asked.items():
        return (
            f"{filter.method} kernel of {filter.size} by {filter.size} pixels, {_KNOBS[name]} "
            f"{format_number(value)} asked for"
        )
    aim = "a stated MTF" if filter.method == "target" else "least expected error"
    return f"{filter.method} kernel of {filter.size} by {filter.size} pixels, {aim}"


def _headlines(filter: RestorationFilter) -> tuple[Headline, ...]:
    """MTF at Nyquist of both directions, noise gain, largest overshoot, NIIRS."""
    cards = []
    for name, after in filter.after.directions.items():
        before = filter.before.directions[name].mtf_nyquist
        value, details = _value_and_details(after.mtf_nyquist, 3)
        was = (
            word_estimate(before).value_and_std if before.std > 0 else write_fixed(before.value, 3)
        )
        cards.append(
            Headline(f"MTF at Nyquist, {name}", value, details=(*details, f"before {was}"))
        )
    snr = () if filter.snr is None else (f"SNR {filter.snr:.3g} → {filter.snr_after:.3g}",)
    cards.append(Headline("Noise gain", f"{filter.noise_gain:.2f}", details=snr))
    value, details = _value_and_details(100 * filter.after.overshoot, 1)
    # Undershoot may be the larger one: under "overshoot" the table had another number.
    cards.append(Headline("Largest over- or undershoot", value, "%", details=details))
    if filter.niirs_change:
        change = filter.niirs_change[4]
        shown = f"{change.value:+.2f}".replace("-", "−")
        interval = (word_estimate(change).short_interval,) if change.std > 0 else ()
        cards.append(Headline("Change of NIIRS, GIQE 4", shown, details=interval))
    return tuple(cards)


def _value_and_details(number: Estimate, digits: int) -> tuple[str, tuple[str, ...]]:
    """A number and its deviation; of one without a deviation so many decimals, and no line."""
    if number.std == 0:
        return write_fixed(number.value, digits), ()
    words = word_estimate(number)
    return words.value, (f"± {words.std}",)


def _verdicts(filter: RestorationFilter) -> tuple[Verdict, ...]:
    if not filter.notes:
        return (Verdict("good", "Nothing has to be said against it."),)
    word: VerdictWord = "usable" if filter.verdict == "good" else filter.verdict
    first, *others = [_without_word(note, word, len(filter.sources)) for note in filter.notes]
    return tuple(Verdict(word, f"{note}.") for note in (f"{word.capitalize()}: {first}", *others))


def _without_word(note: str, word: str, sources: int) -> str:
    """A note without the word that the whole has, and without the name of the only measurement."""
    name, mark, said = note.partition(f": {word}: ")
    if not mark:
        name, said = "", note.removeprefix(f"{word}: ")
    named = f"{name}: {said}" if name and sources > 1 else said
    return named.rstrip(".")


def _provenance(filter: RestorationFilter) -> Table:
    scene = filter.document.get("scene", {})
    rows = [("measured", "; ".join(filter.sources)), ("scene", str(scene.get("kind", "")))]
    rows += [
        (name.replace("_", " "), format_number(scene[name]))
        for name in ("contrast_to_noise", "exponent")
        if name in scene
    ]
    rows.append(("weight of the noise", format_number(float(filter.document["noise_weight"]))))
    software = filter.document.get("software", {})
    rows += [(name, str(version)) for name, version in software.items()]
    return Table(("What", "Value"), tuple(rows), "ll")


def _facts(filter: RestorationFilter) -> dict[str, str]:
    facts = {"made of": _listed(filter.sources), "size": f"{filter.size} × {filter.size} px"}
    if filter.gsd_m is not None:
        row, col = (format_number(side) for side in filter.gsd_m)
        facts["GSD"] = f"{col} m" if row == col else f"{row} × {col} m"
    if filter.band is not None:
        facts["band"] = str(filter.band)
    designed = str(filter.document.get("designed_at", ""))
    return facts | {"designed": designed[:16].replace("T", " ") + " UTC"}


def _listed(sources: Sequence[str]) -> str:
    """The first of many."""
    more = len(sources) - _MAX_SOURCES
    named = "; ".join(sources[:_MAX_SOURCES])
    return f"{named}; and {more} more" if more > 0 else named
