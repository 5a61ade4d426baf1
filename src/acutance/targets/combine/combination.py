"""Combine edges, pulses and 2-D measurements of one sensor into one 2-D OTF."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from acutance.curves import Estimate, Otf2d
from acutance.curves.direction import unit_vector
from acutance.curves.metrics import NYQUIST_CPP
from acutance.curves.transfer import mtf_and_std
from acutance.errors import OptionError
from acutance.numerics.one_thread import one_thread
from acutance.raster import Gsd
from acutance.targets.combine.checks import check_combination, count_directions, direction_gap_deg
from acutance.targets.combine.combined_measurement import CombinedMeasurement, CombinedPart
from acutance.targets.combine.curves import ChiSquare, OtfSamples
from acutance.targets.combine.fit import combine_curves
from acutance.targets.combine.inputs import (
    Combinable,
    MeasuredInput,
    common_flight,
    read_inputs,
    without,
)
from acutance.targets.combine.one_band import require_one_band
from acutance.targets.combine.options import CombineOptions
from acutance.targets.combine.pixel_size import common_gsd, require_one_product, without_gsd
from acutance.targets.options import chosen_options
from acutance.targets.record import ImageInfo

__all__ = ["combine"]

_MIN_GAP_DEG = 20.0


@one_thread
def combine(
    measurements: Sequence[Combinable],
    *,
    names: Sequence[str] | None = None,
    leave_out: Sequence[str] = (),
    gsd_m: float | Gsd | None = None,
    options: CombineOptions | None = None,
) -> CombinedMeasurement:
    """Combine measurements of one sensor into one 2-D optical transfer function (OTF).

    Parameters
    ----------
    measurements : sequence of Measurement, Record, TargetResult or dict
        Results, their records, or their JSON documents. Edges and pulses are slices along their
        normals.
    names : sequence of str, optional
        What to call them.
    leave_out : sequence of str, optional
        Those that do not count, by the names they have in the result: of a document of many
        measurements one need not be used.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, instead of that of the measurements.
    options : CombineOptions, optional

    Returns
    -------
    CombinedMeasurement
        Across and along are exactly those of the pixel grid.

    Raises
    ------
    OptionError
        If there is only one measurement or one direction, or they do not belong together: other
        pixels, several bands of an image, the same result twice, a ratio instead of an MTF; or none
        has a name of `leave_out`.

    Examples
    --------
    >>> both = ac.combine([ac.measure_edge(tarp, across), ac.measure_edge(tarp, along)])
    ... # doctest: +SKIP
    >>> print(both.across.mtf_nyquist, both.chi_square.p_value)  # doctest: +SKIP
    """
    chosen = chosen_options(options, CombineOptions)
    inputs = without(read_inputs(measurements, names), leave_out)
    _require_two(inputs)
    require_one_band(inputs)
    gsd = Gsd.given(gsd_m)
    unknown = without_gsd(inputs) if gsd is None else ()
    if gsd is None:
        gsd = common_gsd(inputs)
    else:
        require_one_product(inputs, gsd)
    fit = combine_curves(
        [_curve(one) for one in inputs], detector_px=chosen.detector_px, forms=chosen.forms
    )
    otf = Otf2d(fit.otf, None if gsd is None else (gsd.row_m, gsd.col_m))
    parts = tuple(
        _part(one, chi_square, otf) for one, chi_square in zip(inputs, fit.members, strict=True)
    )
    paths = {one.image.path for one in inputs}
    return CombinedMeasurement(
        kind="combined",
        method="least-squares",
        transfer=otf,
        snr=math.nan,
        checks=check_combination(inputs, fit, parts, chosen.limits, unknown),
        image=ImageInfo(
            paths.pop() if len(paths) == 1 else None,
            along_track=common_flight(inputs),
            pixel_gsd_m=otf.gsd_m,
        ),
        options=chosen.to_dict(),
        parts=parts,
        chi_square=fit.total,
        plain_sensor=fit.plain,
        details=fit,
    )


def _require_two(inputs: Sequence[MeasuredInput]) -> None:
    if not inputs:
        raise OptionError("there is nothing to combine: give at least two measurements")
    for i, one in enumerate(inputs):
        for other in inputs[:i]:
            same = one.slices.otf.shape == other.slices.otf.shape
            if same and np.array_equal(one.slices.otf, other.slices.otf):
                raise OptionError(
                    f"{other.name} and {one.name} are the same measurement: leave one out"
                )
    if len(inputs) == 1:
        found = "one direction" if not inputs[0].has_all_directions else "already a 2-D result"
        raise OptionError(
            f"only {inputs[0].name} was given, {found}: combine it with measurements in other "
            "directions or by other methods"
        )
    if direction_gap_deg(inputs) < _MIN_GAP_DEG:
        named = ", ".join(f"{one.name} {one.direction}" for one in inputs)
        raise OptionError(
            f"all measurements show one direction ({named}), {count_directions(inputs)} of at "
            f"least two that differ by {_MIN_GAP_DEG:g} degrees: add an edge or pulse in "
            "another direction, or points, a star or a pair of images"
        )


def _curve(one: MeasuredInput) -> OtfSamples:
    slices = one.slices
    u, v = slices.places
    return OtfSamples(
        one.name, u, v, slices.otf, slices.factor, slices.likelihood,
        is_about_curve=one.kind == "scene",
    )  # fmt: skip


def _part(one: MeasuredInput, chi_square: ChiSquare, otf: Otf2d) -> CombinedPart:
    slices = one.slices
    u, v = slices.places
    shape = slices.normal_deg.size, slices.freq_cpp.size
    value, std = mtf_and_std(slices.otf, slices.factor)
    fitted = otf.model.otf(u, v)
    _, fitted_std = mtf_and_std(fitted, otf.model.factor(u, v))
    direction = slices.normal_deg[0]
    at = int(np.argmin(np.abs(slices.freq_cpp - NYQUIST_CPP)))
    return CombinedPart(
        one.name,
        one.kind,
        one.record.method,
        one.image.path,
        tuple(slices.normal_deg.tolist()),
        chi_square,
        Estimate(float(value[at]), float(std[at])),
        _along(otf, float(direction), float(slices.freq_cpp[at])),
        slices.freq_cpp,
        value.reshape(shape),
        std.reshape(shape),
        np.abs(fitted).reshape(shape),
        fitted_std.reshape(shape),
    )


def _along(otf: Otf2d, normal_deg: float, freq_cpp: float) -> Estimate:
    """The combined MTF at one place of the plane."""
    x, y = unit_vector(normal_deg)
    u, v = np.array([freq_cpp * x]), np.array([freq_cpp * y])
    value, std = mtf_and_std(otf.model.otf(u, v), otf.model.factor(u, v))
    return Estimate(float(value[0]), float(std[0]))
