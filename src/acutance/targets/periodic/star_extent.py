"""How far a star goes: its rim, and the directions it holds."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import NoStarError
from acutance.geometry.star_geometry import Flags, SiemensStar
from acutance.targets.periodic.star_rings import members_of, sector_of

__all__ = ["extent_of"]

_SECTOR_CYCLES = 2.0
_WHOLE = 0.9
"""Share of the amplitude from which on a sector is whole."""
_NO_GAP_CYCLES = 0.25
"""Ends of a fan that are closer are none."""


def extent_of(smooth: Floats, usable: Flags, star: SiemensStar, inner: float) -> SiemensStar:
    """The rim and the directions the star holds, where its own wave explains the pixels."""
    rows, cols = np.nonzero(usable)
    radius, angle = star.polar(rows.astype(float), cols.astype(float))
    value = smooth[usable]
    wave = np.cos(star.cycles * angle + star.alpha_rad)
    sectors = round(star.cycles / _SECTOR_CYCLES)
    width = 2 * math.pi / sectors
    sector = sector_of(angle, sectors)
    middle = radius < inner + 0.5 * (star.rim_px - inner)
    start = (radius > inner) & middle
    own = np.array([_slope(wave[s], value[s]) for s in members_of(sector, start, sectors)])
    level = float(np.quantile(own[np.isfinite(own)], 0.9)) if np.isfinite(own).any() else 0.0
    spans = np.isfinite(own) & (own > 0.6 * level)
    if not level > 0 or not spans.any():
        raise NoStarError(
            f"the rings about row {star.row:.1f}, column {star.col:.1f} have no common phase: "
            "that is no star; choose a region around it, or give its centre"
        )
    first, count = _longest_run(spans)
    weakest = int(np.nanargmin(own))
    if count == sectors and own[weakest] < _WHOLE * level:
        # Less than a sector may be missing.
        first, count = weakest + 1, sectors - 1
    kept = np.isin(sector, (first + np.arange(count)) % sectors)
    rim = _rim(radius[kept], wave[kept], value[kept], inner)
    whole = replace(star, rim_px=rim, first_deg=-180.0, sweep_deg=360.0)
    if count == sectors:
        return whole
    half = 0.5 * count * width
    middle_rad = first * width - math.pi + half
    near = (radius > inner) & (radius < rim)
    off = np.mod(angle[near] - middle_rad + math.pi, 2 * math.pi) - math.pi
    before, after = (_end(side * off, wave[near], value[near], half, width) for side in (-1.0, 1.0))
    if before + after > 2 * math.pi - _NO_GAP_CYCLES / _SECTOR_CYCLES * width:
        return whole
    first_deg = math.degrees(math.remainder(middle_rad - before, 2 * math.pi))
    return replace(whole, first_deg=first_deg, sweep_deg=math.degrees(before + after))


def _end(off: Floats, wave: Floats, value: Floats, coarse: float, width: float) -> float:
    """How far from its middle a fan goes on one side, in radians.

    Up to there pixels follow the wave as they do further in, beyond they have one level: where that
    leaves the smallest sum of squares, within a sector of the `coarse` end.
    """
    inside = (off > max(coarse - 3 * width, -coarse)) & (off < max(coarse - width, 0.0))
    near = np.flatnonzero((off >= coarse - width) & (off < min(coarse + width, math.pi)))
    if not near.size:
        return coarse
    near = near[np.argsort(off[near])]
    design = np.stack([np.ones(wave.size), wave], axis=1)
    fit, *_ = np.linalg.lstsq(design[inside], value[inside], rcond=None)
    left = np.append(0.0, np.cumsum((value[near] - design[near] @ fit) ** 2))
    beyond = value[near][::-1] - float(np.mean(value[near]))
    count = np.arange(1, beyond.size + 1)
    level = np.append(0.0, np.cumsum(beyond**2) - np.cumsum(beyond) ** 2 / count)[::-1]
    followed = int(np.argmin(left + level))
    return float(off[near[max(followed - 1, 0)]])


def _slope(wave: Floats, value: Floats) -> float:
    """Amplitude of the star's own wave in some pixels; nan where there are too few."""
    if wave.size < 8 or np.ptp(wave) < 1.0:
        return math.nan
    design = np.stack([np.ones(wave.size), wave], axis=1)
    fit, *_ = np.linalg.lstsq(design, value, rcond=None)
    return float(fit[1])


def _longest_run(flags: Flags) -> tuple[int, int]:
    """Start and length of the longest run of true values round a circle; single gaps count."""
    size = flags.size
    bridged = flags | (np.roll(flags, 1) & np.roll(flags, -1))
    if bridged.all():
        return 0, size
    start = int(np.flatnonzero(~bridged)[0])
    turned = np.roll(bridged, -start)
    best, first, run = (0, 0), 0, 0
    for place, flag in enumerate(turned):
        run = run + 1 if flag else 0
        if run > best[1]:
            first = place - run + 1
            best = (first, run)
    return (best[0] + start) % size, best[1]


def _rim(radius: Floats, wave: Floats, value: Floats, inner: float) -> float:
    """Where the wave's amplitude falls to half of what it is inside."""
    edges = np.arange(inner, float(radius.max()) + 1, 1.0)
    amplitudes = []
    for low in edges[:-1]:
        here = (radius >= low) & (radius < low + 1)
        slope = _slope(wave[here], value[here])
        amplitudes.append(slope)
    series = np.array(amplitudes)
    if not np.isfinite(series).any():
        return float(radius.max())
    top = float(np.nanmax(series))
    below = np.flatnonzero(~(series > 0.5 * top))
    peak = int(np.nanargmax(series))
    after = below[below > peak]
    if after.size == 0 or after[0] == 0:
        return float(edges[-1])
    index = int(after[0])
    last, here = series[index - 1], series[index]
    if not np.isfinite(here):
        return float(edges[index])
    part = (last - 0.5 * top) / (last - here)
    return float(edges[index - 1] + 0.5 + part)
