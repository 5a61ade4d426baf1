"""A strip along the border of an edge: a rim, a gutter or a kerb that begins at the line.

A strip of width w and height h, as a share of the contrast, adds to the image

    h (ESF(s) - ESF(s - w))

on the bright side, and its mirror image on the dark one, with ESF the edge spread function of the
sensor. Narrower than the blur it looks like a part of the line spread function (LSF). A sensor of
the prior's families beside uneven ground is compared with the same behind a strip, by their log
evidence, over sides and widths; what counts is how far the strip moves the numbers.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.numerics.lorentz_tail import tail_esf, tail_otf
from acutance.numerics.marginal_likelihood import (
    Prior,
    Whitened,
    likeliest_amplitudes,
    whiten,
)
from acutance.numerics.normal_equations import Normal
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.fit_edge import SplineEdge
from acutance.targets.straight.gradients import plateau_trends
from acutance.targets.straight.ground_steps import near_ground
from acutance.targets.straight.lsf import SplineResponse
from acutance.targets.straight.lsf_prior import Directions, directions, tail_spline
from acutance.targets.straight.model_prior import model_prior
from acutance.targets.straight.spline import (
    CELLS,
    CENTRES,
    HALF_SUPPORT,
    edge_weights,
    esf_from_lsf,
    expand,
    quasi_interpolant,
    transform,
)
from acutance.targets.straight.spline_equations import accumulate
from acutance.targets.straight.step_profile import EDGE
from acutance.targets.straight.tuned import (
    RIM_ODDS,
    RIM_STD,
    TAIL_WIDTH,
    TRAIL_LIKE_RIM_ODDS,
    TRAIL_LIKE_WIDTHS,
)

__all__ = ["Rim", "find_rim"]

_WIDTHS_PX: Final = (0.5, 0.75, 1.0, 1.5, 2.0, 2.75, 3.5)
_MOVED_STDS: Final = 2.0
_MIN_ASYMMETRY_STDS, _MIN_GROUND_STDS = 0.3, 0.5
"""Of the relative edge response (RER): where the ESF is more symmetric and the ground more even, a
strip is not looked for."""
_REACH_PX: Final = 4.0
_TRAILS: Final = ("trail", "deferred")
_MAX_TRAIL: Final = 0.95
"""Probability of a charge trail of any kind, beyond which it explains what is not symmetric."""
_MIN_GAIN: Final = 0.1
"""Of log evidence without amplitudes of its own, below which no strip becomes probable with them:
of 140 that did, 2 lay below."""
_STEP_PX, _STEPS = 0.05, 40
"""Places of the ESF about its middle."""
_MAX_STEPS, _SETTLED = 4, 0.3


@dataclass(frozen=True)
class Rim:
    """The strip along the border that explains the pixels best.

    Parameters
    ----------
    probability : float
        Of any strip that moves RER or MTF at Nyquist by more than two deviations.
    side : {"dark", "bright"}
    width_px : float
    height, height_std : float
        As shares of the contrast; negative where it is darker than the side it lies on.
    rer : float
        RER of the sensor behind that strip.
    """

    probability: float
    side: str
    width_px: float
    height: float
    height_std: float
    rer: float


def find_rim(data: CheckData, fit: SplineEdge) -> Rim | None:
    """The strip that may lie along the border; none where the edge shows no sign of one.

    Parameters
    ----------
    data : CheckData
    fit : SplineEdge
    """
    trail = sum(fit.families.get(name, 0.0) for name in _TRAILS)
    if not _shows_signs(fit, data.asymmetry) or trail > _MAX_TRAIL:
        return None
    model = _Model.of(data, fit)
    found = _compared(model)
    chance, numbers = _chances(model, found), model.numbers(found.beta)
    moved = numbers.away(fit.response) > _MOVED_STDS
    best = int(np.argmax(chance))
    side, width_px = model.strips[best]
    height, std = float(found.height[best]), float(found.height_std[best])
    return Rim(
        float(np.sum(chance, where=moved)), side, width_px, height, std, float(numbers.rer[best])
    )


def _shows_signs(fit: SplineEdge, asymmetry: float) -> bool:
    """Whether asymmetry, or a level of the ground next to the edge, is worth a look."""
    rer = fit.response.rer
    if asymmetry > _MIN_ASYMMETRY_STDS * rer.std:
        return True
    levels = [
        np.abs(side.level[side.distance_px <= _REACH_PX + fit.blur.width_px]) for side in fit.ground
    ]
    highest = max(float(np.max(level, initial=0.0)) for level in levels)
    return highest * rer.value > _MIN_GROUND_STDS * rer.std


class _Numbers(NamedTuple):
    """RER and MTF at Nyquist of several sensors, (k,) each."""

    rer: Floats
    mtf_nyquist: Floats

    def away(self, response: SplineResponse) -> Floats:
        """The larger distance of either from that of a response, in its deviations, (k,)."""
        pairs = ((self.rer, response.rer), (self.mtf_nyquist, response.mtf_nyquist))
        return np.asarray(
            np.max([np.abs(one - own.value) / max(own.std, 1e-9) for one, own in pairs], axis=0)
        )


class _Found(NamedTuple):
    """What every strip explains.

    Attributes
    ----------
    plain : float
        Log evidence without any.
    gain : (k,) array
        Log evidence with the strip over that without any.
    height, height_std : (k,) arrays
        As shares of the contrast.
    beta : (k, m) array
        The other unknowns, with the strip.
    """

    plain: float
    gain: Floats
    height: Floats
    height_std: Floats
    beta: Floats


@dataclass(frozen=True, eq=False)
class _Model:
    """An edge behind a sensor of the prior, and strips along it.

    Attributes
    ----------
    blur : GaussianPixel
        The first fit, about which the model is made.
    directions : Directions
        Of the LSF: the unknowns after the level.
    normal : Normal
        The pixels' equations in the unknowns without a strip, in shares of the contrast.
    crossed : (m, k) array
        Products of those unknowns with the strips.
    own, projection : (k,) arrays
        Products of the strips with themselves, and with the pixels.
    prior : Prior
    strips : tuple of (side, width_px)
        The k strips.
    """

    blur: GaussianPixel
    directions: Directions
    normal: Normal
    crossed: Floats
    own: Floats
    projection: Floats
    prior: Prior
    strips: tuple[tuple[str, float], ...]

    @classmethod
    def of(cls, data: CheckData, fit: SplineEdge) -> _Model:
        """The model of an edge's pixels within the support of the spline."""
        blur, width = fit.blur, fit.blur.width_px
        near = data.outside < HALF_SUPPORT * width
        s = fit.distance_px[near]
        seen = blur.esf_and_lsf(s)
        trends = plateau_trends(EDGE.sides([seen], s), data.t[near])
        sensor = directions(blur)
        strips = tuple((name, px) for name in ("dark", "bright") for px in _WIDTHS_PX)
        curves = sensor.esf + np.outer(tail_spline(), sensor.tail)
        level, ground = np.ones((CELLS + 3, 1)), near_ground()
        design = np.hstack([level, curves, ground.spline, _strip_splines(blur, strips)])
        # The fit's own correlation of the noise, not that of the plateaus.
        weight = data.weights[near] * (data.inflation / fit.correlation.inflation)
        every = accumulate(
            [edge_weights(s / width)], data.value[near] - seen[0], weight, [trends], float(s.size)
        ).combined(design)  # fmt: skip
        is_strip = np.zeros(every.projection.size, bool)
        is_strip[design.shape[1] - len(strips) : design.shape[1]] = True
        gram, projection, plain = every.gram, every.projection, ~is_strip
        normal = replace(every, gram=gram[np.ix_(plain, plain)], projection=projection[plain])
        prior = model_prior(blur, 1.0, sensor, ground, len(trends), np.zeros(0))
        return cls(
            blur, sensor, normal, gram[np.ix_(plain, is_strip)], gram[is_strip, is_strip],
            projection[is_strip], prior, strips,
        )  # fmt: skip

    def numbers(self, beta: Floats) -> _Numbers:
        """RER and MTF at Nyquist of the sensors of some unknowns, (k, m)."""
        width, own = self.blur.width_px, beta[:, 1 : 1 + self.directions.block.size].T
        spline, tail = self.directions.esf @ own, self.directions.tail @ own
        height = 1 + spline[-1] + tail
        s = np.asarray(_STEP_PX * np.arange(-_STEPS, _STEPS + 1), float)
        esf = expand(*edge_weights(s / width)) @ spline
        esf += self.blur.esf(s)[:, None] + np.outer(tail_esf(s / width, TAIL_WIDTH), tail)
        esf /= height
        freq_cpp = np.array([NYQUIST_CPP])
        otf = self.blur.otf(freq_cpp) + transform(freq_cpp * width, 0.0, 1.0, 0)[0] @ spline
        otf += tail_otf(freq_cpp * width, TAIL_WIDTH) * tail
        return _Numbers(_relative_edge_response(esf), np.abs(otf) / height)

    def odds(self, height: Floats) -> Floats:
        """Prior odds of every strip of a height, (k,)."""
        width_px = np.array([width for _, width in self.strips])
        widens = (height * _outwards(self.strips) < 0) & (
            width_px < TRAIL_LIKE_WIDTHS * self.blur.width_px
        )
        return np.where(widens, TRAIL_LIKE_RIM_ODDS, RIM_ODDS) / len(self.strips)

    def with_strip(self, k: int) -> tuple[Normal, Prior]:
        """The equations and the prior with one strip, the last unknown."""
        cross = self.crossed[:, k]
        gram = np.block([[self.normal.gram, cross[:, None]], [cross[None], self.own[k]]])
        projection = np.append(self.normal.projection, self.projection[k])
        prior = replace(
            self.prior,
            block=np.append(self.prior.block, -1),
            scale=np.append(self.prior.scale, RIM_STD),
            mean=np.append(self.prior.mean, 0.0),
        )
        return replace(self.normal, gram=gram, projection=projection), prior

    def strips_at(self, log_amplitude: Floats) -> _Found:
        """What every strip explains at given amplitudes of the prior, in closed form."""
        white = whiten(self.normal, self.prior, log_amplitude, 1.0)
        beta = white.sigma * white.mean
        seen = white.covariance @ (white.sigma[:, None] * self.crossed)
        left = self.projection - beta @ self.crossed
        power = self.own - np.sum(white.sigma[:, None] * self.crossed * seen, axis=0)
        # Without noise the difference of large numbers may be rounded to below zero.
        precision = 1 / RIM_STD**2 + np.maximum(power, 0.0)
        height = left / precision
        gain = 0.5 * (left * height - np.log(precision * RIM_STD**2))
        moved = beta - (white.sigma[:, None] * seen * height).T
        plain = self._log_evidence(white, beta, log_amplitude)
        return _Found(plain, gain, height, 1 / np.sqrt(precision), moved)

    def _log_evidence(self, white: Whitened, beta: Floats, log_amplitude: Floats) -> float:
        """Log evidence without a strip, from the unknowns that it makes likeliest."""
        prior = self.prior
        away = (log_amplitude - prior.log_amplitude) / prior.log_amplitude_std
        off = (beta - prior.mean) / white.sigma
        misfit = self.normal.misfit(beta) + float(off @ off) + float(away @ away)
        return float(np.log(np.diagonal(white.root)).sum()) - 0.5 * misfit


def _relative_edge_response(esf: Floats) -> Floats:
    """RER of ESFs about their 50 % points, which lie near the middle row; (k,)."""
    half = round(0.5 / _STEP_PX)
    rows = esf[half + 1 : -half - 1]
    first = np.clip(np.argmax(rows > 0.5, axis=0), 1, None) + half
    k = np.arange(esf.shape[1])
    low, high = esf[first, k], esf[first + 1, k]
    part = np.clip((0.5 - low) / np.maximum(high - low, 1e-9), 0.0, 1.0)

    def at(place: Floats) -> Floats:
        return np.asarray((1 - part) * esf[place, k] + part * esf[place + 1, k])

    return at(first + half) - at(first - half)


def _chances(model: _Model, found: _Found) -> Floats:
    """Posterior probability of every strip, (k,); what they lack to one is that of none."""
    odds = found.gain + np.log(model.odds(found.height))
    return np.asarray(np.exp(odds - np.logaddexp.reduce(np.append(odds, 0.0))))


def _compared(model: _Model) -> _Found:
    """What every strip explains, at the amplitudes of the prior that suit it.

    The amplitudes without a strip are those at which the LSF follows it as far as it can. Those of
    the most likely strip of either kind (that steepens the edge, and that widens it) are tried for
    all of them.
    """
    start = model.prior.log_amplitude
    plain = _settled(model.normal, model.prior, start)
    tried = [model.strips_at(start), model.strips_at(plain)]
    found = _best(tried)
    if float(found.gain.max()) < _MIN_GAIN:
        return found
    steepens = found.height * _outwards(model.strips) > 0
    for kind in (steepens, ~steepens):
        if kind.any():
            likely = int(np.argmax(np.where(kind, found.gain, -np.inf)))
            tried.append(model.strips_at(_settled(*model.with_strip(likely), plain)))
    return _best(tried)


def _best(tried: list[_Found]) -> _Found:
    """What every strip explains at the best of some amplitudes."""
    gains = np.array([one.gain + one.plain for one in tried])
    best = np.argmax(gains, axis=0)
    own = (best, np.arange(best.size))
    plain = max(one.plain for one in tried)
    return _Found(
        plain,
        gains[own] - plain,
        np.array([one.height for one in tried])[own],
        np.array([one.height_std for one in tried])[own],
        np.array([one.beta for one in tried])[own],
    )


def _settled(normal: Normal, prior: Prior, log_amplitude: Floats) -> Floats:
    """The likeliest amplitudes of the prior, the noise being one."""
    return likeliest_amplitudes(
        normal, prior, log_amplitude, 1.0, tolerance=_SETTLED, most=_MAX_STEPS
    )


def _outwards(strips: tuple[tuple[str, float], ...]) -> Floats:
    """1 for strips on the bright side, -1 for those on the dark one, (k,)."""
    return np.array([1.0 if side == "bright" else -1.0 for side, _ in strips])


def _strip_splines(blur: GaussianPixel, strips: tuple[tuple[str, float], ...]) -> Floats:
    """Spline coefficients of strips of unit height, (CELLS + 3, k)."""
    width = blur.width_px
    outwards = _outwards(strips)
    places = np.append(0.0, outwards * [px for _, px in strips])
    lsf = blur.lsf((CENTRES[:, None] * width - places).ravel()).reshape(CENTRES.size, -1)
    steps = esf_from_lsf(quasi_interpolant(width * lsf))
    return np.asarray(outwards * (steps[:, :1] - steps[:, 1:]))
