"""Many pulses: those of given regions, of one image or of several."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial

from numpy.typing import ArrayLike

from acutance.raster import Gsd, Image
from acutance.targets.in_turn import ImageRegions, in_turn
from acutance.targets.options import chosen_options
from acutance.targets.record import Record
from acutance.targets.region import RoiLike
from acutance.targets.straight.options import PulseOptions
from acutance.targets.straight.pulse import pulse_steps, require_pulse_method
from acutance.targets.target_result import Rejected

__all__ = ["each_pulse", "measure_pulses"]


def measure_pulses(
    image: Image | ArrayLike | ImageRegions,
    regions: Iterable[RoiLike] | None = None,
    *,
    width_px: float | None = None,
    width_m: float | None = None,
    gsd_m: float | Gsd | None = None,
    fit_width: bool = True,
    method: str = "spline",
    options: PulseOptions | None = None,
    workers: int = 1,
) -> tuple[Record | Rejected, ...]:
    """Measure the strongest pulse of each of many regions; all are of one stated width.

    Parameters
    ----------
    image, regions
        As in `acutance.each_edge`.
    width_px, width_m, gsd_m, fit_width, method, options
        As in `acutance.measure_pulse`.
    workers : int, optional
        As in `acutance.each_edge`.

    Returns
    -------
    tuple of Record and Rejected
        In the order of the regions; see `acutance.measure_edges`.
    """
    return tuple(
        each_pulse(
            image, regions, width_px=width_px, width_m=width_m, gsd_m=gsd_m, fit_width=fit_width,
            method=method, options=options, workers=workers,
        )
    )  # fmt: skip


def each_pulse(
    image: Image | ArrayLike | ImageRegions,
    regions: Iterable[RoiLike] | None = None,
    *,
    width_px: float | None = None,
    width_m: float | None = None,
    gsd_m: float | Gsd | None = None,
    fit_width: bool = True,
    method: str = "spline",
    options: PulseOptions | None = None,
    workers: int = 1,
) -> Iterator[Record | Rejected]:
    """Measure the strongest pulse of each of many regions, one result after the other.

    Parameters
    ----------
    image, regions
        As in `acutance.each_edge`.
    width_px, width_m, gsd_m, fit_width, method, options
        As in `acutance.measure_pulse`.
    workers : int, optional
        As in `acutance.each_edge`.

    Returns
    -------
    iterator of Record and Rejected
        As of `acutance.each_edge`.

    Raises
    ------
    OptionError
        If the method, the options or the number of workers mean nothing.
    """
    require_pulse_method(method)
    measure = partial(
        pulse_steps, width_px=width_px, width_m=width_m, fit_width=fit_width, method=method,
        options=chosen_options(options, PulseOptions),
    )  # fmt: skip
    return in_turn(measure, image, regions, gsd_m=gsd_m, workers=workers)
