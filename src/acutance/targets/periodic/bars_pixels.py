"""The pixels of a group of bars, and the image of every mode of a transfer function there."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.errors import NoBarsError
from acutance.geometry.bar_group import Bars
from acutance.numerics.lookup import CubicLookup
from acutance.numerics.otf_modes import HIGHEST_CPP, Complexes, MeanOtf, ProcessModes
from acutance.targets.periodic.otf_model import all_modes, mode_count

__all__ = ["SIDE_PX", "GroupPixels", "group_columns", "pixels_about"]

SIDE_PX: Final = 8.0
"""How far to the sides of the bars the pixels of a group go."""
_END_MARGIN_PX: Final = 5.0
_STEP_PX: Final = 0.05
_MAX_COLUMNS: Final = 1 << 31


@dataclass(frozen=True, eq=False)
class GroupPixels:
    """The pixels of a group.

    Attributes
    ----------
    bars : Bars
        Where the group is taken to be.
    rows, cols : (n,) int arrays
    value : (n,) array
        The pixels.
    across, along : (n,) arrays
        Their distances from the centre along the normal and along the bars, px.
    """

    bars: Bars
    rows: NDArray[np.intp]
    cols: NDArray[np.intp]
    value: Floats
    across: Floats
    along: Floats

    @classmethod
    def of(cls, image: Floats, bars: Bars, number: int) -> GroupPixels:
        """The usable pixels between the bars' ends and some way to its sides."""
        rows, cols = pixels_about(image, bars)
        across, along = bars.across_and_along(rows.astype(float), cols.astype(float))
        margin = min(_END_MARGIN_PX, 0.25 * bars.length_px)
        kept = np.abs(along) < 0.5 * bars.length_px - margin
        kept &= np.abs(across) < 0.5 * bars.width_px + SIDE_PX
        if np.count_nonzero(kept & (np.abs(across) < 0.5 * bars.width_px)) < 40:
            raise NoBarsError(
                f"group {number} of {bars.count} bars with a period of {bars.period_px:.2f} px at "
                f"row {bars.row:.1f}, column {bars.col:.1f} holds fewer than 40 usable pixels: it "
                "lies outside the region, or its bars are too short"
            )
        rows, cols = rows[kept], cols[kept]
        return cls(bars, rows, cols, image[rows, cols], across[kept], along[kept])

    def taken_over(self, before: GroupPixels, values: Floats, new: float) -> Floats:
        """What pixels had where the group was before, (n,); `new` for those it takes in."""
        was, now = (one.rows * _MAX_COLUMNS + one.cols for one in (before, self))
        # Both ascend.
        place = np.minimum(np.searchsorted(was, now), was.size - 1)
        return np.where(was[place] == now, values[place], new)

    def moved(self, step: Floats) -> Bars:
        """The group where the regression wants it: place, period, direction (radians)."""
        bars = self.bars
        place = float(np.clip(step[0], -0.25 * bars.period_px, 0.25 * bars.period_px))
        most = 0.2 * bars.period_px / bars.count
        period = bars.period_px + float(np.clip(step[1], -most, most))
        reach = 0.5 * bars.period_px / bars.length_px
        x, y = unit_vector(bars.normal_deg)
        return replace(
            bars,
            row=bars.row + place * y,
            col=bars.col + place * x,
            period_px=period,
            normal_deg=bars.normal_deg + math.degrees(float(np.clip(step[2], -reach, reach))),
        )


def pixels_about(image: Floats, bars: Bars) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows and columns of the usable pixels of a group, 8 px to its sides, and some more.

    A group is a small part of a large image.
    """
    reach = math.ceil(math.hypot(0.5 * bars.length_px, 0.5 * bars.width_px + SIDE_PX)) + 1
    top, left = (max(math.floor(place) - reach, 0) for place in (bars.row, bars.col))
    bottom, right = (max(math.ceil(place) + reach + 1, 0) for place in (bars.row, bars.col))
    rows, cols = np.nonzero(np.isfinite(image[top:bottom, left:right]))
    return rows + top, cols + left


def group_columns(
    pixels: GroupPixels, blur: MeanOtf, states: ProcessModes | None, contrast: float
) -> tuple[Floats, Floats]:
    """The images of all modes, and the group's own columns.

    Returns
    -------
    modes : (n, m) array
        Images of the modes, of endless bars with unit contrast.
    own : (n, 5) array
        Level, slope, and by place along the normal (px), period (px) and direction (radians).
    """
    reach = float(np.max(np.abs(pixels.across))) + 1.0
    places, table = _profiles(pixels.bars, blur, states, reach)
    looked = CubicLookup.of(pixels.across, places)(table)
    by_place = contrast * looked[:, -2]
    own = (
        np.ones(by_place.size), pixels.across / reach, by_place, contrast * looked[:, -1],
        # A turn of the normal moves pixels along it by their distance along the bars.
        -pixels.along * by_place,
    )  # fmt: skip
    return looked[:, :-2], np.stack(own, axis=1)


def _profiles(
    bars: Bars, blur: MeanOtf, states: ProcessModes | None, reach: float
) -> tuple[Floats, Floats]:
    """Images of all modes along the normal, then the mean's by place and by period.

    Returns
    -------
    places : (n,) array
    table : (n, m + 2) array
    """
    count = math.ceil(reach / _STEP_PX) + 4
    step = 1 / (2 * reach + bars.width_px + 30.0)
    freq: Floats = np.asarray(step * (np.arange(math.ceil(HIGHEST_CPP / step)) + 0.5))
    x, y = unit_vector(bars.normal_deg)
    u, v = freq * x, freq * y
    spectrum, mean = bars.spectrum(freq), blur.otf(u, v)
    small = 1e-4
    change = (
        replace(bars, period_px=bars.period_px + small).spectrum(freq)
        - replace(bars, period_px=bars.period_px - small).spectrum(freq)
    ) / (2 * small)
    spectra = np.column_stack([
        spectrum[:, None] * all_modes(blur, mode_count(states), u, v),
        -2j * math.pi * freq * spectrum * mean,
        change * mean,
    ])  # fmt: skip
    waves = _waves(count, freq)
    even, odd = (
        2 * step * _products(*parts)
        for parts in ((waves.real, spectra.real), (waves.imag, spectra.imag))
    )
    places = np.asarray(_STEP_PX * np.arange(1 - count, count))
    return places, np.concatenate([(even + odd)[:0:-1], even - odd])


def _waves(count: int, freq: Floats) -> Complexes:
    """Waves ``exp(2 pi i f s)`` at so many places s of the table from 0 on, (count, n).

    Products of those at every sixteenth place and those within the first sixteen.
    """
    some = 16
    far = np.arange(0, count, some)
    coarse, fine = (
        np.exp(2j * math.pi * _STEP_PX * np.outer(steps, freq)) for steps in (far, np.arange(some))
    )
    return np.asarray((coarse[:, None] * fine).reshape(-1, freq.size)[:count])


def _products(left: Floats, right: Floats) -> Floats:
    """The product of two matrices: columns of the right one that are zero are left out.

    Most modes are real or imaginary.
    """
    kept = right.any(axis=0)
    found = np.zeros((len(left), right.shape[1]))
    found[:, kept] = np.ascontiguousarray(left) @ right[:, kept]
    return found
