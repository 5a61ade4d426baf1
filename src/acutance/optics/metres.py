"""Curves on the ground: distances in metres, frequencies in cycles per metre."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acutance.arguments import require_kind, require_numbers
from acutance.curves import Response
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import ModelError
from acutance.optics.sensor import Sensor, require_sensor, spread_over_plane

__all__ = ["GroundCurves", "on_the_ground", "psf_on_the_ground"]


@dataclass(frozen=True, eq=False)
class GroundCurves(ShortRepr):
    """ESF, LSF and MTF of one direction on the ground.

    Parameters
    ----------
    gsd_m : float
        Metres per pixel along the normal, by which everything was converted.
    distance_m : (n,) array
        Normal distances in metres; 0 is where the edge spread function (ESF) passes 50 %.
    esf : (n,) array
        0 to 1.
    lsf_per_m : (n,) array
        The line spread function (LSF) in 1/m, area 1.
    freq_cpm : (m,) array
        Frequencies in cycles per metre.
    mtf : (m,) array
        0 to 1.
    nyquist_cpm : float
        Half a cycle per pixel.
    """

    gsd_m: float
    distance_m: Floats
    esf: Floats
    lsf_per_m: Floats
    freq_cpm: Floats
    mtf: Floats
    nyquist_cpm: float


def on_the_ground(response: Response) -> GroundCurves:
    """The curves of a response, true or measured, on the ground.

    Only so can two images of different GSD be compared.

    Parameters
    ----------
    response : Response

    Returns
    -------
    GroundCurves

    Raises
    ------
    OptionError
        If it is no response.
    ModelError
        If the response has no GSD.
    """
    require_kind(Response, response=response)
    gsd_m = response.gsd_m
    if gsd_m is None:
        raise ModelError("curves on the ground need the GSD: give gsd_m to the sensor or image")
    return GroundCurves(
        gsd_m=gsd_m,
        distance_m=response.esf.distance_px * gsd_m,
        esf=response.esf.value,
        lsf_per_m=response.lsf.value / gsd_m,
        freq_cpm=response.mtf.freq_cpp / gsd_m,
        mtf=response.mtf.value,
        nyquist_cpm=0.5 / gsd_m,
    )


def psf_on_the_ground(
    sensor: Sensor, half_width_m: float = 5.0, step_m: float = 0.1
) -> tuple[Floats, Floats]:
    """Point spread function around its origin on the ground, pixel area included.

    As `Sensor.psf`, on a grid that is square in metres even where pixels are not.

    Parameters
    ----------
    sensor : Sensor
        With a GSD.
    half_width_m : float, optional
        Half the width of the returned square, below 32 pixels.
    step_m : float, optional
        Spacing of the grid, below half a pixel.

    Returns
    -------
    distance_m : (n,) array
        Places along either axis.
    psf : (n, n) array
        Light per square metre at (row, column) distances; its integral over the plane is 1.

    Raises
    ------
    OptionError
        If there is no sensor, or half width or step is no number.
    ModelError
        If the sensor has no GSD, or the grid is too coarse or too wide.
    """
    require_sensor(sensor)
    require_numbers(half_width_m=half_width_m, step_m=step_m)
    if sensor.pixel_m is None:
        raise ModelError("a PSF on the ground needs the GSD: give gsd_m to the sensor")
    row_m, col_m = sensor.pixel_m
    small, large = min(row_m, col_m), max(row_m, col_m)
    if not (0 < step_m < 0.5 * small and step_m <= half_width_m < 32 * small):
        raise ModelError(
            f"a PSF of half width {half_width_m:g} m in steps of {step_m:g} m was requested: the "
            f"step has to be below {0.5 * small:g}, the half width between one step and "
            f"{32 * small:g}"
        )
    return spread_over_plane(
        lambda u, v: np.asarray(sensor.otf(u * col_m, v * row_m)),
        half_width_m,
        step_m,
        32.0 * large,
    )
