"""Several bands of a scene: text, JSON and page, of one table of bands and one of their shifts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from acutance.arguments import require_class
from acutance.curves.metric_words import metric_words
from acutance.report.comparison import Comparison
from acutance.report.figures.comparison import comparison_figure
from acutance.report.html import Plate, Section, Table, Verdict, render_page
from acutance.report.json import document
from acutance.report.labels import describe_image, provenance, word_estimate
from acutance.report.page import sections, verdict_of
from acutance.report.requirements import Required, required_lines, required_verdicts
from acutance.report.text import table_text

if TYPE_CHECKING:
    from acutance.curves.grid import Floats
    from acutance.scan import BandScenes
    from acutance.targets import Rejected

__all__ = ["bands_document", "bands_page", "bands_tables", "bands_text"]

_NUMBERS = ("mtf_nyquist", "rer", "fwhm_px")


def bands_tables(found: BandScenes) -> tuple[Table, ...]:
    """Numbers of every band, and where the bands lie relative to the first.

    Parameters
    ----------
    found : BandScenes
    """
    require_class("BandScenes", found=found)
    tables = [_numbers_table(found)]
    if found.shifts:
        tables.append(_shifts_table(found))
    return tuple(tables)


def _numbers_table(found: BandScenes) -> Table:
    rows: list[tuple[str, ...]] = []
    alerts = set()
    for name, scene in found.scenes.items():
        for direction, response in scene.directions.items():
            first = direction == next(iter(scene.directions))
            if scene.verdict.warns:
                alerts.add(len(rows))
            rows.append((
                found.label(name) if first else "", direction,
                *(word_estimate(getattr(response, one)).value_and_std for one in _NUMBERS),
                str(int(scene.edges.used.sum())) if first else "",
                f"{100 * scene.objects['ideal'].value:.0f}" if first else "",
                scene.verdict.word if first else "",
            ))  # fmt: skip
    labels = (metric_words(name).label_with_unit for name in _NUMBERS)
    return Table(
        ("Band", "Direction", *labels, "Edges", "Ideal [%]", "Verdict"), tuple(rows), "llrrrrrl",
        alerts=frozenset(alerts), title="Bands",
    )  # fmt: skip


def _shifts_table(found: BandScenes) -> Table:
    rows = tuple(
        (
            found.label(name), word_estimate(one.row_px).value_and_std,
            word_estimate(one.col_px).value_and_std,
            f"{one.scatter_px:.3f}", str(one.edges),
        )
        for name, one in found.shifts.items()
    )  # fmt: skip
    return Table(
        ("Band", "Rows [px]", "Columns [px]", "Scatter [px]", "Edges"), rows, "lrrrr",
        title=f"Shifts relative to band {found.label(found.first)}",
        notes=(
            "Place of the ground in a band minus its place in the first. Scatter: by how much "
            "single edges differ in excess of their deviations.",
        ),
    )  # fmt: skip


def bands_text(found: BandScenes, *, required: Required = ()) -> str:
    """Several bands for a terminal: the tables, the verdicts, what was not measured.

    Parameters
    ----------
    found : BandScenes
    required : sequence of ToleranceLimit or str, optional
        Requirements that every band answers.
    """
    require_class("BandScenes", found=found)
    first = found.scenes[found.first]
    lines = [
        f"band {found.label(name)}: {scene.verdict.word}: {scene.verdict.sentence}"
        for name, scene in found.scenes.items()
    ]
    lines += [
        f"band {found.label(one.values['band'])}: {what}: {one.reason}"
        for what, several in (("not measured", found.rejected), ("no shift", found.unshifted))
        for one in several
    ]
    image = describe_image(first, without=("band",))
    return "\n\n".join((
        f"scene in {_counted(found)}\n  {image}",
        *map(table_text, bands_tables(found)),
        "\n".join(lines),
        *_required_of_bands(found, required),
    ))  # fmt: skip


def _counted(found: BandScenes) -> str:
    """How many bands were measured, and of how many."""
    measured, asked = len(found.scenes), len(found.scenes) + len(found.rejected)
    of = f" of {asked}" if asked > measured else ""
    return f"{measured}{of} band{'s' if asked > 1 else ''}"


def _required_of_bands(found: BandScenes, required: Required) -> list[str]:
    return [
        lines
        for name, scene in found.scenes.items()
        for lines in required_lines(scene, required, f"Band {found.label(name)}: required")
    ]


def bands_document(
    found: BandScenes, covariance: bool = False, *, required: Required = ()
) -> dict[str, Any]:
    """The document ``acutance/bands/1``: one result a band, shifts, bands without a result.

    Parameters
    ----------
    found : BandScenes
    covariance : bool, optional
        As of `acutance.report.document`.
    required : sequence of ToleranceLimit or str, optional
        Requirements that every band answers.
    """
    require_class("BandScenes", found=found)
    return {
        "schema": "acutance/bands/1",
        "results": [
            {"band": name, **document(scene, covariance, required=required)}
            for name, scene in found.scenes.items()
        ],
        "shifts": [
            {"band": name, "relative_to": found.first, **one.to_dict()}
            for name, one in found.shifts.items()
        ],
        "rejected": _reasons(found.rejected),
        "unshifted": _reasons(found.unshifted),
    }


def _reasons(rejected: Sequence[Rejected]) -> list[dict[str, Any]]:
    return [
        {"stage": one.stage, "reason": one.reason, "values": dict(one.values)} for one in rejected
    ]


def bands_page(
    found: BandScenes,
    *,
    command: str | None = None,
    required: Required = (),
    backdrops: Mapping[str, Floats] | None = None,
) -> str:
    """Several bands as one page: the tables and all MTFs first, then every band.

    Parameters
    ----------
    found : BandScenes
    command : str, optional
        The command line.
    required : sequence of ToleranceLimit or str, optional
        Requirements that every band answers.
    backdrops : mapping of str to (rows, cols) array, optional
        By band a quick look at what was scanned.
    """
    require_class("BandScenes", found=found)
    shown = backdrops or {}
    names = tuple(f"band {found.label(name)}" for name in found.scenes)
    curves = Plate.of_figure(
        comparison_figure(Comparison(found.measurements, names=names), on_page=True),
        "MTFs, their differences and the differences of the ESFs",
        f"Filled areas are 95 % intervals. Differences are taken to band "
        f"{found.label(found.first)}.",
        wide=True,
    )
    verdicts = [
        verdict_of(scene, f"Band {found.label(name)} – ") for name, scene in found.scenes.items()
    ] + [
        Verdict("invalid", f"Band {found.label(one.values['band'])} – Not measured: {one.reason}")
        for one in found.rejected
    ] + [
        Verdict("usable", f"Band {found.label(one.values['band'])} – No shift: {one.reason}")
        for one in found.unshifted
    ] + [
        answer
        for name, scene in found.scenes.items()
        for answer in required_verdicts(scene, required, f"Band {found.label(name)} – ")
    ]  # fmt: skip
    each = [
        replace(
            section,
            title=f"Band {found.label(name)}: {section.title[:1].lower()}{section.title[1:]}",
        )
        for name, scene in found.scenes.items()
        for section in sections(scene, backdrop=shown.get(name))
    ]
    content = (
        Section("Result", verdicts=tuple(verdicts)),
        *map(Section.of_table, bands_tables(found)),
        Section("Curves of all bands", plates=(curves,), command=command),
        *each,
    )
    facts = provenance(found.scenes[found.first])
    facts.pop("band", None)
    return render_page(f"Scene in {_counted(found)}", ", ".join(names), content, facts)
