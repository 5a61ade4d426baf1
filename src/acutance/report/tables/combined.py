"""A combination in tables: whether the measurements agree, the sensor and its forms."""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.report.html import Table
from acutance.report.labels import format_number, word_estimate

if TYPE_CHECKING:
    from acutance.targets.combine import CombinedMeasurement

__all__ = ["combined_tables"]

PARAMETERS = {
    "sigma_across_px": ("Gaussian, across", "px"),
    "sigma_along_px": ("Gaussian, along", "px"),
    "correlation": ("Gaussian, correlation", ""),
    "sigma_major_px": ("Gaussian, longer axis", "px"),
    "sigma_minor_px": ("Gaussian, shorter axis", "px"),
    "major_axis_deg": ("direction of the longer axis", "deg"),
    "smear_px": ("smear", "px"),
    "smear_direction_deg": ("direction of the smear", "deg"),
    "smear_across_px": ("smear, across", "px"),
    "smear_along_px": ("smear, along", "px"),
    "halo_share": ("light in the halo", ""),
    "halo_sigma_px": ("standard deviation of the halo", "px"),
    "halo_taper": ("halo, Gaussian 0, exponential 2/3", ""),
    "trail_across_px": ("charge trail, across", "px"),
    "trail_along_px": ("charge trail, along", "px"),
    "cutoff_cpp": ("cutoff of the aperture", "c/px"),
    "obscuration": ("obscuration of the aperture", ""),
    "defocus_waves": ("defocus, at the rim", "waves"),
    "astigmatism_waves": ("astigmatism, rms", "waves"),
    "coma_across_waves": ("coma across, rms", "waves"),
    "coma_along_waves": ("coma along, rms", "waves"),
    "spherical_waves": ("spherical aberration, rms", "waves"),
    "sharpening_across": ("sharpening kernel, across", ""),
    "sharpening_along": ("sharpening kernel, along", ""),
    "side_tap": ("3 x 3 kernel, taps at its sides", ""),
    "corner_tap": ("3 x 3 kernel, taps at its corners", ""),
    "unsharp_gain": ("unsharp mask, gain", ""),
    "unsharp_sigma_px": ("unsharp mask, Gaussian", "px"),
    **{f"tap_{k}": (f"kernel, tap {k}", "") for k in range(1, 8)},
    "cubic_a": ("cubic convolution, a", ""),
    "phase_across_px": ("cubic convolution, place across", "px"),
    "phase_along_px": ("cubic convolution, place along", "px"),
    "spline_degree": ("interpolation, degree of a spline", ""),
    "old_pixel_px": ("pixels before the interpolation", "px"),
    "diffusion_px": ("depth from which charge spreads", "px"),
    "detector_fill": ("detector's width over the stated one", ""),
}
PART_COLUMNS = (
    "measurement",
    "method",
    "normal",
    "MTF at Nyquist",
    "combined",
    "chi²",
    "expected",
    "p",
)


def combined_tables(measurement: CombinedMeasurement) -> tuple[Table, ...]:
    """Agreement of the measurements, parameters of the sensor, weights of its forms."""
    return _parts_table(measurement), _sensor_table(measurement), _forms_table(measurement)


def _parts_table(measurement: CombinedMeasurement) -> Table:
    found = measurement.chi_square
    note = (
        f"Chi-square {found.value:.1f}, expected {found.expected:.1f}: the chance of a larger one "
        f"is {format_number(found.p_value, 2)}. Birge ratio {measurement.birge_ratio:.2f}."
    )
    rows = tuple(
        (
            part.name, f"{part.kind} {part.method}",
            part.direction,
            word_estimate(part.own).value_and_std, word_estimate(part.combined).value_and_std,
            f"{part.chi_square.value:.1f}", f"{part.chi_square.expected:.1f}",
            format_number(part.chi_square.p_value, 2),
        )
        for part in measurement.parts
    )  # fmt: skip
    return Table(PART_COLUMNS, rows, "lllrrrrr", title="Do the measurements agree?", notes=(note,))


def _sensor_table(measurement: CombinedMeasurement) -> Table:
    rows = tuple(
        (PARAMETERS[name][0], word_estimate(one).value_and_std, PARAMETERS[name][1])
        for name, one in measurement.parameters.items()
    )
    return Table(
        ("Parameter", "Value", "Unit"), rows, "lrl", title="The sensor",
        notes=(_describe_sensor(measurement),),
    )  # fmt: skip


def _describe_sensor(measurement: CombinedMeasurement) -> str:
    sensor = measurement.sensor
    words = f"Sensor of largest weight ({sensor.best.weight:.2f}): {sensor.best.form.name}."
    if sensor.correction_share > 0:
        words += (
            f" A smooth correction of {100 * sensor.correction_share:.1f} % of the log "
            "MTF was added to it."
        )
    return words


def _forms_table(measurement: CombinedMeasurement) -> Table:
    rows = tuple(
        (one.form.name, f"{100 * one.share:g} %", f"{one.weight:.3f}")
        for one in measurement.sensor.forms
    )
    return Table(
        ("Form", "Correction", "Weight"), rows, "lrr", title="Forms of the sensor", page_only=True
    )
