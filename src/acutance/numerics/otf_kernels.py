"""Kernels of ground processing as directions of a two-dimensional transfer function.

A product that was sharpened or restored is a blurred image convolved with a kernel: its optical
transfer function (OTF) is that of the blur times ``sum t_ij exp(-2 pi i (i v + j u))``, with taps
whole pixels apart. The states of `otf_modes` are shapes about the middle in units of the blur's
width: of taps 3 to 7 pixels away they follow little. So the taps have directions of their own, in
pixels, learned from `acutance.optics.FAMILIES` (`learn_kernels`), and with an amplitude of their
own that the data determine.
"""

from __future__ import annotations

import math
from functools import cache
from importlib.resources import files
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.otf_modes import Complexes, MeanOtf

__all__ = [
    "KERNEL_LOG_AMPLITUDE",
    "KERNEL_REACH",
    "blur_before",
    "kernel_modes",
    "kernel_taps",
    "turns",
]

KERNEL_REACH: Final = 7
"""Furthest taps of a kernel, rows or columns from its middle."""

KERNEL_LOG_AMPLITUDE: Final = -3.0
"""Expected amplitude of the directions relative to that of processed products, as few are."""

_SHARPER_PX2: Final = 0.1
"""Variance by which a processed product's Gaussian is narrower than that of the blur before."""


def blur_before(mean: MeanOtf) -> MeanOtf:
    """The Gaussian through a pixel that kernels act on: wider than the product's own."""
    return MeanOtf(mean.xx + _SHARPER_PX2, mean.xy, mean.yy + _SHARPER_PX2, mean.aperture_px)


@cache
def kernel_taps() -> Floats:
    """Taps of every direction, (15, 15, k), by rows and columns from the middle."""
    path = files("acutance.numerics").joinpath("otf_families.npz")
    with path.open("rb") as file, np.load(file, allow_pickle=False) as learned:
        return np.asarray(learned["kernels"], float)


def kernel_modes(mean: MeanOtf, u_cpp: Floats, v_cpp: Floats) -> Complexes:
    """OTF of the blur times every direction of taps, at frequencies (n,), (n, k)."""
    found = _of_taps(u_cpp, v_cpp)
    found *= blur_before(mean).otf(u_cpp, v_cpp)[:, None]
    return found


def _of_taps(u_cpp: Floats, v_cpp: Floats) -> Complexes:
    """OTF of every direction of taps alone, (n, k).

    Taps opposite one another have conjugate transfers: their sum goes with the real part of one,
    their difference with its imaginary part.
    """
    middle, even, odd = _opposite_taps()
    half = turns(v_cpp)[:, : KERNEL_REACH + 1, None] * turns(u_cpp)[:, None, :]
    half = half.reshape(u_cpp.size, -1)[:, : len(even)]
    found = np.empty((u_cpp.size, middle.size), complex)
    found.real = middle + half.real.copy() @ even
    found.imag = half.imag.copy() @ odd
    return found


@cache
def _opposite_taps() -> tuple[Floats, Floats, Floats]:
    """Taps of every direction in the middle, (k,), and before it: with the opposite ones added and
    taken off, (112, k) each."""
    taps = kernel_taps().reshape(-1, kernel_taps().shape[-1])
    half = len(taps) // 2
    before, behind = taps[:half], taps[:half:-1]
    return taps[half], before + behind, before - behind


def turns(freq_cpp: Floats) -> Complexes:
    """Transfer of a tap by its distance, of frequencies (n,), (n, 15)."""
    places = np.arange(-KERNEL_REACH, KERNEL_REACH + 1)
    return np.asarray(np.exp(-2j * math.pi * np.multiply.outer(freq_cpp, places)))
