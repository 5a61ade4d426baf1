"""Measure groups of bars: finite square waves of some frequencies, in one or two directions."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves import Estimate, Mtf, Otf2d, Response
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import NoBarsError, OptionError
from acutance.geometry.bar_group import Bars
from acutance.numerics.noise import robust_scale
from acutance.numerics.one_thread import one_thread
from acutance.raster import Gsd, Image
from acutance.targets.measurement import ImageInfo
from acutance.targets.measurement2d import Measurement2d
from acutance.targets.options import chosen_options
from acutance.targets.periodic.bars_checks import bars_checks
from acutance.targets.periodic.bars_find import find_bars
from acutance.targets.periodic.bars_options import BarsOptions
from acutance.targets.periodic.bars_readings import GroupReading, central, coltman_mtf, read_group
from acutance.targets.periodic.fit_bars import BarsSolution, GroupFit, solve_bars
from acutance.targets.region import RegionPixels, RoiLike, read_region
from acutance.targets.slices import PlaneSlices

__all__ = ["BARS_METHODS", "BarsGroup", "BarsMeasurement", "measure_bars"]

BARS_METHODS = ("joint",)
_ONE_DIRECTION_DEG = 20.0


@dataclass(frozen=True, eq=False)
class BarsGroup(ShortRepr):
    """What one group of bars says.

    Attributes
    ----------
    bars : Bars
        Where it is, in pixels of the whole image.
    period_px : Estimate
        Its period.
    mtf : Estimate
        MTF at its frequency along its normal, from the joint fit.
    reading : GroupReading
        The plain reading: a sinusoid, and the contrast of the square bars.
    coltman : float
        MTF from the contrasts of all groups of this direction by Coltman's series.
    across_px, value, fitted : (n,) arrays
        The pixels used, as distance along the normal, level and fitted level: 0 is the ground,
        1 a wide bar.
    """

    bars: Bars
    period_px: Estimate
    mtf: Estimate
    reading: GroupReading
    coltman: float
    across_px: Floats
    value: Floats
    fitted: Floats

    @property
    def freq_cpp(self) -> float:
        """Frequency of the bars in cycles per pixel."""
        return self.bars.freq_cpp

    def to_dict(self) -> dict[str, Any]:
        """Place, MTF and plain readings, for JSON."""
        reading = self.reading
        return {
            **self.bars.to_dict(),
            "period_px": self.period_px.to_dict(),
            "freq_cpp": self.freq_cpp,
            "mtf": self.mtf.to_dict(),
            "modulation": Estimate(reading.modulation, reading.modulation_std).to_dict(),
            "ctf": Estimate(reading.ctf, reading.ctf_std).to_dict(),
            "coltman_mtf": self.coltman,
        }


@dataclass(frozen=True, eq=False, kw_only=True)
class BarsMeasurement(Measurement2d):
    """A measurement of groups of bars.

    Parameters
    ----------
    groups : tuple of BarsGroup
        In the order they were given or found.
    directions_deg : tuple of float
        Directions across the bars, from the column axis towards the row axis: what is measured;
        other directions are told by what all sensors have in common.
    contrast : Estimate
        Bars less ground, before the sensor.
    pixels, residual : (rows, cols) arrays
        The cut, and what the fit leaves of the pixels used (NaN elsewhere), image units.
    """

    groups: tuple[BarsGroup, ...]
    directions_deg: tuple[float, ...]
    contrast: Estimate
    pixels: Floats
    residual: Floats

    @cached_property
    def response(self) -> Response:
        """The curves along the normal of the first direction."""
        return self.otf.response(self.directions_deg[0])

    def is_first_direction(self, group: BarsGroup) -> bool:
        """Whether a group's normal is near that of the first direction."""
        return _turn_deg(group.bars.normal_deg, self.directions_deg[0]) < _ONE_DIRECTION_DEG

    @property
    def slices(self) -> PlaneSlices:
        """Slices of the OTF in the directions across the bars, the only ones measured."""
        return PlaneSlices.of_plane(self.otf, self.directions_deg)

    @property
    def noise(self) -> float:
        """Standard deviation of what the fit leaves, outliers aside, image units."""
        return robust_scale(self.residual[np.isfinite(self.residual)])

    @property
    def mtf(self) -> Mtf:
        """The MTF along the normal of the first direction."""
        return self.response.mtf

    @property
    def mtf_nyquist(self) -> Estimate:
        """MTF at 0.5 cycles per pixel along the normal of the first direction."""
        return self.response.mtf_nyquist

    def evidence(self) -> dict[str, Any]:
        """Groups and directions, for JSON."""
        return {
            "directions_deg": list(self.directions_deg),
            "contrast": self.contrast.to_dict(),
            "normal": {
                "angle_deg": self.directions_deg[0],
                **{name: one.to_dict() for name, one in self.response.metrics().items()},
                "mtf": self.mtf.to_dict(),
            },
            "groups": [group.to_dict() for group in self.groups],
        }


@one_thread
def measure_bars(
    image: Image | ArrayLike,
    roi: RoiLike = None,
    *,
    gsd_m: float | Gsd | None = None,
    method: str = "joint",
    options: BarsOptions | None = None,
) -> BarsMeasurement:
    """Measure the groups of bars of a region.

    Parameters
    ----------
    image : Image or (rows, cols) array_like
    roi : Region, Box, (row, col, height, width) or None
        A region that holds the groups and some ground around each; None is the whole image.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, instead of the image's own.
    method : {"joint"}, optional
        One fit of all groups.
    options : BarsOptions, optional
        Where the groups are, if they are not to be searched for.

    Returns
    -------
    BarsMeasurement

    Raises
    ------
    ImageError, RegionError, OptionError
        If there are no pixels to measure, or an option means nothing.
    NoBarsError
        If there are no bars, or not as they were described.
    """
    chosen = chosen_options(options, BarsOptions)
    if method not in BARS_METHODS:
        raise OptionError(f"there is no bars method {method!r}: {', '.join(BARS_METHODS)} is known")
    pixels = read_region(image, roi, gsd_m)
    if chosen.groups:
        groups = tuple(_moved(one, -pixels.box.row, -pixels.box.col) for one in chosen.groups)
        contrast = _contrast(pixels.pixels, groups)
    else:
        found = find_bars(pixels.pixels, chosen.count)
        groups, contrast = found.groups, found.contrast
    solved = solve_bars(
        pixels.pixels, groups, contrast=contrast, levels=chosen.levels, robust=chosen.robust
    )
    return _measurement(pixels, solved, method, chosen)


def _moved(bars: Bars, rows: float, cols: float) -> Bars:
    return replace(bars, row=bars.row + rows, col=bars.col + cols)


def _contrast(image: Floats, groups: tuple[Bars, ...]) -> float:
    """Bars less ground, from the mean of every stated group and of what is beside it."""
    rows, cols = np.nonzero(np.isfinite(image))
    value = image[rows, cols]
    found = []
    for number, bars in enumerate(groups, 1):
        across, along = bars.across_and_along(rows.astype(float), cols.astype(float))
        beside = np.abs(across) - 0.5 * bars.width_px
        central_rows = np.abs(along) < 0.4 * bars.length_px
        inside, outside = central_rows & (beside < 0), central_rows & (beside > 2) & (beside < 8)
        if not (inside.any() and outside.any()):
            raise NoBarsError(
                f"group {number} at row {bars.row:.1f}, column {bars.col:.1f} and the ground "
                "beside it lie outside the region: check its place"
            )
        # Half of a group is bars, but for half a gap at its ends.
        share = 0.5 * bars.count / (bars.count - 0.5)
        found.append(float(np.mean(value[inside]) - np.mean(value[outside])) / share)
    contrast = float(np.median(found))
    if contrast == 0:
        raise NoBarsError("the groups are as bright as the ground beside them: check their places")
    return contrast


def _measurement(
    pixels: RegionPixels, solved: BarsSolution, method: str, options: BarsOptions
) -> BarsMeasurement:
    """Put together what a measurement holds; the groups move into the whole image's pixels."""
    model = solved.model
    gsd = pixels.gsd
    otf = Otf2d(model, None if gsd is None else (gsd.row_m, gsd.col_m))
    directions = _directions(solved.groups)
    residual = np.full(pixels.pixels.shape, np.nan)
    for one in solved.groups:
        residual[one.rows, one.cols] = one.residual
    info = ImageInfo(
        pixels.image.path,
        pixels.image.band,
        None if gsd is None else gsd.along_normal(directions[0]),
        pixels.box.as_tuple(),
        pixels.image.crs,
    )
    return BarsMeasurement(
        kind="bars",
        method=method,
        otf=otf,
        snr=abs(model.level) / solved.noise if solved.noise > 0 else math.inf,
        checks=bars_checks(pixels, solved, directions, options.limits),
        image=info,
        options=options.to_dict(),
        groups=_groups(pixels, solved, otf),
        directions_deg=directions,
        contrast=Estimate(model.level, model.level_std),
        pixels=pixels.pixels,
        residual=residual,
    )


def _directions(groups: tuple[GroupFit, ...]) -> tuple[float, ...]:
    """Mean normals of groups with nearly the same one; that of most groups first."""
    kinds: list[list[float]] = []
    for one in groups:
        angle = one.bars.normal_deg
        for kind in kinds:
            if _turn_deg(kind[0], angle) < _ONE_DIRECTION_DEG:
                kind.append(kind[0] + (angle - kind[0] + 90) % 180 - 90)
                break
        else:
            kinds.append([angle])
    return tuple(sum(kind) / len(kind) for kind in sorted(kinds, key=len, reverse=True))


def _turn_deg(one: float, other: float) -> float:
    """Angle between two normals, which have no sign, 0 to 90."""
    return abs((one - other + 90) % 180 - 90)


def _groups(pixels: RegionPixels, solved: BarsSolution, otf: Otf2d) -> tuple[BarsGroup, ...]:
    contrast = solved.model.level
    readings = []
    for one in solved.groups:
        inside = central(one.bars, one.across_px)
        readings.append(
            read_group(one.bars, one.across_px[inside], one.value[inside], contrast, solved.noise)
        )
    by_series = _coltman(solved.groups, readings)
    return tuple(
        BarsGroup(
            bars=_moved(one.bars, pixels.box.row, pixels.box.col),
            period_px=Estimate(one.bars.period_px, one.period_std_px),
            mtf=_mtf_at(otf, one.bars),
            reading=reading,
            coltman=series,
            across_px=one.across_px,
            value=(one.value - one.dark) / contrast,
            fitted=(one.value - one.residual - one.dark) / contrast,
        )
        for one, reading, series in zip(solved.groups, readings, by_series, strict=True)
    )


def _mtf_at(otf: Otf2d, bars: Bars) -> Estimate:
    """MTF at the frequency of a group along its normal."""
    angle = math.radians(bars.normal_deg)
    freq: Floats = bars.freq_cpp * np.array([0.0, 0.5, 1.0, 1.5])
    u, v = freq * math.cos(angle), freq * math.sin(angle)
    return Mtf(freq, otf.model.otf(u, v), otf.model.factor(u, v))(bars.freq_cpp)


def _coltman(groups: tuple[GroupFit, ...], readings: list[GroupReading]) -> list[float]:
    """MTF of every group by Coltman's series over the groups of its direction."""
    found = []
    for one in groups:
        mates = [
            (other.bars.freq_cpp, reading.ctf)
            for other, reading in zip(groups, readings, strict=True)
            if _turn_deg(other.bars.normal_deg, one.bars.normal_deg) < _ONE_DIRECTION_DEG
        ]
        table = np.array(sorted(mates))
        series = coltman_mtf(table[:, 0], table[:, 1])
        found.append(float(series[np.searchsorted(table[:, 0], one.bars.freq_cpp)]))
    return found
