"""Several measurements of one target, and the candidates that were not measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from acutance.curves import Estimate
from acutance.curves.short_repr import ShortRepr
from acutance.geometry.line import Orientation
from acutance.targets.measurement import Measurement

if TYPE_CHECKING:
    from acutance.targets.conformity import Conformity, ToleranceLimit

__all__ = ["EdgeGroup", "Rejected", "TargetResult"]

One = TypeVar("One", bound=Measurement, covariant=True)

_MAIN = ("mtf_nyquist", "rer", "fwhm_px")
_STRANGE = 1e-3
"""Chance of a chi-square below which edges disagree."""


@dataclass(frozen=True)
class Rejected:
    """A candidate that was not measured: at which stage, why, and the numbers behind it.

    Attributes
    ----------
    stage : {"image", "date", "region", "find", "options", "fit", "contrast"}
    reason : str
    values : dict
        Where it lies: in pixels of the whole image (``row``, ``col``) with its ``normal_deg``, or
        the number of the region (``place``), its file (``path``) and the ``roi`` itself.
    """

    stage: str
    reason: str
    values: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class EdgeGroup(ShortRepr, Generic[One]):
    """Edges of one orientation and their mean.

    Attributes
    ----------
    orientation : {"across", "along"}
    measurements : tuple of Measurement
        Those the means are of: good and usable ones; where there are none, doubtful ones; invalid
        ones only where there is no other.
    metrics : dict of Estimate
        Means weighted by 1 / std^2. What their uncertainty budgets have in common (the shape left
        to the prior, what was stated) does not average out. Where the edges disagree beyond their
        standard deviations, the rest is widened by the square root of chi-square per degree of
        freedom.
    chi_square, p_value : dict of float
        Consistency: chi-square of the edges about the mean, and the chance of a larger one; ``nan``
        for a single edge, and where it is not defined (below).
    degrees_of_freedom : int
    left_out : tuple of Measurement
        Edges of the orientation with a graver verdict.

    Notes
    -----
    No metric can be negative: a modulus below the noise, or an overshoot that is not there,
    is reported as 0. Where one of the edges lies within its standard deviation of 0, the values
    are no longer Gaussian, and neither weights nor chi-square mean anything. The mean is then the
    plain one. As clipped errors do not average out, its standard deviation is the root mean square
    of the edges', or that of their scatter if it is larger; chi-square and p are ``nan``.
    """

    orientation: Orientation
    measurements: tuple[One, ...]
    metrics: Mapping[str, Estimate]
    chi_square: Mapping[str, float]
    p_value: Mapping[str, float]
    degrees_of_freedom: int
    left_out: tuple[One, ...] = ()

    @property
    def disagrees(self) -> bool:
        """Whether the edges differ by more than their standard deviations explain."""
        return any(chance < _STRANGE for chance in self.p_value.values())

    def summary(self) -> str:
        """Direction, how many edges, and the main means."""
        means = (f"{name} {self.metrics[name]}" for name in _MAIN if name in self.metrics)
        return ", ".join((self.orientation, f"edges {len(self.measurements)}", *means))


@dataclass(frozen=True, eq=False)
class TargetResult(ShortRepr, Generic[One]):
    """All edges of a target.

    Attributes
    ----------
    measurements : tuple of Measurement
        The strongest edge first.
    rejected : tuple of Rejected
    groups : dict of EdgeGroup
        By orientation.
    """

    measurements: tuple[One, ...]
    rejected: tuple[Rejected, ...]
    groups: Mapping[str, EdgeGroup[One]]

    def summary(self) -> str:
        """How many edges, and the main means of each group."""
        count = f"measured {len(self.measurements)}, rejected {len(self.rejected)}"
        return "; ".join((count, *(group.summary() for group in self.groups.values())))

    def conformity(self, *limits: ToleranceLimit | str) -> tuple[Conformity, ...]:
        """Whether the means meet requirements: see `Measurement.conformity`."""
        from acutance.targets.conformity import conformity_of

        return conformity_of(self, limits)

    def _repr_html_(self) -> str:
        from acutance.report import notebook_html

        return notebook_html(self)
