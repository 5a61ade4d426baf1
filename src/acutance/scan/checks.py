"""Is a scene rich enough to tell the sensor from its objects, and do its edges agree?"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

import numpy as np

from acutance.curves import Mtf, Otf2d
from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.raster import Box, Image
from acutance.scan.borders import border_of_each
from acutance.scan.field import Field
from acutance.scan.first_sensor import Rival
from acutance.scan.parts import PartsFit
from acutance.scan.scene_edges import SceneEdges
from acutance.scan.sensor_fit import SensorFit
from acutance.targets.check import MAX_RATIO, Check, Limits, answer
from acutance.targets.combine.curves import ChiSquare
from acutance.targets.combine.weighted_forms import CombinedOtf
from acutance.targets.full_pixel import full_pixel
from acutance.targets.processing_checks import SCENE_PROCESSING_CHECKS, scene_processing_checks
from acutance.targets.record import ImageInfo
from acutance.targets.region import stated_gsd
from acutance.targets.slices import SLICE_FREQ_CPP
from acutance.targets.straight.tuned import MIN_TRUSTED_SNR

__all__ = ["SCENE_CHECKS", "check_scene", "judged_edges"]

SCENE_CHECKS = (
    "edges_used", "trusted_share", "scene_directions", "ideal_share", "ideal_borders",
    "strange_share", "scene_settled", "form_agrees", "halo_share", "rival", "parts_agree",
    "diagonals", "axes_differ", "field_change", "full_pixel", "stated_gsd",
    *SCENE_PROCESSING_CHECKS,
)  # fmt: skip
"""Names of all checks of a scene."""

_DIRECTION_DEG = 15.0
_SIGNIFICANT = 2.0
_DISAGREE = 0.01
"""Chance of blurs of parts that scatter by as much, below which they disagree."""
_WIDE_HALO_PX = 1.5
"""Narrower halos come of mirrors that are not quite smooth, and of charge that diffuses."""
_DECIMATED = 0.7
"""MTF at Nyquist of images that were decimated three times or more; hardly of sharpened ones."""
_SEEN = 0.2
"""Where the MTF is less, a small difference of blur is a large factor."""


def check_scene(
    edges: SceneEdges,
    fit: SensorFit,
    field: Field,
    transfer: Otf2d,
    image: tuple[Image, Box],
    info: ImageInfo,
    limits: Limits,
) -> tuple[Check, ...]:
    """All checks of a scene.

    Parameters
    ----------
    edges : SceneEdges
    fit : SensorFit
    field : Field
    transfer : Otf2d
        The mean over the field.
    image : (Image, Box)
        And the part of it that was scanned.
    info : ImageInfo
    limits : mapping of str to float
        Limits the caller changed.
    """
    used = int(edges.used.sum())
    directions = np.unique(np.floor(fit.normal_deg / _DIRECTION_DEG)).size
    (ideal, ideal_std), (strange, _) = fit.kinds["ideal"], fit.kinds["strange"]
    across, diagonal, along, other = mtfs = [transfer.mtf(deg) for deg in (0.0, 45.0, 90.0, 135.0)]
    return (
        answer(
            "edges_used", used,
            f"{used} of the {edges.size} edges that were found are used: {_verdicts(edges)}",
            limits,
        ),
        _trusted_share(edges, used, limits),
        answer(
            "scene_directions", directions,
            f"their normals lie in {directions} of 12 directions of 15 degrees each", limits,
        ),
        answer(
            "ideal_share", ideal,
            f"{100 * ideal:.0f} ± {100 * ideal_std:.0f} % of the objects are as "
            "sharp as the sensor can show", limits,
        ),
        _ideal_borders(edges, fit.member.ideal, limits),
        answer(
            "strange_share", strange,
            f"{100 * strange:.1f} % of the edges are neither ideal nor soft ones of this sensor",
            limits,
        ),
        answer(
            "scene_settled", 0.0 if fit.settled else 1.0,
            f"sensor and objects were fitted in {fit.turns} turns"
            + ("" if fit.settled else ", and did not settle"), limits,
        ),
        _form_agrees(fit.agreement, limits),
        _halo_share(fit.otf, limits),
        _rival(fit.rivals, mtfs, limits),
        _parts_agree(fit.parts, limits),
        _diagonals(diagonal, other, limits),
        _axes_differ(across, along, fit.parts, limits),
        _field_change(field, fit.parts, limits),
        full_pixel(
            [curve(NYQUIST_CPP) for curve in (across, along)], limits, caution=_DECIMATED
        ),
        stated_gsd(info, limits),
        *scene_processing_checks(*image, limits),
    )  # fmt: skip


def judged_edges(edges: SceneEdges) -> int:
    """How many edges were measured that agree with a sensor or contradict one.

    Faint ones do neither: they are doubtful whatever they are.
    """
    faint = ~edges.used & (edges.snr < MIN_TRUSTED_SNR)
    return int(np.sum((edges.verdict != "rejected") & ~faint))


def _trusted_share(edges: SceneEdges, used: int, limits: Limits) -> Check:
    """Share of the used edges, the good and usable ones, among all that were measured."""
    measured = judged_edges(edges)
    share = used / max(measured, 1)
    found = (
        f"of the {measured} edges that could be measured, faint ones apart, {used} are good or "
        f"usable, {100 * share:.0f} %"
    )
    return answer("trusted_share", share, found, limits)


def _ideal_borders(edges: SceneEdges, ideal: Floats, limits: Limits) -> Check:
    """How many borders are those of ideal objects; pieces of one border count once."""
    border = border_of_each(edges.only_used)
    chance = np.zeros(int(border.max()) + 1)
    np.maximum.at(chance, border, ideal)
    value = float(chance.sum())
    found = f"{value:.1f} of {chance.size} borders are as sharp as the sensor can show"
    return answer("ideal_borders", value, found, limits)


def _form_agrees(chi_square: ChiSquare, limits: Limits) -> Check:
    """By how much the chi-square of the edges about their sensor exceeds what is expected."""
    ratio = chi_square.value / max(chi_square.expected, 1.0)
    found = (
        f"the edges have a chi-square of {chi_square.value:.0f} about the form of the sensor with "
        f"{chi_square.expected:.0f} degrees of freedom, {ratio:.2f} times as much"
    )
    return answer("form_agrees", ratio, found, limits)


def _halo_share(sensor: CombinedOtf, limits: Limits) -> Check:
    """Which share of the light lies in a wide halo, the mean over all forms of the sensor."""
    numbers = [(one.weight, one.form.numbers(one.parameters)) for one in sensor.forms]
    share = sum(
        weight * found["halo_share"]
        for weight, found in numbers
        if found.get("halo_sigma_px", 0.0) >= _WIDE_HALO_PX
    )
    found = f"{100 * share:.0f} % of the light lies in a halo"
    return answer("halo_share", share, found, limits)


def _rival(rivals: Sequence[Rival], mtfs: Sequence[Mtf], limits: Limits) -> Check:
    """By how much another sensor is less likely, in the log likelihood of the edges.

    One that lies within the deviations is no other.
    """
    freq = SLICE_FREQ_CPP[SLICE_FREQ_CPP <= NYQUIST_CPP]
    std = float(np.sqrt(np.mean([curve.near(freq).std ** 2 for curve in mtfs])))
    others = [one for one in rivals if one.apart > _SIGNIFICANT * std]
    if not others:
        return answer("rival", MAX_RATIO, "no other sensor was found to be likely", limits)
    rival = min(others)
    found = (
        f"another sensor, whose MTF differs by {rival.apart:.2f} in the mean, has a log likelihood "
        f"smaller by {rival.behind:.0f}"
    )
    return answer("rival", min(rival.behind, MAX_RATIO), found, limits)


def _parts_agree(parts: PartsFit | None, limits: Limits) -> Check:
    """By how much the parts of the scene scatter, as a share of the MTF at Nyquist."""
    if parts is None:
        found = "the edges are too few to ask whether the parts of the scene agree"
        return answer("parts_agree", 0.0, found, limits)
    # Oblique blur is none across and along.
    share = 2 * math.pi**2 * NYQUIST_CPP**2 * math.hypot(*parts.errors_px2[:2])
    told = (
        f"the blurs of {parts.part_count} parts of the scene have a chi-square of "
        f"{parts.chi_square.value:.1f} with {parts.chi_square.expected:.0f} degrees of freedom"
    )
    if share > 0:
        found = (
            f"the parts of the scene differ: the MTF at Nyquist is uncertain by {100 * share:.1f} "
            f"% for that, which is a part of all deviations ({told})"
        )
    else:
        found = f"{told}: they agree"
    return answer("parts_agree", share, found, limits)


def _diagonals(one: Mtf, other: Mtf, limits: Limits) -> Check:
    """How far the MTF along one diagonal surely differs from that along the other, relative."""
    both = [float(curve(NYQUIST_CPP)) for curve in (one, other)]
    std = float(np.linalg.norm(one.gradient(NYQUIST_CPP) - other.gradient(NYQUIST_CPP)))
    mean = max(0.5 * sum(both), 1e-9)
    least = max(abs(both[0] - both[1]) - _SIGNIFICANT * std, 0.0) / mean
    told = (
        f"the MTF at Nyquist is {both[0]:.3f} along one diagonal and {both[1]:.3f} along the other"
    )
    sigmas = f"{_SIGNIFICANT:.0f} standard deviations"
    if least > 0:
        found = f"{told}: they differ by at least {100 * least:.0f} % (by {sigmas})"
    else:
        found = f"{told}: within {sigmas} they agree"
    return answer("diagonals", least, found, limits)


def _axes_differ(across: Mtf, along: Mtf, parts: PartsFit | None, limits: Limits) -> Check:
    """How far the larger of the MTFs across and along surely exceeds the other, relative to it.

    At Nyquist, or where both tell more. Borders of one direction that are all soft alike pass for a
    smear of the sensor. Where parts of the scene were compared and agree it is more likely one.
    """
    freq = SLICE_FREQ_CPP[SLICE_FREQ_CPP <= NYQUIST_CPP]
    mean = 0.5 * (across(freq).value + along(freq).value)
    at = float(freq[np.flatnonzero(mean >= _SEEN).max(initial=0)])
    one, other = (max(float(curve(at)), 1e-9) for curve in (across, along))
    std = float(np.linalg.norm(across.gradient(at) / one - along.gradient(at) / other))
    excess = math.expm1(max(abs(math.log(one / other)) - _SIGNIFICANT * std, 0.0))
    told = f"at {at:.2g} c/px the MTF is {one:.3f} across and {other:.3f} along"
    sigmas = f"{_SIGNIFICANT:.0f} standard deviations"
    if excess > 0:
        found = f"{told}: more by at least {100 * excess:.0f} % (by {sigmas})"
    else:
        found = f"{told}: within {sigmas} they agree"
    if excess > 0 and _disagree(parts):
        found += "; the parts of the scene disagree about the blur, as soft objects make them"
    caution = None if parts is None or _disagree(parts) else math.inf
    return answer("axes_differ", min(excess, MAX_RATIO), found, limits, caution=caution)


def _field_change(field: Field, parts: PartsFit | None, limits: Limits) -> Check:
    """How far the sharpness in the corners surely differs from its mean, relative to it.

    Parts that disagree under a change that was found are not described by its smooth surface, as of
    two detectors side by side: neither are the places, nor is the mean.
    """
    if not field.is_fitted:
        found = "the edges are too few to ask whether sharpness changes over the field"
        return answer("field_change", 0.0, found, limits)
    change, std = _largest_change(field)
    least = max(change - _SIGNIFICANT * std, 0.0)
    found = (
        f"the MTF at Nyquist in the corners differs by up to {100 * change:.0f} ± {100 * std:.0f} "
        f"% from its mean, surely (by {_SIGNIFICANT:.0f} standard deviations) by {100 * least:.0f} "
        "%"
    )
    if least == 0.0 or not _disagree(parts):
        return answer("field_change", least, found, limits)
    found += "; the parts of the scene disagree about it, so it is no smooth one"
    advice = "mean and places may err by more than their intervals; scan parts of it by themselves"
    return answer("field_change", least, found, limits, caution=0.0, advice=advice)


def _disagree(parts: PartsFit | None) -> bool:
    """Whether the parts, where they were compared, disagree about the blur across and along."""
    return parts is not None and parts.upright.p_value < _DISAGREE


def _largest_change(field: Field) -> tuple[float, float]:
    """Largest relative difference of the MTF at Nyquist in the corners from its mean, its std."""
    u, v = NYQUIST_CPP * np.array([1.0, 0.0]), NYQUIST_CPP * np.array([0.0, 1.0])
    row, col, height, width = field.roi
    corners = product((row, row + height - 1), (col, col + width - 1))
    found = [field.change(*corner, u, v) for corner in corners]
    change, std = (np.concatenate(one) for one in zip(*found, strict=True))
    ratio = np.exp(change)
    largest = int(np.argmax(np.abs(ratio - 1)))
    return float(abs(ratio[largest] - 1)), float(ratio[largest] * std[largest])


def _verdicts(edges: SceneEdges) -> str:
    """How many edges have which verdict."""
    words, counts = np.unique(edges.verdict, return_counts=True)
    order = ("good", "usable", "doubtful", "invalid", "rejected")
    known = dict(zip(words.tolist(), counts.tolist(), strict=True))
    return ", ".join(f"{known[word]} {word}" for word in order if word in known)
