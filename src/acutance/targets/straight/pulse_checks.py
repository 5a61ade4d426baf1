"""Is this pulse good enough to tell? The edge's questions, and those of a strip.

Sources: Li et al., "On-orbit MTF estimation methods", 3.2; the pulse reports of 2003 and 2005.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.targets.measurement import Check
from acutance.targets.region import RegionPixels
from acutance.targets.straight import edge_checks as checks
from acutance.targets.straight import pixel_checks, structure_checks
from acutance.targets.straight.check_data import (
    MUCH,
    Evidence,
    TargetChecks,
    at_least,
    at_most,
    at_most_much,
)
from acutance.targets.straight.fit_pulse import PulseBand
from acutance.targets.straight.options import PulseLimits
from acutance.targets.straight.pixels import EdgeFit
from acutance.targets.straight.published import PublishedPulse
from acutance.targets.straight.pulse_spectrum import zeros_cpp
from acutance.targets.straight.trim import Extent

__all__ = ["PulseChecks"]


@dataclass(frozen=True, eq=False, repr=False)
class PulseChecks(TargetChecks):
    """All target checks of a pulse.

    Parameters
    ----------
    cut, band, extent, fit
        What the measurement went through.
    width, fall : Estimate
        Width of the pulse in pixels, and height of its falling side over the rising one's.
    stated_px : float or None
        The width as stated.
    limits : PulseLimits
    by_ratio : bool
        Whether the method divides by the pulse's spectrum.
    """

    cut: RegionPixels
    band: PulseBand
    extent: Extent
    fit: EdgeFit
    width: Estimate
    fall: Estimate
    stated_px: float | None
    limits: PulseLimits
    by_ratio: bool

    @cached_property
    def _seen(self) -> Evidence:
        return Evidence.of(self.band, self.fit, self.width.value)

    @property
    def snr(self) -> float:
        """Peak less mean background, over the background's standard deviation (2005, 3.4.1)."""
        seen = self._seen
        std = seen.plateau_std
        far = seen.outside > seen.far_px
        if not (std > 0 and far.any()):
            return math.inf
        fitted = seen.value - seen.residual
        return float((fitted.max() - fitted[far].mean()) / std)

    @cached_property
    def answers(self) -> tuple[Check, ...]:
        """All checks of a pulse."""
        seen, limits = self._seen, self.limits
        return (
            self._contrast(),
            structure_checks.uniformity(seen, limits, "before", seen.before),
            structure_checks.uniformity(seen, limits, "behind", seen.behind),
            structure_checks.strip(seen, limits),
            checks.angle(self.fit, limits, self.by_ratio),
            checks.phases(seen, limits),
            checks.enough_rows(self.extent, limits),
            checks.straightness(seen, limits),
            structure_checks.ragged(seen, limits),
            checks.lsf_width(seen, limits),
            checks.plateau(limits, "before", self.extent.dark_px),
            checks.plateau(limits, "behind", self.extent.bright_px),
            pixel_checks.saturation(self.cut, self.band, seen, limits),
            pixel_checks.quantisation(self.cut, self.band, seen, limits),
            pixel_checks.gradient(seen, limits),
            pixel_checks.correlation(seen, limits),
            structure_checks.profile(seen, limits, self.width.value, self.by_ratio),
            pixel_checks.outliers(seen, limits),
            self._parallel(),
            self._grounds(),
            self._wide_enough(),
            self._width(),
            self._zeros(),
        )

    def _contrast(self) -> Check:
        value = min(self.snr, MUCH)
        return at_least(
            "contrast_snr", value, self.limits.contrast_snr,
            f"the pulse's peak stands {at_most_much(value)} standard deviations of the ground "
            "above it (the report of 2005, 3.4, asks 50)",
            "the intervals widen; choose a target of more contrast, or a longer one",
        )  # fmt: skip

    def _parallel(self) -> Check:
        """Whether the falling side turns against the rising one, from the residuals beside it."""
        seen = self._seen
        lsf = self.fit.response.lsf
        slope = -self.fall.value * np.interp(
            seen.behind, lsf.distance_px, lsf.value, left=0.0, right=0.0
        )
        # The line's direction is fitted to both sides: half of a turn shows on either.
        power = float(slope**2 @ seen.t**2)
        turn = -float((slope * seen.t) @ seen.residual) / power if power > 0 else 0.0
        std = seen.noise / math.sqrt(power) if power > 0 else 0.0
        value = 2 * abs(math.degrees(turn)) if abs(turn) > 3 * std else 0.0
        return at_most(
            "parallel_deg", value, self.limits.parallel_deg,
            f"the two sides are inclined by {value:.2f} degrees to each other (Li et al. 3.2: a "
            "pulse has parallel sides)",
            "the width then changes along the target; choose another part, or another target",
        )  # fmt: skip

    def _grounds(self) -> Check:
        value = abs(1 - self.fall.value)
        return at_most(
            "ground_step", value, self.limits.ground_step,
            f"the two grounds differ by {100 * value:.0f} % of the pulse's height",
            "the joint fit allows for it, the ratio to a symmetric pulse does not",
        )  # fmt: skip

    def _width(self) -> Check:
        """Whether the stated width agrees with the data."""
        limit = self.limits.width_sigmas
        if self.stated_px is None or not self.width.std > 0:
            return Check(
                "width_sigmas", 0.0, f"<= {limit:g}", True,
                f"the width is {self.width} px; no other was stated or none was fitted",
            )  # fmt: skip
        away = self.width.value - self.stated_px
        value = abs(away) / self.width.std
        return at_most(
            "width_sigmas", value, limit,
            f"the fitted width is {self.width} px, the stated one {self.stated_px:.4f} px: "
            f"{away:+.4f} px, {value:.1f} standard deviations",
            "measure the target again, and check the GSD",
        )  # fmt: skip

    def _wide_enough(self) -> Check:
        value = self.width.value
        return at_least(
            "width_px", value, self.limits.width_px,
            f"the pulse is {value:.2f} px wide (Li et al. 3.2: 3 px is the best, and with one or "
            "less no good estimate is left)",
            "the narrower, the less signal; use a target of three times the GSD",
        )  # fmt: skip

    def _zeros(self) -> Check:
        """Whether what is reported lies clear of the zeros of the spectrum that is divided by."""
        response, limit = self.fit.response, self.limits.zero_distance_cpp
        reported = {"Nyquist": NYQUIST_CPP}
        if self.by_ratio:
            reported |= {"MTF50": response.mtf50_cpp.value, "MTF30": response.mtf30_cpp.value}
        zeros = zeros_cpp(self._divided_px)
        if zeros.size == 0:
            return Check(
                "zero_distance_cpp", 1.0, f">= {limit:g}" if self.by_ratio else "any", True,
                "the pulse's spectrum has no zero up to 1 c/px",
            )  # fmt: skip
        near = [_nearest(zeros, name, freq) for name, freq in reported.items() if freq > 0]
        value = min(distance for distance, _ in near)
        if not self.by_ratio:
            return Check(
                "zero_distance_cpp", value, "any", True,
                f"of the pulse's spectrum, {near[0][1]}: the joint fit bridges it, with wider "
                "intervals near it",
            )  # fmt: skip
        told = [words for distance, words in near if distance < limit] or [min(near)[1]]
        return at_least(
            "zero_distance_cpp", value, limit, f"of the pulse's spectrum, {'; '.join(told)}",
            "the ratio is unusable at a zero and says little near it (Li et al. 3.2); use method "
            "spline, or a target of another width",
        )  # fmt: skip

    @property
    def _divided_px(self) -> float:
        """Width of the pulse whose spectrum the measured one is divided by, or would be."""
        if isinstance(self.fit, PublishedPulse):
            return self.fit.ratio_width_px
        return self.width.value


def _nearest(zeros: Floats, name: str, freq_cpp: float) -> tuple[float, str]:
    """How far a frequency is from the zero next to it, and the same in words."""
    zero = float(zeros[np.argmin(np.abs(zeros - freq_cpp))])
    away = abs(freq_cpp - zero)
    return away, f"{name} ({freq_cpp:.3f} c/px) lies {away:.3f} from the zero at {zero:.3f}"
