"""Where the star of an image is: its centre, its phase, its rim, the directions it holds.

Spokes change only round the centre, so every gradient stands at right angles to the radius:
``g . (x - centre) = 0`` is a linear equation for the centre, which needs no guess and holds for a
fan too. The spokes' phase along the rings then moves the centre to where the rings agree.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from scipy import ndimage

from acutance.curves.grid import Floats
from acutance.errors import NoStarError
from acutance.geometry.star_geometry import Flags, SiemensStar
from acutance.targets.periodic.part_waves import PartWaves
from acutance.targets.periodic.star_extent import extent_of
from acutance.targets.periodic.star_rings import rings_of, sector_of
from acutance.targets.periodic.star_strength import PixelsAbout
from acutance.targets.periodic.tuned import MIN_STAR_STRENGTH

__all__ = ["find_star"]

_SMOOTH_PX = 1.5
_LOCAL_PX = 4.0
_COARSE_CPP = 0.3
"""Spokes finer than this do not take part in finding the star: they are aliased or faint."""
_SECTORS = 10
_SECTOR_CYCLES = 2.0
_SURE_STRENGTH = 0.95
"""Share of the rings that no wrong number of cycles explains: one next to the true one .32 of a
whole star, some .8 of three quarters of one."""
_LIKELY_COUNTS, _NEXT_COUNTS = 3, (-2, -1, 1, 2)
"""Other numbers that are counted: the likeliest in parts of turns, and those next to the stated."""


def find_star(
    image: Floats, cycles: int | None, centre: tuple[float, float] | None = None
) -> SiemensStar:
    """Find the one star of an image.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where there is nothing to use.
    cycles : int or None
        Periods in a full turn; None counts them.
    centre : (row, col), optional
        Where to look for the centre, to some pixels.

    Raises
    ------
    NoStarError
        If nothing in the image is a star, or it has another number of cycles.
    """
    known = np.isfinite(image)
    filled = np.where(known, image, float(np.mean(image[known])))
    smooth = ndimage.gaussian_filter(filled, _SMOOTH_PX)
    usable = ndimage.binary_erosion(known, iterations=3, border_value=0)
    if not usable.any() or float(np.ptp(smooth[usable])) == 0.0:
        raise NoStarError(
            "the region is uniform, without spokes: choose a region that holds the star"
        )
    row, col = _gradient_centre(smooth, usable) if centre is None else centre
    lively = usable & _is_lively(smooth)
    if not lively.any():
        raise NoStarError(
            "all structure of the region lies next to pixels without data: choose a region that "
            "holds the star, with some pixels around it"
        )
    farthest = _farthest(lively, row, col)
    local = _strengths(smooth, lively, (row, col), farthest, cycles, sectors=_SECTORS)
    _require_spokes(local, cycles, row, col, farthest)
    first = max(local, key=lambda n: local[n]) if cycles is None else cycles
    start = SiemensStar(row, col, first, 0.0, farthest)
    found = _settled(smooth, lively, start)
    likely = sorted(local, key=lambda n: -local[n])[:_LIKELY_COUNTS]
    others = {*likely, *(first + k for k in _NEXT_COUNTS)} & local.keys()
    if cycles is not None:
        _require_count(smooth, lively, start, _strength(smooth, lively, found), others)
    else:
        whole = _strengths(smooth, lively, (found.row, found.col), farthest, None)
        found = _counted(smooth, lively, start, found, whole, others)
    return extent_of(smooth, usable, found, found.radius_at(_COARSE_CPP))


def _counted(
    smooth: Floats,
    lively: Flags,
    start: SiemensStar,
    found: SiemensStar,
    whole: dict[int, float],
    others: Iterable[int],
) -> SiemensStar:
    """The star whose cycles explain the rings best.

    `whole` has the share that each number explains about the centre of `found`. Unless one of
    them is sure, others are counted about the centres that they lead to themselves.
    """
    best = max(whole, key=lambda n: whole[n])
    if whole[best] < _SURE_STRENGTH:
        about = {n: _about_own(smooth, lively, replace(start, cycles=n)) for n in others}
        own = max(about, key=lambda n: about[n][1], default=best)
        if own in about and about[own][1] > whole[best]:
            return about[own][0]
    return found if best == found.cycles else _settled(smooth, lively, replace(found, cycles=best))


def _about_own(smooth: Floats, lively: Flags, start: SiemensStar) -> tuple[SiemensStar, float]:
    """A star about the centre that its cycles lead to, and the share of the rings they explain."""
    try:
        star = _settled(smooth, lively, start)
    except NoStarError:
        return start, 0.0
    return star, _strength(smooth, lively, star)


def _strength(smooth: Floats, lively: Flags, star: SiemensStar) -> float:
    """The share of the rings that the cycles of a star explain about its centre."""
    about = PixelsAbout.of(smooth, lively, star.row, star.col)
    return about.strength(star.cycles, star.radius_at(_COARSE_CPP), star.rim_px, 1)


def _settled(smooth: Floats, lively: Flags, star: SiemensStar) -> SiemensStar:
    """Centre and phase after some steps of `_agreed`."""
    for _ in range(8):
        moved = _agreed(smooth, lively, star)
        step = math.hypot(moved.row - star.row, moved.col - star.col)
        star = moved
        if step < 0.005:
            break
    return star


def _is_lively(smooth: Floats) -> Flags:
    """Where there is structure: the spokes, not what lies next to a fan."""
    wave = smooth - ndimage.gaussian_filter(smooth, _LOCAL_PX)
    power = ndimage.gaussian_filter(wave**2, _LOCAL_PX)
    return np.asarray(power > 0.15 * np.quantile(power, 0.97))


def _gradient_centre(smooth: Floats, usable: Flags) -> tuple[float, float]:
    """The point most gradients turn round, by least squares with bounded influence."""
    down, right = (np.asarray(slope, float) for slope in np.gradient(smooth))
    rows, cols = np.nonzero(usable)
    gy, gx = down[usable], right[usable]
    power = gx**2 + gy**2
    strong = power > 0.05 * np.quantile(power, 0.98)
    rows, cols, gx, gy, power = (a[strong] for a in (rows, cols, gx, gy, power))
    length = np.sqrt(power)
    nx, ny = gx / length, gy / length
    offset = nx * cols + ny * rows
    weight = length.copy()
    centre = np.array([0.5 * smooth.shape[1], 0.5 * smooth.shape[0]])
    scale = 0.25 * min(smooth.shape)
    for _ in range(25):
        a = np.array(
            [
                [np.sum(weight * nx * nx), np.sum(weight * nx * ny)],
                [np.sum(weight * nx * ny), np.sum(weight * ny * ny)],
            ]
        )
        b = np.array([np.sum(weight * nx * offset), np.sum(weight * ny * offset)])
        if np.linalg.cond(a) > 1e6:
            raise NoStarError(
                "all structure in the region runs one way: that is an edge or bars, not the "
                "spokes of a star; choose a region around the star"
            )
        centre = np.linalg.solve(a, b)
        miss = nx * centre[0] + ny * centre[1] - offset
        scale = max(0.7 * scale, 1.0)
        weight = length / (1 + (miss / scale) ** 2)
    return float(centre[1]), float(centre[0])


def _strengths(
    smooth: Floats,
    usable: Flags,
    centre: tuple[float, float],
    farthest: float,
    cycles: int | None,
    sectors: int = 1,
) -> dict[int, float]:
    """How much of the rings each number of cycles explains, in so many parts of them.

    A part holds a cycle or more: within less of one, a wave hardly changes.
    """
    counts = set(range(4, 201)) if cycles is None else {cycles, *range(4, 201)}
    pixels, found = PixelsAbout.of(smooth, usable, *centre), {}
    for n in sorted(counts):
        first = n / (2 * math.pi * _COARSE_CPP)
        if first < 0.85 * farthest:
            found[n] = pixels.strength(n, first, farthest, min(sectors, n))
    return found


def _require_spokes(
    strength: dict[int, float], cycles: int | None, row: float, col: float, farthest: float
) -> None:
    if not strength or (cycles is not None and cycles not in strength):
        raise NoStarError(
            f"{cycles or 'all'} cycles are finer than {_COARSE_CPP:g} c/px everywhere within "
            f"{farthest:.0f} px of the centre found at row {row:.1f}, column {col:.1f}: the star "
            "is too small, or the region does not hold it"
        )
    best = max(strength, key=lambda n: strength[n])
    if strength[best] < MIN_STAR_STRENGTH:
        raise NoStarError(
            f"no star: about row {row:.1f}, column {col:.1f}, where the structure points to, "
            f"spokes explain {100 * strength[best]:.0f} % of the rings at best; choose a region "
            "around the star, or give its centre"
        )


def _require_count(
    smooth: Floats, lively: Flags, start: SiemensStar, own: float, others: Iterable[int]
) -> None:
    """Refuse a star whose rings are explained better by another number of cycles.

    Each number is counted about the centre that it leads to itself: about a centre that is off, a
    wrong one explains a third of the rings and more than the true one does there.
    """
    if own >= _SURE_STRENGTH:
        return
    best, strength = start, own
    for n in sorted(others):
        star, found = _about_own(smooth, lively, replace(start, cycles=n))
        if found > strength:
            best, strength = star, found
    is_alike = strength < 1.5 * own and 1 - strength > 0.5 * (1 - own)
    if own >= MIN_STAR_STRENGTH and is_alike:
        return
    shown = f"the rings show {best.cycles}" if strength > MIN_STAR_STRENGTH else "no number fits"
    raise NoStarError(
        f"a star of {start.cycles} cycles was asked for, but about row {best.row:.1f}, column "
        f"{best.col:.1f} {shown}: check the number of cycles and the region, and whether a slanted "
        "view or pixels that are not square make an ellipse of the star"
    )


def _farthest(usable: Flags, row: float, col: float) -> float:
    rows, cols = np.nonzero(usable)
    return float(np.quantile(np.hypot(rows - row, cols - col), 0.98))


def _cells(rings: Sequence[tuple[float, Floats, Floats]], cycles: int) -> Floats:
    """Radius, direction, phasor and weight of the wave in cells of two cycles by a ring, (5, n).

    Parameters
    ----------
    rings : sequence of (radius, angles, values)
    cycles : int
    """
    if not rings:
        return np.zeros((5, 0))
    sectors = max(round(cycles / _SECTOR_CYCLES), 1)
    count = len(rings) * sectors
    ring = np.repeat(np.arange(len(rings)), [angle.size for _, angle, _ in rings])
    angle, value = (np.concatenate(column) for column in list(zip(*rings, strict=True))[1:])
    cell = ring * sectors + sector_of(angle, sectors)
    waves = PartWaves.of(cell, cycles * angle, value - float(np.mean(value)), count)
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, cell, angle)
    np.maximum.at(high, cell, angle)
    kept = waves.has_enough & (high - low >= 2.0 / cycles)
    sizes, cosine, sine = waves.sizes[kept], waves.cosine[kept], waves.sine[kept]
    power = cosine**2 + sine**2
    share = power / (power + 2 * waves.rest[kept] / sizes + 1e-300)
    radius = np.repeat([one for one, _, _ in rings], sectors)[kept]
    middle = np.bincount(cell, angle, minlength=count)[kept] / sizes
    return np.array([radius, middle, cosine, -sine, power * share**4])


def _agreed(smooth: Floats, usable: Flags, star: SiemensStar) -> SiemensStar:
    """Move centre and phase to where the spokes have one phase, in all rings and directions.

    In cells of two cycles by a ring, the phase of ``cos(k phi + alpha)`` about a centre that is
    off by (dx, dy) differs by ``k (dx sin phi - dy cos phi) / r``: linear least squares.
    """
    k = star.cycles
    rings = rings_of(smooth, usable, star.row, star.col, star.radius_at(_COARSE_CPP), star.rim_px)
    radius, angle, real, imaginary, weight = _cells(rings, k)
    if radius.size < 6:
        raise NoStarError("the rings of the star hold too few pixels: choose a larger region")
    phasor = (real + 1j * imaginary) / np.maximum(np.hypot(real, imaginary), 1e-300)
    weight *= radius**2
    alpha = float(np.angle(np.sum(weight * phasor)))
    design = np.stack(
        [np.ones(radius.size), k * np.sin(angle) / radius, -k * np.cos(angle) / radius], axis=1
    )
    step = np.zeros(3)
    for _ in range(6):
        off = np.angle(phasor * np.exp(-1j * (alpha + design @ step)))
        bounded = weight / (1 + (off / 0.5) ** 2) ** 2
        root = np.sqrt(bounded)
        more, *_ = np.linalg.lstsq(root[:, None] * design, root * off, rcond=1e-6)
        step += more
    most = 0.3 * star.rim_px
    move = np.clip(step[1:], -most, most)
    return replace(
        star,
        col=star.col + float(move[0]),
        row=star.row + float(move[1]),
        alpha_rad=math.remainder(alpha + float(step[0]), 2 * math.pi),
    )
