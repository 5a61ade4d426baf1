"""The HTML page of any result."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from acutance.report.check_words import common_verdict, failed_by_check
from acutance.report.comparison import Comparison, Result, as_result
from acutance.report.figure import panels
from acutance.report.figures.comparison import comparison_figure
from acutance.report.figures.target import target_figure
from acutance.report.html import Plate, Section, Table, Verdict, render_page
from acutance.report.labels import (
    count_edges,
    describe_target,
    flatten_options,
    format_number,
    provenance,
    title_of,
)
from acutance.report.paper import new_page, styled
from acutance.report.recorded import recorded_sections
from acutance.report.requirements import Required, required_verdicts
from acutance.report.tables.measurement import headline_table, numbers_of, options_table
from acutance.report.tables.result import tables
from acutance.report.tables.target import means_headline, target_tables
from acutance.targets import Record, TargetResult

if TYPE_CHECKING:
    from acutance.curves.grid import Floats
    from acutance.report.figures.panel import Panel
    from acutance.targets.measurement import Measurement

__all__ = ["page", "panel_plate", "rejection_page", "sections", "verdict_of"]

PLATE_IN, WIDE_IN = 6.0, 12.4
MAX_COLUMNS_BESIDE = 5


def page(
    result: Result | Record,
    *,
    command: str | None = None,
    required: Required = (),
    backdrop: Floats | None = None,
    origin: tuple[int, int] = (0, 0),
) -> str:
    """Any result as one self-contained HTML page.

    Parameters
    ----------
    result : Measurement, Record, TargetResult, Comparison or sequence of Measurement
        Several measurements of one target are compared. Of a record the MTF alone is drawn.
    command : str, optional
        The command line that produced it; of edges and pulses of a file it is made up from the
        measurement when not given.
    required : sequence of ToleranceLimit or str, optional
        Requirements to be answered: "mtf_nyquist >= 0.09".
    backdrop, origin : optional
        Of all edges of a target, or of a scene: see `acutance.report.draw`.

    Returns
    -------
    str
        A whole document: style and drawings are inside, nothing is loaded from elsewhere.
    """
    if isinstance(result, Record):
        boxes = (verdict_of(result), *required_verdicts(result, required))
        content = recorded_sections(result, boxes, command)
        return render_page(_titled(title_of(result), result), "", content, provenance(result))
    found = as_result(result)
    content = sections(found, command=command, required=required, backdrop=backdrop, origin=origin)
    if isinstance(found, TargetResult):
        count = count_edges(len(found.measurements))
        first = found.measurements[0]
        rejected = f"{len(found.rejected)} rejected" if found.rejected else ""
        title = _titled(f"{count} of one target", first)
        return render_page(title, rejected, content, provenance(first))
    if isinstance(found, Comparison):
        first = found.measurements[0]
        kind = title_of(first).split(",")[0]
        named = f"{kind} by {', '.join(found.labels)}{', with the truth' if found.truth else ''}"
        title = _titled("Methods compared", first)
        return render_page(title, named, content, provenance(first))
    title = _titled(title_of(found), found)
    return render_page(title, describe_target(found), content, provenance(found))


def _titled(title: str, result: Measurement | Record) -> str:
    """A title with the name of the region, where it has one."""
    return f"{result.image.region}: {title}" if result.image.region else title


def rejection_page(what: str, reason: str, *, command: str | None = None) -> str:
    """A page in the place of a result that there is none of.

    Parameters
    ----------
    what : str
        What was to be measured: "edge, region north".
    reason : str
        The message of the error.
    command : str, optional
        The command line.
    """
    verdict = Verdict("invalid", f"Not measured: {reason}")
    content = (Section("Result", verdicts=(verdict,), command=command),)
    return render_page("Not measured", what, content)


def sections(
    result: Result,
    *,
    command: str | None = None,
    required: Required = (),
    backdrop: Floats | None = None,
    origin: tuple[int, int] = (0, 0),
) -> tuple[Section, ...]:
    """What `page` shows, for a page that holds more than one result."""
    found = as_result(result)
    if isinstance(found, TargetResult):
        own = _target_sections(found, backdrop, origin, command)
    elif isinstance(found, Comparison):
        own = _comparison_sections(found, command)
    else:
        own = _measurement_sections(found, backdrop, command)
    answers = required_verdicts(found, required)
    return (replace(own[0], verdicts=(*own[0].verdicts, *answers)), *own[1:])


def verdict_of(result: Measurement | Record, label: str = "") -> Verdict:
    """What the checks come to: the word and the sentence that matters, then what else failed."""
    if not result.checks:
        return Verdict("usable", f"{label}No checks were made.")
    verdict = result.verdict
    others = [one for one in result.failed_checks if one.message != verdict.sentence]
    sentence = verdict.sentence.rstrip(".")
    return Verdict(
        verdict.word,
        f"{label}{verdict.word.capitalize()}: {sentence}.",
        tuple((one.name, one.message) for one in others),
    )


def panel_plate(panel: Panel) -> Plate:
    """A drawing as a plate of a page."""
    with styled():
        figure = new_page(WIDE_IN if panel.wide else PLATE_IN, panel.height_in)
        panel.draw(figure)
    return Plate.of_figure(figure, panel.title, panel.caption, wide=panel.wide)


def _measurement_sections(
    measurement: Measurement, backdrop: Floats | None, command: str | None
) -> tuple[Section, ...]:
    """Verdict, main numbers and MTF first; then drawings, tables, how it was measured."""
    mtf, *others = panels(measurement, backdrop=backdrop)
    target = [panel for panel in others if panel.is_target]
    rest = [panel for panel in others if not panel.is_target]
    *numbers, last = map(Section.of_table, tables(measurement))
    headline = headline_table(numbers_of(measurement), measurement)
    plates = tuple(map(panel_plate, (mtf, *target)))
    # A wider table would leave the MTF less than half of the page.
    has_room = len(headline.columns) <= MAX_COLUMNS_BESIDE
    return (
        Section(
            "Result",
            verdicts=(verdict_of(measurement),),
            tables=(headline,),
            plates=plates if has_room else (),
            side_by_side=True,
        ),
        *(() if has_room else (Section("", plates=plates),)),
        Section(
            "Curves" if measurement.details is None else "Curves and pixels",
            plates=tuple(map(panel_plate, rest)),
        ),
        *numbers,
        _with_command(last, command or _command(measurement)),
    )


def _with_command(section: Section, command: str | None) -> Section:
    return Section(section.title, tables=section.tables, command=command)


def _comparison_sections(comparison: Comparison, command: str | None) -> tuple[Section, ...]:
    """Verdicts, the target and the curves, one table of numbers a direction."""
    measurements = comparison.measurements
    verdicts = tuple(
        verdict_of(one, f"{label} – ")
        for label, one in zip(comparison.labels, measurements, strict=True)
    )
    against = "the truth" if comparison.truth else "the first method"
    refused = tuple(
        Verdict("invalid", f"{one.values['method']} – Not measured: {one.reason}")
        for one in comparison.rejected
    )
    curves = Plate.of_figure(
        comparison_figure(comparison, on_page=True),
        "MTFs, their differences and the differences of the ESFs",
        f"Bands are 95 % intervals. Differences are taken to {against}.",
        wide=True,
    )
    return (
        Section("Verdict", verdicts=(*verdicts, *refused)),
        Section("Target and curves", plates=(*_target_plates(measurements[0]), curves)),
        *map(Section.of_table, tables(comparison)),
        _with_command(
            Section.of_table(_shared_options(measurements)),
            command or _command(measurements[0], [one.method for one in measurements[1:]]),
        ),
    )


def _target_plates(measurement: Measurement) -> tuple[Plate, ...]:
    """The picture of a target that the figure of the comparison does not have."""
    if measurement.details is None or measurement.normal_deg is not None:
        return ()
    return tuple(panel_plate(panel) for panel in panels(measurement) if panel.is_target)


def _shared_options(measurements: Sequence[Measurement]) -> Table:
    """The methods, and the options they share."""
    each = [dict(flatten_options(one.options)) for one in measurements]
    shared = {
        name: value
        for name, value in each[0].items()
        if all(options.get(name) == value for options in each)
    }
    first = options_table(measurements[0])
    methods = dict.fromkeys(one.method for one in measurements)
    rows = (("methods", ", ".join(methods)), *shared.items(), *first.rows[-2:])
    return Table(first.columns, rows, first.align, title=first.title)


def _target_sections(
    result: TargetResult[Any],
    backdrop: Floats | None,
    origin: tuple[int, int],
    command: str | None,
) -> tuple[Section, ...]:
    """The picture of all edges first, then means, every edge, what failed, what was rejected."""
    measurements = result.measurements
    picture = Plate.of_figure(
        target_figure(result, backdrop=backdrop, origin=origin, on_page=True),
        "The edges and their MTFs by direction",
        "Numbered edges, the MTF of each with its 95 % band, the means at Nyquist.",
        wide=True,
    )
    last = Section.of_table(options_table(measurements[0]))
    return (
        Section("The target", verdicts=_target_verdicts(result), plates=(picture,)),
        Section("Means", tables=(means_headline(result),), side_by_side=True),
        *_failed_section(result),
        *map(Section.of_table, target_tables(result)),
        _with_command(last, command or _command_of_all(result)),
    )


def _target_verdicts(result: TargetResult[Any]) -> tuple[Verdict, ...]:
    """One verdict of all edges: that of the worst."""
    common = common_verdict(result.measurements)
    return (Verdict(common.word, f"{common.word.capitalize()}: {common.sentence}"),)


def _failed_section(result: TargetResult[Any]) -> tuple[Section, ...]:
    """What failed, check by check with the edges it failed at; nothing where all passed."""
    failed = failed_by_check(result.measurements)
    if not failed:
        return ()
    table = Table(("Failed check", "Edges", "What it means and what to do"), failed, "lll")
    return (Section("Failed checks", tables=(table,)),)


def _command(measurement: Any, compared: Sequence[str] = ()) -> str | None:
    """The command line that repeats an edge or a pulse of a file, measured from Python."""
    image = measurement.image
    # Of a linearised image the document has the curve's words, not the option that names it.
    if (
        image.path is None
        or image.linearized is not None
        or measurement.kind not in ("edge", "pulse")
        or not _can_be_typed(measurement)
    ):
        return None
    words = ["acutance", measurement.kind, image.path, "--roi", ",".join(map(str, image.roi))]
    if image.band != 1:
        words += ["--band", str(image.band)]
    if image.gsd_m is not None:
        words += ["--gsd", format_number(image.gsd_m, 8)]
    elif image.pixel_gsd_m is not None:
        words += ["--gsd", ",".join(format_number(side_m, 8) for side_m in image.pixel_gsd_m)]
    if image.along_track != "y":
        words += ["--along-track", image.along_track]
    if measurement.stated_width_px is not None and measurement.width_px is not None:
        words += ["--width-px", format_number(measurement.stated_width_px, 8)]
        words += [] if measurement.width_px.std > 0 else ["--hold-width"]
    words += _stated_words(measurement.options)
    words += ["--method", measurement.method]
    words += ["--compare", ",".join(dict.fromkeys(compared))] if compared else []
    words += _rer_centre_words(measurement, compared)
    if image.stated_nodata is not None:
        words += ["--nodata", f"{image.stated_nodata:.17g}"]
    if not measurement.options.get("robust", True) and measurement.method == "spline":
        words += ["--no-robust"]
    for name, limit in (measurement.options.get("limits") or {}).items():
        words += ["--limit", f"{name}={limit:.12g}"]
    return shlex.join(words)


def _command_of_all(result: TargetResult[Any]) -> str | None:
    """The same of all edges of a region."""
    first, *others = result.measurements
    if first.kind != "edge" or any(one.image != first.image for one in others):
        return None
    command = _command(first)
    return command and f"{command} --all"


def _can_be_typed(measurement: Any) -> bool:
    """Whether the region and the options of a measurement can be written on a command line."""
    # Options of a published method are for Python alone.
    return not measurement.image.is_polygon and not measurement.options.get("method_options")


def _rer_centre_words(measurement: Any, compared: Sequence[str]) -> list[str]:
    """The centre of the RER, where one of the methods has another of its own."""
    centre = measurement.response.rer_centre
    methods = [measurement.method]
    if measurement.options.get("rer_centre") is not None:
        methods += compared
    own = ("peak" if method == "kompsat-2014" else "half" for method in methods)
    return ["--rer-centre", centre] if any(one != centre for one in own) else []


def _stated_words(options: Mapping[str, Any]) -> list[str]:
    """What was stated of a straight target, as options of a command."""
    words = []
    for unit in ("m", "px"):
        stated = options.get(f"target_softness_{unit}")
        if stated is not None:
            value, std = (format_number(stated[name], 8) for name in ("value", "std"))
            words += [f"--target-softness-{unit}", f"{value}+-{std}"]
    level = options.get("level_uncertainty", 0.0)
    return words + (["--level-uncertainty", format_number(level, 8)] if level > 0 else [])
