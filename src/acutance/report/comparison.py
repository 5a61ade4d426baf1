"""Several measurements of one target, held against each other or against the truth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np

from acutance.arguments import require_all
from acutance.curves import Estimate, Response
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError
from acutance.targets import Measurement, Record, Rejected, TargetResult
from acutance.targets.straight.pulse_response import prf_fwhm

__all__ = ["Comparison", "Result", "as_result", "compare"]


@dataclass(frozen=True, eq=False)
class Comparison(ShortRepr):
    """One target measured in several ways.

    Parameters
    ----------
    measurements : tuple of Measurement
        The first is the one that others are compared to where the truth is not known.
    truth : dict of Response, optional
        The true curves of a simulated target by direction, "across" and "along".
    true_numbers : dict of Estimate, optional
        What else is known of it, by the names of the measurements: "width_px".
    rejected : tuple of Rejected, optional
        What could not be measured, and why; `values` hold the "method".
    names : tuple of str, optional
        What the measurements are called, where it is not the method that differs.
    """

    measurements: tuple[Measurement, ...]
    truth: Mapping[str, Response] = field(default_factory=dict)
    true_numbers: Mapping[str, Estimate] = field(default_factory=dict)
    rejected: tuple[Rejected, ...] = ()
    names: tuple[str, ...] = ()

    @property
    def labels(self) -> tuple[str, ...]:
        """Short names, all different: their own, methods, or numbers where methods repeat."""
        if self.names:
            return self.names
        methods = [one.method for one in self.measurements]
        if len(set(methods)) == len(methods):
            return tuple(methods)
        return tuple(f"{number} {method}" for number, method in enumerate(methods, start=1))

    @property
    def directions(self) -> tuple[str, ...]:
        """The directions that all of them measured."""
        return tuple(
            name
            for name in self.measurements[0].measured_directions
            if all(name in one.measured_directions for one in self.measurements)
        )

    def summary(self) -> str:
        """How many measurements of what, and their methods."""
        return f"{self.measurements[0].kind} by {', '.join(self.labels)}"


def compare(
    measurements: Sequence[Measurement],
    *,
    truth: Response | Mapping[str, Response] | None = None,
    true_width_px: float | None = None,
) -> Comparison:
    """Hold several measurements of one target against each other, or against the truth.

    Parameters
    ----------
    measurements : sequence of Measurement
    truth : Response or dict of Response, optional
        The true curves of a simulated target: in its one direction, or by direction.
    true_width_px : float, optional
        The true width of a simulated pulse.

    Returns
    -------
    Comparison
        To be drawn, tabulated and written as any result.

    Raises
    ------
    OptionError
        If these are no measurements, or share no direction; if the truth is none.
    """
    measurements = require_all(object, "measurements", measurements)
    if not isinstance(truth, Response | Mapping | None):
        raise OptionError(f"truth is {truth!r:.80}: give a Response, or a dict by direction")
    plain = as_result(Comparison(tuple(measurements)))
    assert isinstance(plain, Comparison)
    by_direction = (
        {plain.directions[0]: truth} if isinstance(truth, Response) else dict(truth or {})
    )
    response = by_direction.get(plain.directions[0])
    return replace(plain, truth=by_direction, true_numbers=_true_widths(response, true_width_px))


def _true_widths(truth: Response | None, width_px: float | None) -> dict[str, Estimate]:
    """Widths of a simulated pulse and of its response, under the names of its measurements."""
    if width_px is None:
        return {}
    widths = {"width": Estimate(width_px)}
    if truth is not None:
        widths["prf_fwhm"] = prf_fwhm(truth, width_px, np.empty(0))
    found = {f"{name}_px": width for name, width in widths.items()}
    if truth is not None and truth.gsd_m is not None:
        found |= {f"{name}_m": width * truth.gsd_m for name, width in widths.items()}
    return found


Result: TypeAlias = "Measurement | TargetResult[Measurement] | Comparison | Sequence[Measurement]"
"""What can be drawn, tabulated and written."""


def as_result(result: Result) -> Measurement | TargetResult[Measurement] | Comparison:
    """A result as it is; a plain sequence of measurements as a comparison.

    Raises
    ------
    OptionError
        If it is no result, or holds none, or measurements that share no direction.
    """
    if isinstance(result, Measurement | TargetResult):
        return result
    if isinstance(result, Record):
        raise OptionError(
            "a record has no pixels: give the measurement itself here; text, tables and page take "
            "records"
        )
    if not isinstance(result, Comparison):
        if not isinstance(result, Sequence) or isinstance(result, str):
            raise OptionError(
                f"a report of type {type(result).__name__} was asked for: give a measurement, all "
                "edges of a target, or a list of measurements"
            )
        result = Comparison(tuple(result))
    wrong = [one for one in result.measurements if not isinstance(one, Measurement)]
    if wrong or not result.measurements:
        found = type(wrong[0]).__name__ if wrong else "nothing"
        raise OptionError(f"a comparison holds {found}: give measurements of one target")
    if not result.directions:
        raise OptionError(
            "the measurements to be compared share no direction: compare those of one target"
        )
    return result
