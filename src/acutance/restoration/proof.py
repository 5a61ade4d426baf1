"""The proof of a restoration: edges before and after it, beside what was predicted of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from acutance.curves import Estimate
from acutance.curves.estimate import normal_quantile
from acutance.curves.short_repr import ShortRepr

__all__ = ["RestorationProof", "VerifiedEdge"]

_AGREES_LEVEL = 0.95
_SAME_LINE_DEG = 0.5
_UNLIKE, _DESIGN_STD = 4.0, 0.01
"""Deviations from the design that are named; what sensors add between their axes. Of 96 edges at 4
to 40 degrees behind four sensors, two of them smeared along one axis, the largest is 1.6."""
_NOISE_OFF = 0.2
"""Share of the noise gain by which that of an edge may differ. Of 300 edges of 30 and 60 px in
white noise (SNR 20 to 300, noise gain 1.4 and 2.2) the largest differs by .095."""
_SHARED_AND_OWN_ERROR: dict[str, tuple[float, float]] = {
    "spline": (0.0, 0.005),
    "sdsu-2005": (0.95, 0.006),
    "kompsat-2014": (0.0, 0.05),
    "iso12233": (0.95, 0.004),
    "fermi": (0.0, 0.06),
}
"""By method: correlation of the errors before and after, and what it errs by besides, in MTF.

From simulated edges of three sensors at SNR 40, 100 and 300, kernels of noise gain 1.4 and 2.2.
Plain methods read both images by the same sums, so their errors are the same. The reference sees
another sensor after the filter, with what it expects of that, and the errors are nearly
independent. Methods that fit a shape miss one that overshoots."""


@dataclass(frozen=True, eq=False)
class VerifiedEdge(ShortRepr):
    """An edge, or the mean of a scene's edges across or along track, before and after a filter.

    Parameters
    ----------
    name : str
    normal_deg : float or None
        Direction of the normal; ``None`` of a mean of edges of several directions.
    before, after : Estimate
        MTF at Nyquist as measured.
    predicted : Estimate
        That before, times the filter's own transfer there.
    snr_before, snr_after : float
        As measured; of a scene the medians.
    overshoot : Estimate
        After, as measured.
    method : str
        Of `acutance.measure_edge`.
    turned_deg : float
        Angle between the lines found before and after.
    designed : Estimate, optional
        MTF at Nyquist along the normal that the filter was designed for.
    count : int
        Edges, of a mean.
    white_noise_gain : float, optional
        By how much the filter amplifies white noise.
    """

    name: str
    normal_deg: float | None
    before: Estimate
    after: Estimate
    predicted: Estimate
    snr_before: float
    snr_after: float
    overshoot: Estimate
    method: str = "spline"
    turned_deg: float = 0.0
    designed: Estimate | None = None
    count: int = 1
    white_noise_gain: float | None = None

    @property
    def off(self) -> float:
        """Measured minus predicted."""
        return self.after.value - self.predicted.value

    @property
    def difference(self) -> Estimate:
        """Measured minus predicted, with its deviation.

        Both measurements see the same pixels, and how much of their errors is the same depends on
        the method: by the reference next to nothing, by "iso12233" and "sdsu-2005" nearly all, as
        long as both find the same line. So the deviation is the root of the sum of both squares,
        less what they share, with what the method errs by besides. Within two deviations are, in
        simulations, .99 of 630 differences by the reference, .97 of 300 after kernels that aim at
        points, and .94 to 1 of 590 by the other methods.
        """
        shared, own = _SHARED_AND_OWN_ERROR[self.method]
        if abs(self.turned_deg) > _SAME_LINE_DEG:
            shared = 0.0
        after, predicted = self.after.std, self.predicted.std
        noise = after**2 + predicted**2 - 2 * shared * after * predicted
        return Estimate(self.off, math.sqrt(noise + own**2))

    @property
    def deviations(self) -> float:
        """How many of its deviations the difference has."""
        return self.off / self.difference.std

    @property
    def unlike_design(self) -> float:
        """How many deviations MTF at Nyquist before the filter is above what it was designed for.

        Negative below it; 0 where that is not known.
        """
        if self.designed is None:
            return 0.0
        known = self.designed.std if math.isfinite(self.designed.std) else 0.0
        return (self.before.value - self.designed.value) / math.hypot(
            self.before.std, known, _DESIGN_STD
        )

    @property
    def noise_gain(self) -> float:
        """SNR before over that after: the noise gain as the edge shows it."""
        return self.snr_before / self.snr_after

    @property
    def noise_off(self) -> float:
        """Its noise gain over that of white noise, less 1; 0 where one of them is not known."""
        ratio = self.noise_gain / self.white_noise_gain if self.white_noise_gain else math.nan
        return ratio - 1 if math.isfinite(ratio) else 0.0

    def to_dict(self) -> dict[str, Any]:
        """All numbers, for JSON."""
        return {
            "name": self.name,
            "normal_deg": self.normal_deg,
            "mtf_nyquist_before": self.before.to_dict(),
            "mtf_nyquist_after": self.after.to_dict(),
            "mtf_nyquist_predicted": self.predicted.to_dict(),
            "difference": self.difference.to_dict(),
            "deviations": self.deviations,
            "mtf_nyquist_designed": None if self.designed is None else self.designed.to_dict(),
            "overshoot_after": self.overshoot.to_dict(),
            "snr_before": self.snr_before,
            "snr_after": self.snr_after,
            "noise_gain": self.noise_gain,
            "noise_gain_predicted": self.white_noise_gain,
        }


@dataclass(frozen=True, eq=False)
class RestorationProof(ShortRepr):
    """Edges before and after a filter.

    Parameters
    ----------
    edges : tuple of VerifiedEdge
    rejected : tuple of str
        Regions without a result, and why.
    """

    edges: tuple[VerifiedEdge, ...]
    rejected: tuple[str, ...] = ()

    @property
    def worst(self) -> VerifiedEdge:
        """The edge whose difference has the most deviations."""
        return max(self.edges, key=lambda one: abs(one.deviations))

    @property
    def limit(self) -> float:
        """Deviations that the worst of so many edges keeps in 95 % of all proofs that agree."""
        return normal_quantile(_AGREES_LEVEL ** (1 / len(self.edges)))

    @property
    def agrees(self) -> bool:
        """Whether every edge was measured as predicted, within its deviation."""
        return abs(self.worst.deviations) <= self.limit

    @property
    def noise_agrees(self) -> bool:
        """Whether SNR changed as that of white noise does, on every edge."""
        return all(abs(one.noise_off) <= _NOISE_OFF for one in self.edges)

    @property
    def sentence(self) -> str:
        """Whether the image is as sharp as predicted, in words of deviations."""
        worst = self.worst
        count = sum(one.count for one in self.edges)
        of = f"{count} edges" if count > 1 else "the edge"
        by = f"{worst.name} by {worst.difference.value:+.4f} ± {worst.difference.std:.4f}"
        if self.agrees:
            noise = "" if self.noise_agrees else " in sharpness, not in noise"
            return (
                f"agrees with the prediction{noise}: {of} within {abs(worst.deviations):.1f} "
                f"deviations (at most {self.limit:.1f} are expected)"
            )
        return (
            f"does not agree with the prediction: {by}, {abs(worst.deviations):.1f} deviations "
            f"(at most {self.limit:.1f} are expected)"
        ).replace("-", "−")

    @property
    def notes(self) -> tuple[str, ...]:
        """Where the image is not that of the sensor the filter was designed for, or its noise."""
        return (*self._unlike_notes, *self._noise_notes)

    @property
    def _noise_notes(self) -> tuple[str, ...]:
        if self.noise_agrees:
            return ()
        worst = max(self.edges, key=lambda one: abs(one.noise_off))
        why = (
            "it was resampled or compressed, or is texture of the ground"
            if worst.noise_off < 0
            else "it was sharpened before, or values were rounded"
        )
        return (
            f"{worst.name}: SNR is divided by {worst.noise_gain:.2f}, and white noise is amplified "
            f"by {worst.white_noise_gain:.2f}: the image's noise is not white ({why}); SNR and "
            "NIIRS after the filter are not those of the design",
        )

    @property
    def _unlike_notes(self) -> tuple[str, ...]:
        unlike = max(self.edges, key=lambda one: abs(one.unlike_design))
        if unlike.designed is None or abs(unlike.unlike_design) < _UNLIKE:
            return ()
        why = (
            "it is of another sensor or band, or was sharpened before"
            if unlike.unlike_design > 0
            else "it is of another sensor or band, or its borders are soft themselves"
        )
        return (
            f"{unlike.name}: before the filter MTF at Nyquist is {unlike.before}, and the filter "
            f"was designed for {unlike.designed} ({abs(unlike.unlike_design):.0f} deviations): "
            f"{why}; it does not become what the design promises",
        )

    def summary(self) -> str:
        """Whether measured and predicted agree."""
        return self.sentence

    def to_dict(self) -> dict[str, Any]:
        """All edges, for JSON."""
        return {
            "agrees": self.agrees,
            "noise_agrees": self.noise_agrees,
            "sentence": self.sentence,
            "notes": list(self.notes),
            "edges": [one.to_dict() for one in self.edges],
            "rejected": list(self.rejected),
        }
