"""Point sources in tables: their places and light, what was rejected, the survey."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from acutance.arguments import require_class
from acutance.geometry.line import axis_names
from acutance.report.html import Table
from acutance.report.labels import MISSING, format_number, word_estimate, write_fixed

if TYPE_CHECKING:
    from acutance.targets.points import Pads, PointsMeasurement
    from acutance.targets.points.published import AlignedFit
    from acutance.targets.points.survey import SurveyErrors

__all__ = ["points_tables", "sources_csv"]

SOURCE_COLUMNS = ("Source", "row", "col", "flux [DN]", "background [DN]", "SNR", "misfit")


def points_tables(measurement: PointsMeasurement) -> tuple[Table, ...]:
    """Sources, rejected spots and survey, as far as there are any."""
    tables = [_sources_table(measurement)]
    if measurement.rejected:
        tables.append(_rejected_table(measurement))
    if measurement.survey is not None:
        tables.append(_survey_table(measurement.survey))
    if measurement.aligned is not None:
        tables.append(_aligned_table(measurement.aligned, measurement.image.along_track))
    return tuple(tables)


def _sources_table(measurement: PointsMeasurement) -> Table:
    rows = tuple(
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
    )
    note = (
        "Flux: the light of a source over all pixels. Misfit: residuals within three pixels, over "
        "the noise."
    )
    notes = (note,) if measurement.pads is None else (note, _pads_note(measurement.pads))
    return Table(SOURCE_COLUMNS, rows, "rrrrrrr", title="Sources", notes=notes)


def _pads_note(pads: Pads) -> str:
    contrast = word_estimate(pads.contrast).value_and_std
    return (
        f"Pads of about {pads.side_px:g} px under the sources, {contrast} above their "
        "surroundings, are part of the model: the pixels are likelier with them."
    )


def _rejected_table(measurement: PointsMeasurement) -> Table:
    counts = Counter(one.reason for one in measurement.rejected)
    words = ", ".join(f"{count} {reason}" for reason, count in counts.most_common())
    # Faint spots are many, and nothing is wrong with them.
    rows = tuple(
        (f"{one.row:.1f}", f"{one.col:.1f}", one.reason, one.message)
        for one in measurement.rejected
        if one.reason != "faint"
    )
    return Table(
        ("Row", "Column", "Reason", "What was found"), rows, "rrll", title=f"Rejected: {words}"
    )


def _survey_table(survey: SurveyErrors) -> Table:
    """Errors against the survey, as Tables 5.9 to 5.11 of the QuickBird report show them."""
    errors, rmse = survey.errors_cm, survey.rmse_cm
    rows: list[tuple[str, ...]] = []
    for i, point in enumerate(survey.point.tolist()):
        pixels = (survey.across_px[i], survey.along_px[i])
        metric = (
            (MISSING, MISSING)
            if errors is None
            else tuple(write_fixed(float(axis[i]), 2) for axis in errors)
        )
        cells = (write_fixed(float(value), 4) for value in pixels)
        rows.append((str(point + 1), str(int(survey.source[i]) + 1), *cells, *metric))
    total = (MISSING, MISSING) if rmse is None else tuple(f"{value:.2f}" for value in rmse)
    rows.append(("RMSE", "", *(f"{value:.4f}" for value in survey.rmse_px), *total))
    taken = "The mean difference" if survey.reference == "mean" else "That of the first source"
    across, along = (write_fixed(one, 3) for one in survey.shift_px)
    return Table(
        ("point", "source", "across [px]", "along [px]", "across [cm]", "along [cm]"),
        tuple(rows), "rrrrrr", title="Measured minus surveyed places",
        notes=(f"{taken}, {across} px across and {along} px along, was taken out.",),
    )  # fmt: skip


def _aligned_table(found: AlignedFit, along_track: str) -> Table:
    x, y = axis_names(along_track)
    sigma_px = {x: found.sigma_x_px, y: found.sigma_y_px}
    rows = (
        *((f"σ {name} [px]", f"{sigma_px[name]:.4f}") for name in ("across", "along")),
        ("RMSE of the aligned fit [DN]", format_number(found.rmse)),
        ("NoiseMean [DN]", format_number(found.background_mean)),
        ("NoiseStd [DN]", format_number(found.background_std)),
        ("Peak over background mean", format_number(found.peak_over_background)),
    )
    return Table(("", ""), rows, "lr", title="Aligned samples", page_only=True)


def sources_csv(measurement: PointsMeasurement) -> str:
    """Every source as CSV: number, row, col, flux, background with standard deviations, SNR."""
    require_class("PointsMeasurement", measurement=measurement)
    lines = ["source,row,row_std,col,col_std,flux,flux_std,background,background_std,snr"]
    for number, one in enumerate(measurement.sources, start=1):
        places = (f"{part:.4f}" for each in (one.row, one.col) for part in (each.value, each.std))
        light = (
            f"{part:.6g}" for each in (one.flux, one.background) for part in (each.value, each.std)
        )
        lines.append(",".join([str(number), *places, *light, f"{one.snr:.6g}"]))
    return "\n".join(lines) + "\n"
