"""The sharpest consistent population of bright spots: the points among objects of all sizes.

In a field of the sky most spots are galaxies, and no two of them have the same size; stars all have
that of the PSF, whatever their brightness, and nothing that passed the optics is sharper. So the
points are not the majority: they are the densest place among the sizes of the spots and, of several
dense places, the sharpest. A cosmic ray may be sharper, but no two of them have the same shape.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.targets.points import tuned
from acutance.targets.points.moments import SpotShape

__all__ = ["Population", "densest_sharpest", "sharpest_population"]

_CENTRINGS: Final = 6


@dataclass(frozen=True, eq=False)
class Population:
    """The points among bright spots.

    Parameters
    ----------
    shapes : sequence of n SpotShape
    narrow_px2, wide_px2 : float
        Median variances of the points along the minor and the major axis.
    members : (n,) bool array
        Which spots have that size, within their own uncertainty.
    wider : (n, 2) bool array
        Which spots are significantly wider along the minor, and along the major axis.
    confused : (n,) float array
        Of the spots bright enough to be judged, the share of wider ones among those that would
        pass for points if they were as faint as this one.
    mixed : bool
        Whether there are so many wider spots that this is a field of stars and galaxies.
    distinct : bool
        Whether clearly more spots have this size than sizes next to it: galaxies alone have a
        densest size, too, but no gap around it.
    """

    shapes: Sequence[SpotShape]
    narrow_px2: float
    wide_px2: float
    members: NDArray[np.bool_]
    wider: NDArray[np.bool_]
    confused: Floats
    mixed: bool
    distinct: bool

    def fault(self, index: int) -> tuple[str, str] | None:
        """Why a spot is no member of a mixed field's points: reason and message."""
        shape = self.shapes[index]
        points = f"{self.narrow_px2:.2f} and {self.wide_px2:.2f} px²"
        found = f"variances of {shape.narrow_px2:.2f} and {shape.wide_px2:.2f} px² along its axes"
        narrow_wider, wide_wider = self.wider[index].tolist()
        if not self.distinct:
            return "extended", f"{found}, and as many spots have the sizes around {points}"
        if wide_wider and not narrow_wider:
            return "blended", f"{found}, those of points are {points}: it is wider one way"
        if not self.members[index]:
            return "extended", f"{found}, those of points are {points}"
        if self.confused[index] > tuned.MAX_CONFUSED:
            share = 100 * float(self.confused[index])
            return (
                "faint",
                f"of spots as faint as it, {share:.0f} % that look like points are wider",
            )
        return None


def sharpest_population(shapes: Sequence[SpotShape]) -> Population | None:
    """The sharpest consistent population.

    Parameters
    ----------
    shapes : sequence of SpotShape
        Of spots that have no fault of their own.

    Returns
    -------
    Population or None
        Without one if too few spots are bright enough for their sizes to be compared.
    """
    sizes = np.array([(one.narrow_px2, one.wide_px2) for one in shapes]).reshape(-1, 2)
    noise = np.array([(one.narrow_std_px2, one.wide_std_px2) for one in shapes]).reshape(-1, 2)
    std = np.hypot(noise, _tolerance(sizes) * np.abs(sizes) + tuned.MIN_SIZE_STD_PX2)
    precise = (sizes[:, 0] > 0) & np.all(noise < tuned.PRECISE_SIZE * sizes, axis=1)
    if precise.sum() < tuned.MIN_COMPARED:
        return None
    middle = densest_sharpest(sizes[precise], std[precise])
    if middle is None:
        middle = sizes[precise][np.argmin(sizes[precise].sum(axis=1))]
    away = (sizes - middle) / std
    distance = np.hypot(*away.T)
    members = distance < tuned.SAME_SIZE_SIGMAS
    around = ~members & (distance < 2 * tuned.SAME_SIZE_SIGMAS)
    narrow, wide = middle.tolist()
    return Population(
        shapes,
        narrow,
        wide,
        members,
        away > tuned.SAME_SIZE_SIGMAS,
        _confused(sizes.mean(axis=1), std.mean(axis=1), float(middle.mean()), precise, members),
        _is_mixed(sizes[precise], std[precise], middle),
        int((precise & members).sum()) >= int((precise & around).sum()) + tuned.MIN_POPULATION,
    )


def _tolerance(sizes: Floats) -> Floats:
    """How far variances of one PSF scatter beside the noise, as a share, (n, 1).

    What lies within a pixel or two shows different variances at different places within its pixel,
    unless it is a Gaussian: the sharper the PSF, the more.
    """
    sharp = np.clip((tuned.SAMPLED_PX2 - sizes[:, :1]) / tuned.SHARP_PX2, 0.0, 1.0)
    return np.asarray(tuned.SIZE_TOLERANCE + tuned.SHARP_TOLERANCE * sharp)


def densest_sharpest(sizes: Floats, std: Floats) -> Floats | None:
    """The middle of the sharpest dense place among sizes.

    Parameters
    ----------
    sizes, std : (n, d) arrays
        Sizes along d axes, and their standard deviations.

    Returns
    -------
    (d,) array or None
        The median of the sizes there; without one where fewer than five sizes agree.
    """
    together = std[:, None] ** 2 + std[None] ** 2
    apart = ((sizes[:, None] - sizes[None]) ** 2 / together).sum(axis=2)
    near = np.exp(-0.5 * apart) / np.sqrt(together.prod(axis=2))
    np.fill_diagonal(near, 0.0)
    density = near.sum(axis=1) * np.abs(sizes).prod(axis=1)
    dense = np.flatnonzero(density >= tuned.DENSE_SHARE * density.max())
    # What optics leave is wider than a pixel alone, unless a product is sharpened: a few spots as
    # narrow as that are cosmic rays.
    likely = dense[(sizes[dense, 0] > tuned.MIN_POINT_PX2) | (density[dense] == density.max())]
    for first in likely[np.argsort(sizes[likely].sum(axis=1))]:
        middle = _centred(sizes, std, sizes[first])
        if middle is not None:
            return middle
    return None


def _centred(sizes: Floats, std: Floats, middle: Floats) -> Floats | None:
    """The median of the sizes that agree with a middle, which moves there; None if they are few."""
    for _ in range(_CENTRINGS):
        away = np.sqrt((((sizes - middle) / std) ** 2).sum(axis=1))
        agree = away < tuned.SAME_SIZE_SIGMAS
        if agree.sum() < tuned.MIN_POPULATION:
            return None
        middle = np.median(sizes[agree], axis=0)
    return np.asarray(middle)


def _is_mixed(sizes: Floats, std: Floats, middle: Floats) -> bool:
    """Whether many sizes differ by more than those of one PSF that varies over the field."""
    doubt, ratio = tuned.SAME_SIZE_SIGMAS * std, tuned.EXTENDED_RATIO
    larger = sizes[:, 1] - doubt[:, 1] > ratio * middle[1]
    smaller = (sizes[:, 0] + doubt[:, 0]) * ratio < middle[0]
    odd = int((larger | smaller).sum())
    return odd >= float(max(tuned.MIN_ODD, tuned.MIXED_SHARE * sizes.shape[0]))


def _confused(
    size: Floats,
    std: Floats,
    middle: float,
    precise: NDArray[np.bool_],
    members: NDArray[np.bool_],
) -> Floats:
    """Share of wider spots among those that a spot's own uncertainty cannot tell from points."""
    points = max(int((precise & members).sum()), 1)
    extended = np.sort((size - middle)[precise & ~members & (size > middle)])
    passing = np.searchsorted(extended, tuned.CONFUSED_SIGMAS * std)
    return np.asarray(passing / (passing + points))
