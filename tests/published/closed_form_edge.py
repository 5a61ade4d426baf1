"""Edges whose response along the normal is a closed form, as bands ready to be measured."""

import math

import numpy as np

from acutance.geometry.line import Line
from acutance.targets.straight.pixels import EdgePixels

_erf = np.vectorize(math.erf)


def gaussian_pixel_esf(distance_px, sigma_px=0.4):
    """ESF of a Gaussian convolved with a unit pixel."""

    def integral(u):
        return u * 0.5 * (1 + _erf(u / math.sqrt(2))) + np.exp(-u * u / 2) / math.sqrt(2 * np.pi)

    upper, lower = (distance_px + 0.5) / sigma_px, (distance_px - 0.5) / sigma_px
    return sigma_px * (integral(upper) - integral(lower))


def gaussian_pixel_mtf(freq_cpp, sigma_px=0.4):
    """MTF of a Gaussian convolved with a unit pixel."""
    return np.exp(-2 * (np.pi * sigma_px * freq_cpp) ** 2) * np.sinc(freq_cpp)


def edge_band(
    esf=gaussian_pixel_esf,
    *,
    angle_deg=6.0,
    shape=(60, 40),
    offset_px=0.13,
    snr=None,
    rng=None,
    dark=200.0,
    bright=1200.0,
):
    """A band with the edge through its middle, rising in the direction `angle_deg`."""
    rows, cols = shape
    angle = math.radians(angle_deg)
    line = Line(
        (rows - 1) / 2 + offset_px * math.sin(angle),
        (cols - 1) / 2 + offset_px * math.cos(angle),
        angle_deg,
    )
    row, col = np.mgrid[:rows, :cols]
    image = dark + (bright - dark) * esf(line.normal_distance(row, col))
    noise = 0.0
    if snr is not None:
        noise = (bright - dark) / snr
        image = image + rng.normal(0.0, noise, shape)
    return EdgePixels(image, line, dark, bright, 0.5, noise)
