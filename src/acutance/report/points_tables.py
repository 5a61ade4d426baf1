"""Point sources in rows: their places and light, what was rejected, the survey."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from acutance.report.html import Section, Table
from acutance.report.text import align_columns
from acutance.report.wording import MISSING, format_number, word_estimate, write_fixed

if TYPE_CHECKING:
    from acutance.targets.points import PointsMeasurement

__all__ = ["points_blocks", "points_sections", "sources_csv"]

MOST_ROWS = 40
SOURCE_COLUMNS = ("", "row", "col", "flux", "background", "SNR", "misfit")


def points_blocks(measurement: PointsMeasurement) -> tuple[str, ...]:
    """Sources, rejected spots and survey, as paragraphs of the text report."""
    rows = _source_rows(measurement)
    blocks = [align_columns([SOURCE_COLUMNS, *rows[:MOST_ROWS]], "rrrrrrr")]
    if len(rows) > MOST_ROWS:
        blocks[0] += f"\n  ... {len(rows) - MOST_ROWS} more in the JSON document"
    if measurement.rejected:
        blocks.append(_rejected_words(measurement))
    if measurement.survey is not None:
        header, rows = _survey_rows(measurement)
        blocks.append(align_columns([header, *rows], "r" * len(header)))
    return tuple(blocks)


def points_sections(measurement: PointsMeasurement) -> tuple[Section, ...]:
    """The same as sections of the HTML report."""
    table = Table(("No.", *SOURCE_COLUMNS[1:]), tuple(_source_rows(measurement)), "rrrrrrr")
    sections = [Section("Sources", tables=(table,))]
    if measurement.rejected:
        rejected = tuple(
            (f"{one.row:.1f}", f"{one.col:.1f}", one.reason, one.message)
            for one in measurement.rejected[:MOST_ROWS]
        )
        sections.append(
            Section(
                "Rejected",
                paragraphs=(_rejected_words(measurement).splitlines()[0].strip(),),
                tables=(Table(("Row", "Column", "Reason", "What was found"), rejected, "rrll"),),
            )
        )
    if measurement.survey is not None:
        header, rows = _survey_rows(measurement)
        words = (
            "The mean difference"
            if measurement.survey.reference == "mean"
            else ("The difference of the first source")
        )
        sections.append(
            Section(
                "Measured less surveyed places",
                paragraphs=(f"{words} was taken out.",),
                tables=(Table(header, tuple(rows), "r" * len(header)),),
            )
        )
    if measurement.published is not None:
        found = measurement.published
        rows = [
            ("σ across [px]", f"{found.psf.sigma_x_px:.4f}"),
            ("σ along [px]", f"{found.psf.sigma_y_px:.4f}"),
            ("RMSE of the aligned fit [image units]", format_number(found.rmse)),
            ("NoiseMean", format_number(found.noise_mean)),
            ("NoiseStd", format_number(found.noise_std)),
            ("Peak over background mean", format_number(found.peak_over_background)),
        ]
        sections.append(Section("Aligned samples", tables=(Table(("", ""), tuple(rows), "lr"),)))
    return tuple(sections)


def sources_csv(measurement: PointsMeasurement) -> str:
    """Every source as CSV: number, row, col, flux, background with standard deviations, SNR."""
    lines = ["source,row,row_std,col,col_std,flux,flux_std,background,background_std,snr"]
    for number, one in enumerate(measurement.sources, start=1):
        numbers = [one.row, one.col, one.flux, one.background]
        cells = [f"{part:.6g}" for each in numbers for part in (each.value, each.std)]
        places = [f"{one.row.value:.4f}", f"{one.row.std:.4f}"]
        places += [f"{one.col.value:.4f}", f"{one.col.std:.4f}"]
        lines.append(",".join([str(number), *places, *cells[4:], f"{one.snr:.6g}"]))
    return "\n".join(lines) + "\n"


def _source_rows(measurement: PointsMeasurement) -> list[tuple[str, ...]]:
    return [
        (
            str(number),
            word_estimate(one.row).value_and_std,
            word_estimate(one.col).value_and_std,
            word_estimate(one.flux).value_and_std,
            word_estimate(one.background).value_and_std,
            format_number(one.snr, 3),
            format_number(one.misfit, 3),
        )
        for number, one in enumerate(measurement.sources, start=1)
    ]


def _rejected_words(measurement: PointsMeasurement) -> str:
    """How many were rejected why, and where those are that are not just faint."""
    counts = Counter(one.reason for one in measurement.rejected)
    words = ", ".join(f"{count} {reason}" for reason, count in counts.most_common())
    lines = [f"  {len(measurement.rejected)} rejected: {words}"]
    plain = [one for one in measurement.rejected if one.reason != "faint"]
    lines += [
        f"    {one.reason} at row {one.row:.1f}, column {one.col:.1f}: {one.message}"
        for one in plain[:MOST_ROWS]
    ]
    return "\n".join(lines)


def _survey_rows(
    measurement: PointsMeasurement,
) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Errors against the survey, as Tables 5.9 to 5.11 of the QuickBird report show them."""
    survey = measurement.survey
    if survey is None:
        return (), []
    errors, rmse = survey.errors_cm, survey.rmse_cm
    header = ("point", "source", "across [px]", "along [px]", "across [cm]", "along [cm]")
    rows: list[tuple[str, ...]] = []
    for i, point in enumerate(survey.point.tolist()):
        metric = (
            (MISSING, MISSING)
            if errors is None
            else (write_fixed(float(errors[0][i]), 2), write_fixed(float(errors[1][i]), 2))
        )
        rows.append(
            (
                str(point + 1),
                str(int(survey.source[i]) + 1),
                write_fixed(float(survey.across_px[i]), 4),
                write_fixed(float(survey.along_px[i]), 4),
                *metric,
            )
        )
    total = (MISSING, MISSING) if rmse is None else tuple(f"{value:.2f}" for value in rmse)
    rows.append(("RMSE", "", *(f"{value:.4f}" for value in survey.rmse_px), *total))
    return header, rows
