"""Structure of plateaus, pulse and residuals that is no blur of a sensor.

Structure of the scene that the fit can follow is part of its curves, the edge spread function (ESF)
and its derivative, the line spread function, LSF (`structure`,
`asymmetric_wings`); the rest is in the residuals (`profile`, `target_uniformity`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.numerics.compiled import compiled
from acutance.targets.check import Check, Limits, answer, bounded_ratio, limit_of
from acutance.targets.question import PLACES
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.check_loops import (
    blotches,
    largest_bump,
    second_peak,
)
from acutance.targets.straight.fit_edge import SplineEdge
from acutance.targets.straight.tuned import (
    REPEATED_SIGMAS,
    STRUCTURE_SIGMAS,
)

__all__ = [
    "asymmetric_lsf",
    "asymmetric_wings",
    "double_edge",
    "edge_roughness",
    "one_sided_overshoot",
    "profile",
    "structure",
    "target_uniformity",
    "tolerable_px",
    "uniformity",
]

_FAR_WIDTHS = 2.5
_STEEP_WIDTHS, _NEAR_WIDTHS = 1.25, 4.0
_REACH_PX = 40.0
_BIN_PX = 1.0
_PART_PX = 5.0
_MIN_PARTS, _MAX_PARTS = 4, 12
_MAX_OFFSET_PX = 0.15
_MAX_ASYMMETRY, _ANY_ASYMMETRY = 0.08, 0.1
"""Caution where a deviation of RER is small, and whatever it is."""
_TEXTURED, _TEXTURED_ASYMMETRY, _TEXTURED_RER_STDS = 3.0, 0.02, 2.0
"""Noise power along the normal over that of white noise from which on it is the ground's texture
(resampled products have 1 to 2.5), and the limits there."""
_NOTED_RER_STDS, _MAX_RER_STDS = 0.5, 3.0
_UNLIKE_RER_STDS: Final = ((0.5, 1.5), (0.95, 0.75))
"""Probability of a sensor like none that was drawn, and the limit from there on: none of 600 clean
edges, and 21 of the 73 strips of .4 to 4 px that no other check finds. The second finds four of 16
pulses with a roof of two heights, and none of 2900 other targets."""
_SURELY_SHIFTED: Final = 2 / 3
"""Probability from which on interpolation at one phase is what the LSF is like: twice as likely as
a trail and all other sensors, which white noise does not refute."""


def uniformity(data: CheckData, limits: Limits, side: str, outwards: Floats) -> Check:
    """Structure of one plateau: variation of means over 4 x 4 pixels, beyond noise."""
    variation = blotches(data.blocks, data.value, outwards, data.far_px, 1.0)
    found = (
        f"the plateau {PLACES[side]} varies by {100 * variation:.1f} % of the contrast from place "
        "to place"
    )
    return answer(f"uniformity_{side}", bounded_ratio(1.0, variation), found, limits)


def target_uniformity(data: CheckData, limits: Limits) -> Check:
    """Structure of a pulse and of its two sides, from the residuals there.

    Grain that the plateaus have as well is noise, which the intervals allow for.
    """
    variation = blotches(
        data.blocks, data.residual, -data.outside, -0.5 * data.fwhm_px, data.smoothness
    )
    found = f"the pulse varies by {100 * variation:.1f} % of its height from place to place"
    return answer("uniformity_target", bounded_ratio(1.0, variation), found, limits)


def structure(data: CheckData, limits: Limits) -> Check:
    """Bumps of the ESF where it should be flat: a line, a road, a second edge."""
    place = int(0.95 * data.outside.size)
    reach = float(np.partition(data.outside, place)[place])
    esf = data.coarse_esf
    worst = largest_bump(esf.distance_px, esf.value, esf.std, _FAR_WIDTHS * data.fwhm_px, reach)
    found = f"next to the edge the profile goes up and down by {100 * worst:.1f} % of the contrast"
    return answer("structure", worst, found, limits)


def one_sided_overshoot(data: CheckData, limits: Limits) -> Check:
    """Whether the ESF overshoots on one side only.

    Sharpening overshoots equally on both sides. A bright rim of the bright side, or a dark line
    along the dark one, does on one.
    """
    coarse, esf = data.coarse_esf, data.fit.response.esf.value
    over, under = max(float(esf.max()) - 1, 0.0), max(-float(esf.min()), 0.0)
    most, least = (coarse.factor[coarse.nearest(int(at))] for at in (esf.argmax(), esf.argmin()))
    # Of both in common: what moves the whole profile raises one and lowers the other.
    std = float(np.linalg.norm((over > 0) * most + (under > 0) * least))
    apart = abs(over - under)
    more = apart if apart > STRUCTURE_SIGMAS * std else 0.0
    side = "bright" if over > under else "dark"
    found = f"the ESF overshoots by {100 * more:.1f} % of the contrast more {PLACES[side]}"
    return answer("one_sided_overshoot", more, found, limits)


def double_edge(data: CheckData, limits: Limits) -> Check:
    """Whether the LSF has a second peak: two edges so near to one another that they look like one.

    The second peak counts by its height over the lowest place between the two, relative to the
    first.
    """
    worst = second_peak(data.fit.response.lsf.value)
    found = f"the LSF has a second peak of {100 * worst:.0f} % of the first"
    return answer("double_edge", worst, found, limits)


def edge_roughness(data: CheckData, limits: Limits) -> Check:
    """How far the target's border moves to and fro from pixel to pixel, beyond noise.

    Pixels on a border that is a distance d off its line differ by d times the slope of the image:
    d^2 is the excess of their mean square residual over that of the noisier plateau, divided by the
    mean square slope.
    """
    count, power, noise, steepness = data.border
    # The variance of count squares of Gaussian noise.
    chance = STRUCTURE_SIGMAS * noise * math.sqrt(2 / max(count, 1))
    value = math.sqrt((power - noise) / steepness) if power - noise > chance else 0.0
    found = (
        f"from pixel to pixel the border lies {value:.3f} px rms off the fitted line and profile"
    )
    return answer(
        "edge_roughness_px", value, found, limits, default=tolerable_px(data, "edge_roughness_px")
    )


def tolerable_px(data: CheckData, name: str) -> float:
    """How far a border may lie off its line until that takes half a deviation of MTF at Nyquist.

    Offsets of variance v multiply the MTF by ``exp(-2 pi^2 f^2 v)``. The limit of the check `name`
    where that is more.
    """
    nyquist = data.fit.response.mtf_nyquist
    share = 0.5 * nyquist.std / max(nyquist.value, 1e-9)
    blur_px = math.sqrt(-math.log(max(1 - share, 0.1)) / 2) / (math.pi * NYQUIST_CPP)
    # Two digits are shown beside what was found.
    return float(f"{max(limit_of(name, {}), min(blur_px, _MAX_OFFSET_PX)):.2g}")


def asymmetric_lsf(data: CheckData, limits: Limits, *, of_scene: bool = False) -> Check:
    """How far the ESF is from symmetric about its middle, within two widths of it.

    The middle is where the ESF is the most symmetric. Light of a lens, a detector and a kernel is
    symmetric along most directions; a strip of the ground along the border that is narrower than
    the blur is not, and it moves the relative edge response (RER) about as much. On textured ground
    such strips are more frequent than sensors with charge trails. Where the LSF is like that of no
    sensor drawn at random, trails among them, any asymmetry that is worth a note is the ground's;
    so it is where only an interpolated product has such an LSF and the noise was not interpolated
    (of one edge; of the edges of a scene, `of_scene`, those that share it tell it from the ground).
    """
    value = data.asymmetry
    rer_std = min(data.fit.response.rer.std, 1.0)
    noted = max(limit_of("asymmetric_lsf", {}), _NOTED_RER_STDS * rer_std)
    found = f"the ESF is asymmetric about its middle by {100 * value:.1f} % of the contrast"
    caution, why = _grave_asymmetry(data, noted, rer_std, of_scene)
    if value > noted:
        found += f"; from {100 * caution:.2g} % on a caution{why}"
    return answer(
        "asymmetric_lsf", value, found, limits, default=float(f"{noted:.2g}"), caution=caution
    )


def _grave_asymmetry(
    data: CheckData, noted: float, rer_std: float, of_scene: bool
) -> tuple[float, str]:
    """From which asymmetry on it is a caution, and why from there."""
    by_rer = _MAX_RER_STDS * rer_std
    caution, why = max(_MAX_ASYMMETRY, by_rer), ""
    if by_rer > _MAX_ASYMMETRY:
        why = f", {_MAX_RER_STDS:g} deviations of RER"
    if isinstance(data.fit, SplineEdge):
        if data.fit.correlation.inflation > _TEXTURED:
            caution = max(_TEXTURED_ASYMMETRY, _TEXTURED_RER_STDS * rer_std)
            why = ", since the noise is that of textured ground, where strips are frequent"
        unlike, of_what = _unlike_sensors(data, data.fit.families, of_scene)
        stds = [most for least, most in _UNLIKE_RER_STDS if unlike > least]
        if stds and max(noted, stds[-1] * rer_std) < caution:
            caution = max(noted, stds[-1] * rer_std)
            why = f", since the LSF is like that of {of_what} (probability {unlike:.2f})"
    return (_ANY_ASYMMETRY, "") if caution > _ANY_ASYMMETRY else (caution, why)


def _unlike_sensors(
    data: CheckData, families: Mapping[str, float], of_scene: bool
) -> tuple[float, str]:
    """Probability that no sensor has this LSF, and what it is like in words.

    Interpolation at one phase makes an LSF uneven by mixing neighbouring pixels, and it mixes their
    noise as well. Where neighbours' noise is independent there was none, and the ground is uneven.
    """
    none, shifted = families.get("other", 0.0), families.get("shifted", 0.0)
    is_likely = shifted > none and none + shifted > _SURELY_SHIFTED
    if of_scene or not is_likely or not data.is_noise_white:
        return none, "no sensor known"
    return none + shifted, "a product interpolated at one phase, and its noise is not"


def asymmetric_wings(data: CheckData, limits: Limits) -> Check:
    """Whether the far wings of the LSF hold more light on one side than on the other.

    Halo, stray light and diffraction scatter to both sides equally. A step of the background
    parallel to the edge lies on one.
    """
    distance, esf, _, factor = data.coarse_esf
    near = _FAR_WIDTHS * data.fwhm_px
    far = min(float(distance[-1]), float(data.before.max()), float(data.behind.max()))
    value, significance = 0.0, 0.0
    if far > near + 1:
        # Of the light out there a quarter of a pixel is nothing.
        middle, step_px = distance.size // 2, float(distance[1] - distance[0])
        first, last = round(near / step_px), int(far / step_px + 1e-6)
        places = middle + np.array([last, -first, first, -last])
        signs = np.array([1.0, -1.0, -1.0, 1.0])
        excess = float(signs @ esf[places])
        std = float(np.linalg.norm(signs @ factor[places]))
        significance = abs(excess) / max(std, 1e-9)
        value = abs(excess) if significance > STRUCTURE_SIGMAS else 0.0
    found = (
        f"beyond {near:.1f} px the ESF moves by {100 * value:.1f} % of the contrast more on one "
        f"side than on the other ({significance:.0f} standard deviations)"
    )
    return answer("asymmetric_wings", value, found, limits)


def profile(
    data: CheckData,
    limits: Limits,
    last_px: float,
    *,
    own_misfit: bool,
    advice: str | None = None,
) -> Check:
    """Residuals along the normal that repeat all along the target.

    Noise of any colour differs from part to part of the target; a line parallel to it, a striped
    pulse or ringing that the line spread function (LSF) cannot follow is the same in all of them.

    Parameters
    ----------
    data, limits
    last_px : float
        Place of the target's last step: 0 for an edge.
    own_misfit : bool
        Whether the method's curves do not follow the pixels (the published ones smooth).
    advice : str, optional
        The cause, where it is known.
    """
    s = -data.before
    steep, near = _STEEP_WIDTHS * data.fwhm_px, _NEAR_WIDTHS * data.fwhm_px
    ends = (
        max(float(s.min()) + 0.5 * _BIN_PX, -_REACH_PX),
        min(float(s.max()) - 0.5 * _BIN_PX, last_px + _REACH_PX),
    )
    windows = [(ends[0], -near), (last_px + near, ends[1])]
    if not own_misfit:
        windows += [(-near, -steep), (-steep, last_px + steep), (last_px + steep, last_px + near)]
    found_in = _repeated_profiles(s, data.t, data.unexplained, np.array(windows)).tolist()
    value = max([common for common, sure in found_in if sure > REPEATED_SIGMAS], default=0.0)
    most = max(0.0, *(sure for _, sure in found_in))
    found = (
        f"all along the target the pixels leave the fit by the same {100 * value:.2f} % of the "
        f"contrast ({most:.0f} standard deviations)"
    )
    return answer("profile", value, found, limits, advice=advice)


@compiled
def _repeated_profiles(s: Floats, t: Floats, residual: Floats, windows: Floats) -> Floats:
    """What the residuals of all parts of a target have in common, and its significance, (w, 2).

    Parameters
    ----------
    s, t, residual : (n,) arrays
        Distance of the pixels along the normal and along the target, and residuals.
    windows : (w, 2) array
        From where to where along the normal they are compared.
    """
    mean, parts, bins = _part_means(s, t, residual, windows)
    found = np.zeros((len(windows), 2))
    for k in range(len(windows)):
        found[k, 0], found[k, 1] = _shared(mean[k, : parts[k], : bins[k]])
    return found


@compiled
def _part_means(
    s: Floats, t: Floats, residual: Floats, windows: Floats
) -> tuple[Floats, NDArray[np.int64], NDArray[np.int64]]:
    """Mean residuals of the parts of the target in bins of every window, of which none overlap.

    Returns
    -------
    mean : (w, parts, bins) array
        In the first bins those that all parts fill.
    parts, bins : (w,) int arrays
        How many there are: none where there are few pixels, or the target is short.
    """
    count = len(windows)
    window = np.full(s.size, -1, np.int64)
    pixels, first, last = np.zeros(count), np.full(count, np.inf), np.full(count, -np.inf)
    for i in range(s.size):
        for k in range(count):
            if windows[k, 0] <= s[i] < windows[k, 1]:
                window[i] = k
                pixels[k] += 1
                first[k], last[k] = min(first[k], t[i]), max(last[k], t[i])
                break
    bins, parts = np.zeros(count, np.int64), np.zeros(count, np.int64)
    per_px, part_per_px = np.zeros(count), np.zeros(count)
    for k in range(count):
        bins[k] = max(int((windows[k, 1] - windows[k, 0]) // _BIN_PX), 0)
        most = min(int((last[k] - first[k]) // _PART_PX), _MAX_PARTS) if pixels[k] else 0
        enough = bins[k] >= 2 and most >= _MIN_PARTS and pixels[k] >= _MIN_PARTS * bins[k]
        parts[k] = most if enough else 0
        per_px[k] = bins[k] / (windows[k, 1] - windows[k, 0])
        part_per_px[k] = parts[k] / (last[k] - first[k])
    total = np.zeros((count, _MAX_PARTS, np.max(bins) + 1))
    known = np.zeros(total.shape)
    for i in range(s.size):
        k = window[i]
        if k >= 0 and parts[k] > 0:
            column = min(int((s[i] - windows[k, 0]) * per_px[k]), bins[k] - 1)
            row = min(int((t[i] - first[k]) * part_per_px[k]), parts[k] - 1)
            total[k, row, column] += residual[i]
            known[k, row, column] += 1
    mean, filled = np.zeros(total.shape), np.zeros(count, np.int64)
    for k in range(count):
        for column in range(bins[k] if parts[k] > 0 else 0):
            fewest = np.inf
            for row in range(parts[k]):
                fewest = min(fewest, known[k, row, column])
            if fewest >= 2:
                for row in range(parts[k]):
                    mean[k, row, filled[k]] = total[k, row, column] / known[k, row, column]
                filled[k] += 1
    return mean, parts, filled


@compiled
def _shared(mean: Floats) -> tuple[float, float]:
    """Root mean square of the profile that all parts of a target share, and its significance.

    With the mean residual P (K, B) of K parts in B bins, the products of different parts,
    ``sum_(i != j) P_i . P_j``, are zero on average for noise of any colour; their variance is
    ``2 K (K - 1) tr(C^2)`` with C the covariance of one part's bins, taken from how the parts
    differ (tr(C^2) without the bias of few parts: Bai and Saranadasa, Statistica Sinica 6, 311,
    1996).
    """
    parts, bins = mean.shape
    if bins < 2:
        return 0.0, 0.0
    freedom, shared, trace, squares = parts - 1, 0.0, 0.0, 0.0
    level = np.zeros(bins)
    for column in range(bins):
        total, own = 0.0, 0.0
        for part in range(parts):
            total += mean[part, column]
            own += mean[part, column] ** 2
        level[column] = total / parts
        shared += total**2 - own
    for i in range(parts):
        for j in range(i + 1):
            covariance = 0.0
            for column in range(bins):
                apart = mean[i, column] - level[column]
                covariance += apart * (mean[j, column] - level[column])
            covariance /= freedom
            squares += covariance**2 if i == j else 2 * covariance**2
            trace += covariance if i == j else 0.0
    squares -= trace**2 / freedom
    squares *= freedom**2 / ((freedom - 1) * (freedom + 2))
    # A covariance of B bins cannot have a smaller trace of its square than an even one.
    variance = 2 * parts * freedom * max(squares, trace**2 / bins, 1e-24)
    rms = math.sqrt(max(shared, 0.0) / (parts * freedom * bins))
    return rms, shared / math.sqrt(variance)
