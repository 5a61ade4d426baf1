"""What a report says about a measurement, a comparison and a target, section by section."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from acutance.curves import Estimate
from acutance.report.comparison_page import comparison_figure, edge_labels, true_numbers
from acutance.report.edge_page import panel_figures
from acutance.report.html import Headline, Plate, Section, Table, Verdict
from acutance.report.tables import mtf_rows
from acutance.report.target_page import group_rows, target_figure
from acutance.report.wording import (
    METRIC_WORDS,
    MISSING,
    count_edges,
    describe_line,
    flatten_options,
    format_number,
    metric_words,
    numbers_of,
    split_message,
    verdict,
    word_estimate,
    word_place,
    write_fixed,
)

if TYPE_CHECKING:
    from acutance.curves import Response
    from acutance.curves.grid import Floats
    from acutance.targets import Measurement2d
    from acutance.targets.measurement import Measurement
    from acutance.targets.straight import TargetResult

__all__ = [
    "checks_sections",
    "comparison_sections",
    "edge_sections",
    "reproducing_section",
    "target_sections",
]

HEADLINES = (
    "mtf_nyquist", "rer", "fwhm_px", "fwhm_m", "width_px", "width_m", "prf_fwhm_px", "prf_fwhm_m",
)  # fmt: skip

CAPTIONS = {
    "mtf": (
        "Modulation transfer function",
        "The MTF with its 95 % band. What the image holds beyond Nyquist is aliased.",
    ),
    "target": (
        "The pixels and the line",
        "The cut, the fitted line or both sides of the pulse, the pixels that entered the fit.",
    ),
    "esf": (
        "Edge spread function",
        "Every pixel at its distance along the normal, the fitted ESF, and what it leaves.",
    ),
    "prf": (
        "Pulse response",
        "Every pixel at its distance from the first side, the fitted response, and what it leaves.",
    ),
    "lsf": ("Line spread function", "The derivative of the ESF, with its full width at half."),
}


def edge_sections(measurement: Measurement, command: str | None = None) -> tuple[Section, ...]:
    """A single edge or pulse: numbers, verdict, drawings, tables, how it was measured."""
    plates = tuple(
        Plate.of_figure(figure, *CAPTIONS[name])
        for name, figure in panel_figures(measurement).items()
    )
    target = "An edge" if measurement.kind == "edge" else f"A {measurement.kind}"
    return (
        Section(
            "Result",
            paragraphs=(f"{target}, {measurement.orientation}: {describe_line(measurement)}.",),
            headlines=_headlines(measurement),
            verdicts=(Verdict(measurement.trusted, verdict([measurement])),),
        ),
        Section("Curves", plates=plates),
        Section("Numbers", tables=(_metrics_table(measurement),)),
        *checks_sections(measurement),
        Section("MTF in steps of 0.02 cycles per pixel", tables=(_mtf_table(measurement),)),
        reproducing_section(measurement, command or _command(measurement)),
    )


def _headlines(measurement: Measurement) -> tuple[Headline, ...]:
    numbers = numbers_of(measurement)
    cards = [_headline(name, numbers[name]) for name in HEADLINES if name in numbers]
    cards.append(Headline("SNR", format_number(measurement.snr, 3), "", ("contrast over noise",)))
    return tuple(cards)


def _headline(name: str, estimate: Estimate) -> Headline:
    words, number = metric_words(name), word_estimate(estimate)
    details = () if number.std == MISSING else (f"± {number.std}", f"95 %: {number.interval}")
    return Headline(words.label, number.value, words.unit, details)


def _metrics_table(measurement: Measurement) -> Table:
    rows = []
    for name, estimate in numbers_of(measurement).items():
        words, number = metric_words(name), word_estimate(estimate)
        rows.append(
            (words.label, number.value, number.std, number.interval, words.unit, words.meaning)
        )
    columns = ("Metric", "Value", "Std", "95 % interval", "Unit", "Meaning")
    return Table(columns, tuple(rows), "lrrrll")


def checks_sections(measurement: Measurement | Measurement2d) -> tuple[Section, ...]:
    """What was asked of the target; nothing where nothing was."""
    if not measurement.checks:
        return ()
    rows, alerts = [], set()
    for i, check in enumerate(measurement.checks):
        message, source = split_message(check)
        found = format_number(check.value, 3)
        state = "passed" if check.passed else "failed"
        rows.append((check.name, found, check.limit, state, message, source))
        if not check.passed:
            alerts.add(i)
    columns = ("Check", "Found", "Asked", "", "What it means", "Source of the limit")
    table = Table(columns, tuple(rows), "lrrlll", alerts=frozenset(alerts))
    return (Section("Checks", tables=(table,)),)


def _mtf_table(measurement: Measurement) -> Table:
    rows = []
    for row in mtf_rows(measurement):
        low, high = row.mtf.interval(0.95)
        metres = () if row.freq_cpm is None else (f"{row.freq_cpm:.3f}",)
        rows.append(
            (
                f"{row.freq_cpp:.2f}",
                *metres,
                f"{row.mtf.value:.4f}",
                f"{write_fixed(low)} … {write_fixed(high)}",
            )
        )
    metres = () if measurement.response.gsd_m is None else ("c/m",)
    columns = ("c/px", *metres, "MTF", "95 % interval")
    return Table(columns, tuple(rows), "r" * len(columns), parts=3)


def reproducing_section(
    measurement: Measurement | Measurement2d, command: str | None = None
) -> Section:
    """Options, software, time, and the command that measures the same again."""
    options = (("method", measurement.method), *flatten_options(measurement.options))
    return _how_it_was_measured(options, measurement, command)


def _how_it_was_measured(
    options: Sequence[tuple[str, str]],
    measurement: Measurement | Measurement2d,
    command: str | None,
) -> Section:
    from acutance import __version__

    rows = (
        *options,
        ("acutance", __version__),
        ("measured at", measurement.measured_at.isoformat(sep=" ", timespec="seconds")),
    )
    return Section(
        "How it was measured",
        tables=(Table(("Option", "Value"), rows, "ll"),),
        command=command,
    )


def _reproducing_comparison(measurements: Sequence[Measurement], command: str | None) -> Section:
    """The methods, and the options they share; the command repeats them all."""
    first = measurements[0]
    methods = list(dict.fromkeys(one.method for one in measurements))
    each = [dict(flatten_options(one.options)) for one in measurements]
    shared = [
        (name, value)
        for name, value in each[0].items()
        if all(options.get(name) == value for options in each)
    ]
    again = command or _command(first, compared=methods[1:])
    return _how_it_was_measured([("methods", ", ".join(methods)), *shared], first, again)


def _command(measurement: Measurement, compared: Sequence[str] = ()) -> str | None:
    """The command line that repeats a measurement made from Python, where a file is known."""
    image = measurement.image
    if image.path is None:
        return None
    words = ["acutance", measurement.kind, image.path, "--roi", ",".join(map(str, image.roi))]
    if image.band != 1:
        words += ["--band", str(image.band)]
    if image.gsd_m is not None:
        words += ["--gsd", format_number(image.gsd_m, 8)]
    if image.along_track != "y":
        words += ["--along-track", image.along_track]
    if measurement.stated_width_px is not None and measurement.width_px is not None:
        words += ["--width-px", format_number(measurement.stated_width_px, 8)]
        words += [] if measurement.width_px.std > 0 else ["--hold-width"]
    words += ["--method", measurement.method]
    words += ["--compare", ",".join(compared)] if compared else []
    if measurement.response.rer_centre != "half":
        words += ["--rer-centre", measurement.response.rer_centre]
    return shlex.join(words)


def comparison_sections(
    measurements: Sequence[Measurement],
    *,
    truth: Response | None = None,
    true_width_px: float | None = None,
    command: str | None = None,
) -> tuple[Section, ...]:
    """One target by several methods: drawings, all numbers, verdicts."""
    labels = edge_labels(measurements)
    plate = Plate.of_figure(
        comparison_figure(measurements, truth=truth, true_width_px=true_width_px),
        "MTFs, their differences and the differences of the ESFs",
        "Bands are 95 % intervals. Differences are taken to the truth, or to the first method.",
        wide=True,
    )
    verdicts = tuple(
        Verdict(one.trusted, f"{label}: {verdict([one])}")
        for label, one in zip(labels, measurements, strict=True)
    )
    first = "" if truth is None else " and the truth"
    return (
        Section(
            "Comparison",
            paragraphs=(f"One target by {', '.join(labels)}{first}.",),
            plates=(plate,),
        ),
        Section(
            "Numbers",
            tables=(_comparison_table(measurements, labels, true_numbers(truth, true_width_px)),),
        ),
        Section("Checks", verdicts=verdicts, tables=_failed_checks("Method", labels, measurements)),
        _reproducing_comparison(measurements, command),
    )


def _comparison_table(
    measurements: Sequence[Measurement], labels: Sequence[str], truth: Mapping[str, Estimate]
) -> Table:
    known = ("truth",) if truth else ()
    rows = []
    for name in METRIC_WORDS:
        numbers = [numbers_of(one).get(name) for one in measurements]
        if any(number is None for number in numbers):
            continue
        true = (_true_value(truth, name),) if truth else ()
        cells = (word_estimate(number).value_and_std for number in numbers if number is not None)
        rows.append((metric_words(name).label_with_unit, *true, *cells))
    columns = ("Metric", *known, *labels)
    return Table(columns, tuple(rows), "l" + "r" * (len(columns) - 1))


def _true_value(truth: Mapping[str, Estimate], name: str) -> str:
    number = truth.get(name)
    return MISSING if number is None else word_estimate(number).value


def target_sections(
    result: TargetResult,
    *,
    backdrop: Floats | None = None,
    origin: tuple[int, int] = (0, 0),
    command: str | None = None,
) -> tuple[Section, ...]:
    """All edges of a target: group means, every edge, what was rejected and why."""
    measurements = tuple(result.measurements)
    numbered = [str(number) for number in range(1, len(measurements) + 1)]
    plate = Plate.of_figure(
        target_figure(result, backdrop=backdrop, origin=origin),
        "The edges and their MTFs by direction",
        "Numbered edges, the MTF of each with its 95 % band, the weighted mean at Nyquist.",
        wide=True,
    )
    groups = Table(
        ("Direction", "Metric", "Weighted mean", "chi² / dof", "p"),
        tuple(group_rows(result)),
        "llrrr",
    )
    sections = [
        *_mean_sections(result),
        Section(
            "Checks",
            verdicts=(Verdict(all(one.trusted for one in measurements), verdict(measurements)),),
            tables=_failed_checks("Edge", numbered, measurements),
        ),
        Section("Edges", plates=(plate,), tables=(_edges_table(measurements),)),
        Section(
            "Means by direction",
            paragraphs=(
                "The means weigh every edge by its variance. A small p says that the edges differ "
                "by more than their standard deviations explain.",
            ),
            tables=(groups,),
        ),
    ]
    if result.rejected:
        rows = tuple((word_place(one.values), one.stage, one.reason) for one in result.rejected)
        sections.append(
            Section("Rejected", tables=(Table(("Where", "Stage", "Why"), rows, "lll"),)),
        )
    return (*sections, reproducing_section(measurements[0], command or _command(measurements[0])))


def _failed_checks(
    called: str, labels: Sequence[str], measurements: Sequence[Measurement]
) -> tuple[Table, ...]:
    """What every failed check says, one measurement after the other; no table if none failed."""
    rows = [
        (label, check.name, check.message)
        for label, one in zip(labels, measurements, strict=True)
        for check in one.failed_checks
    ]
    return (Table((called, "Check", "What it says"), tuple(rows), "lll"),) if rows else ()


def _mean_sections(result: TargetResult) -> list[Section]:
    """The headlines, one section a direction."""
    found = []
    for orientation, group in result.groups.items():
        cards = [
            _headline(name, group.metrics[name]) for name in HEADLINES if name in group.metrics
        ]
        count = len(group.measurements)
        text = f"Weighted mean of {count_edges(count)}."
        found.append(Section(f"Result {orientation}", (text,), tuple(cards)))
    return found


def _edges_table(measurements: Sequence[Measurement]) -> Table:
    names = ("mtf_nyquist", "rer", "fwhm_px")
    rows, alerts = [], set()
    for i, one in enumerate(measurements):
        failed = ", ".join(check.name for check in one.failed_checks)
        rows.append(
            (
                str(i + 1),
                one.orientation,
                word_estimate(one.angle_deg).value_and_std,
                format_number(one.snr, 3),
                *(word_estimate(getattr(one, name)).value_and_std for name in names),
                failed or "all passed",
            )
        )
        if failed:
            alerts.add(i)
    columns = (
        "Edge",
        "Direction",
        "Angle [°]",
        "SNR",
        *(metric_words(name).label_with_unit for name in names),
        "Checks",
    )
    return Table(columns, tuple(rows), "rlrrrrrl", alerts=frozenset(alerts))
