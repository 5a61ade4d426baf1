"""A combination in words and tables: the sensor, its forms, and how well the parts agree."""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.report.html import Section, Table
from acutance.report.text import align_columns
from acutance.report.wording import format_number, word_estimate

if TYPE_CHECKING:
    from acutance.curves import Estimate
    from acutance.targets.combine import CombinedMeasurement

__all__ = ["combine_blocks", "combine_sections"]

PARAMETERS = {
    "sigma_across_px": ("Gaussian, across", "px"),
    "sigma_along_px": ("Gaussian, along", "px"),
    "correlation": ("Gaussian, correlation", ""),
    "sigma_major_px": ("Gaussian, longer axis", "px"),
    "sigma_minor_px": ("Gaussian, shorter axis", "px"),
    "major_axis_deg": ("direction of the longer axis", "deg"),
    "smear_px": ("smear", "px"),
    "smear_direction_deg": ("direction of the smear", "deg"),
    "halo_share": ("light in the halo", ""),
    "halo_sigma_px": ("Gaussian of the halo", "px"),
    "trail_across_px": ("charge trail, across", "px"),
    "trail_along_px": ("charge trail, along", "px"),
    "cutoff_cpp": ("cutoff of the aperture", "c/px"),
    "obscuration": ("obscuration of the aperture", ""),
}
PART_COLUMNS = ("measurement", "method", "normal", "MTF at Nyquist", "combined", "chi²", "of", "p")


def combine_blocks(measurement: CombinedMeasurement) -> tuple[str, ...]:
    """The paragraphs a combination adds to the text."""
    return (
        align_columns([PART_COLUMNS, *_part_rows(measurement)], "lllrrrrr"),
        _describe_sensor(measurement),
        align_columns(_parameter_rows(measurement), "lrl"),
    )


def combine_sections(measurement: CombinedMeasurement) -> tuple[Section, ...]:
    """The sections a combination adds to the report."""
    forms = tuple(
        (one.form.name, f"{100 * one.share:g} %", f"{one.weight:.3f}")
        for one in measurement.fit.forms
    )
    return (
        Section(
            "Do the measurements agree?",
            paragraphs=(
                f"Chi-square {measurement.chi_square.value:.1f}, expected "
                f"{measurement.chi_square.expected:.1f}: the chance of a larger one is "
                f"{format_number(measurement.chi_square.p_value, 2)}. Birge ratio "
                f"{measurement.birge_ratio:.2f}.",
            ),
            tables=(Table(PART_COLUMNS, tuple(_part_rows(measurement)), "lllrrrrr"),),
        ),
        Section(
            "The sensor",
            paragraphs=(_describe_sensor(measurement),),
            tables=(
                Table(("Parameter", "Value", "Unit"), tuple(_parameter_rows(measurement)), "lrl"),
                Table(("Form", "departure", "weight"), forms, "lrr"),
            ),
        ),
    )


def _describe_sensor(measurement: CombinedMeasurement) -> str:
    fit = measurement.fit
    words = f"Sensor of largest weight ({fit.best.weight:.2f}): {fit.best.form.name}."
    if fit.departure > 0:
        words += (
            f" A smooth departure of {100 * fit.departure:.1f} % of the logarithm of the MTF "
            "stands for what no such sensor holds."
        )
    return words


def _part_rows(measurement: CombinedMeasurement) -> list[tuple[str, ...]]:
    return [
        (
            part.source.name, f"{part.source.kind} {part.source.method}", part.source.direction,
            word_estimate(part.own).value_and_std, word_estimate(part.combined).value_and_std,
            f"{part.chi_square.value:.1f}", f"{part.chi_square.expected:.1f}",
            format_number(part.chi_square.p_value, 2),
        )
        for part in measurement.parts
    ]  # fmt: skip


def _parameter_rows(measurement: CombinedMeasurement) -> list[tuple[str, ...]]:
    return [_parameter_row(name, one) for name, one in measurement.parameters.items()]


def _parameter_row(name: str, number: Estimate) -> tuple[str, ...]:
    words, unit = PARAMETERS[name]
    return words, word_estimate(number).value_and_std, unit
