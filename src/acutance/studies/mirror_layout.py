"""Where convex mirrors of an array stand: slanted columns or a square, and their phases.

Mirrors in slanted columns step by an integer plus 1/p pixels across and an integer plus 1/q along,
with p and q coprime: after p q mirrors every combination of phases was seen once. 20 mirrors give
p = 4 and q = 5: steps of 1.25 by 10.2 GSD, 7 degrees, as in Brookings in 2003 (QuickBird report,
5.7.2). A square of n by n mirrors has one pitch, an integer plus 1/n: 4 by 4 at 5.25 px, as Li et
al. (2.2) show it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from acutance.arguments import require_choice, require_finite, require_place, require_whole
from acutance.curves.grid import Floats
from acutance.targets.points.checks import phase_gap_px

__all__ = ["MIN_SPACING_PX", "Arrangement", "MirrorLayout", "lay_out_mirrors"]

Arrangement = Literal["columns", "square"]

MIN_SPACING_PX = 5.0
"""Sources nearer to one another than that overlap."""


@dataclass(frozen=True, eq=False)
class MirrorLayout:
    """Where the mirrors stand, relative to the first one.

    Parameters
    ----------
    places_px : (n, 2) array
        (along, across) in pixels: rows downwards, columns to the right.
    step_px : (float, float)
        (along, across) from one mirror of a column to the next; of a square, its pitch both ways.
    apart_px : float
        Distance of the columns; of a square, its pitch.
    pixel_m : (float, float)
        GSD (along, across) in metres.
    """

    places_px: Floats
    step_px: tuple[float, float]
    apart_px: float
    pixel_m: tuple[float, float]

    @property
    def places_m(self) -> Floats:
        """The same in metres, (n, 2)."""
        return np.asarray(self.places_px * np.array(self.pixel_m))

    @property
    def angle_deg(self) -> float:
        """Angle of a column against the image's columns."""
        return math.degrees(math.atan2(self.step_px[1], self.step_px[0]))

    @property
    def phases(self) -> Floats:
        """Sub-pixel places (along, across), 0 to 1, (n, 2)."""
        return np.asarray(np.mod(self.places_px + 1e-9, 1.0))

    @property
    def spacing_px(self) -> float:
        """Distance of the two nearest mirrors."""
        if self.places_px.shape[0] < 2:
            return math.inf
        away = np.linalg.norm(self.places_px[:, None] - self.places_px, axis=2)
        return float(away[away > 0].min())

    def gap_px(self, gsd_change: float = 0.0) -> float:
        """Largest gap of the phases, when the GSD is larger by a share than planned."""
        require_finite(gsd_change=gsd_change)
        return phase_gap_px(self.places_px / (1 + gsd_change))


def lay_out_mirrors(
    count: int,
    *,
    pixel_m: tuple[float, float],
    arrangement: Arrangement = "columns",
    columns: int = 2,
    spacing_px: float = 10.0,
) -> MirrorLayout:
    """Places of mirrors whose phases fill the pixel evenly.

    Parameters
    ----------
    count : int
    pixel_m : (float, float)
        GSD (along, across) in metres.
    arrangement : {"columns", "square"}, optional
    columns : int, optional
        Number of slanted columns.
    spacing_px : float, optional
        Least distance along a column, or pitch of the square.

    Raises
    ------
    OptionError, ModelError
        If an argument is of the wrong kind, or a number is not finite.
    """
    require_whole(1, count=count, columns=columns)
    require_finite(spacing_px=spacing_px)
    require_choice(get_args(Arrangement), arrangement=arrangement)
    require_place(pixel_m=pixel_m)
    if arrangement == "square":
        side = math.ceil(math.sqrt(count))
        pitch = math.ceil(spacing_px - 1e-9) + (1 / side if side > 1 else 0.0)
        rows, cols = np.divmod(np.arange(count), side)
        places = np.stack([rows, cols], axis=1) * pitch
        return MirrorLayout(places, (pitch, 0.0), pitch, pixel_m)
    across, along = _coprime_phases(count)
    step = (math.ceil(spacing_px - 1e-9) + 1 / along, 1 + 1 / across)
    rows_each = math.ceil(count / columns)
    # The next column goes on where the phases of the one before ended.
    place = np.arange(count) % rows_each
    column = np.arange(count) // rows_each
    shift = np.array([math.fmod(rows_each * one, 1.0) for one in step])
    apart = max(math.ceil(spacing_px - 1e-9) + 1 + shift[1], MIN_SPACING_PX)
    places = np.stack(
        [place * step[0] + column * shift[0], place * step[1] + column * apart], axis=1
    )
    return MirrorLayout(places, step, float(apart), pixel_m)


def _coprime_phases(count: int) -> tuple[int, int]:
    """Numbers of phases across and along: coprime, nearly equal, their product enough for all."""
    pairs = [
        (p, q)
        for q in range(1, count + 2)
        for p in range(1, q + 1)
        if math.gcd(p, q) == 1 and p * q >= count
    ]
    return min(pairs, key=lambda pair: (pair[0] * pair[1] - count + 2 * (pair[1] - pair[0]), pair))
