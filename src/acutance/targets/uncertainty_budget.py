"""The uncertainty budget of a measurement: which causes make up its standard deviations.

A row is one cause in one direction, with the standard deviation it gives to each main number and
its share of the variance; the shares of a direction add up to one. The table follows the Guide to
the expression of uncertainty in measurement (GUM, JCGM 100:2008): evaluation "A" is by statistics
of the pixels, "B" by anything else, a prior or a statement.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from acutance.curves import MAIN_NUMBERS, Response
from acutance.curves.grid import Floats
from acutance.geometry.line import Orientation
from acutance.targets.document_fields import refuse_damaged

__all__ = [
    "MAIN_NUMBERS",
    "STATED_TERMS",
    "SYSTEMATIC_TERMS",
    "TERMS",
    "BudgetTerm",
    "TermWords",
    "budget_rows",
    "least_systematic_share",
    "main_stds",
    "std_of_mean",
    "systematic_share",
]

_DIGITS = 4


class TermWords(NamedTuple):
    """What a term of a budget is.

    Attributes
    ----------
    label : str
    evaluation : {"A", "B"}
        By statistics of the pixels, or otherwise.
    found_by : str
        How its standard deviation is found.
    """

    label: str
    evaluation: Literal["A", "B"]
    found_by: str


TERMS = {
    "pixel_noise": TermWords(
        "noise of the pixels", "A",
        "residuals of the fit, propagated with line and background held",
    ),
    "prior_shape": TermWords(
        "shape left to the prior", "B",
        "LSF and contrast as the prior allows them where the pixels do not determine them",
    ),
    "background": TermWords(
        "background beside the target", "A",
        "trends and steps of the plateaus, fitted with the LSF; of a pulse its height ratio, too",
    ),
    "line": TermWords("line", "A", "rotation and curvature, fitted with the LSF"),
    "pulse_width": TermWords("width of the pulse", "A", "fitted with the LSF"),
    "halo": TermWords("halo of a pulse", "B", "a share of the halo, from simulated pulses"),
    "reference_noise": TermWords(
        "noise of the reference", "B",
        "its power, estimated from quiet blocks, with what may be texture of the ground",
    ),
    "reference_mtf": TermWords("MTF of the reference", "B", "as it was stated or measured"),
    "light_from_beyond": TermWords(
        "light from beyond the image", "B",
        "two guesses of the ground there: the border repeated, and mirrored",
    ),
    "kernel_shape": TermWords(
        "shape of the kernel", "B",
        "a share of the departure from a Gaussian, from simulated pairs without noise",
    ),
    "target_softness": TermWords("softness of the target's border", "B", "stated"),
    "level_uncertainty": TermWords("levels of the target", "B", "stated"),
    "shared_softness": TermWords(
        "softness that all objects may share", "A",
        "a blur all around that is the sensor's or all objects', beyond the normal approximation",
    ),
    "parts_scatter": TermWords(
        "scatter of the scene's parts", "A",
        "blur of nine parts of the scene, or four, beyond its own deviations",
    ),
    "row_scatter": TermWords("scatter of the rows", "A", "draws of the rows, as published"),
    "fit": TermWords(
        "noise and prior together", "A",
        "covariance of the fit; what the prior (type B) has of it is not separated",
    ),
}  # fmt: skip
"""Every term by the name that budgets and documents have."""

SYSTEMATIC_TERMS = frozenset(
    ("prior_shape", "halo", "kernel_shape", "reference_mtf", "target_softness", "level_uncertainty")
)
"""Terms that measurements of one sensor share: a mean of a hundred has them in full."""

STATED_TERMS = frozenset(("reference_mtf", "target_softness", "level_uncertainty"))
"""Those of them that were stated: another measurement of the same target errs by the same."""


@dataclass(frozen=True)
class BudgetTerm:
    """One row of an uncertainty budget.

    Parameters
    ----------
    direction : {"across", "along"}
    name : str
        A key of `TERMS`.
    std : mapping of str to float
        Standard deviation it gives to each of `MAIN_NUMBERS`; ``nan`` of a number that does not
        exist.
    share : mapping of str to float
        Its part of the number's variance, 0 to 1.
    """

    direction: Orientation
    name: str
    std: Mapping[str, float]
    share: Mapping[str, float]

    @property
    def words(self) -> TermWords:
        """Label, evaluation and how it is found."""
        return TERMS.get(self.name, TermWords(self.name.replace("_", " "), "B", ""))

    def to_dict(self) -> dict[str, Any]:
        """The row for JSON, its numbers rounded to four digits."""
        return {
            "direction": self.direction,
            "term": self.name,
            "evaluation": self.words.evaluation,
            "found_by": self.words.found_by,
            "std": _rounded(self.std),
            "share": _rounded(self.share),
        }

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> BudgetTerm:
        """The row that `to_dict` wrote.

        Raises
        ------
        OptionError
            If it is none, or damaged.
        """
        with refuse_damaged("a row of an uncertainty budget", "give what to_dict() returned"):
            std, share = (_with_nan(document[name]) for name in ("std", "share"))
            return cls(document["direction"], str(document["term"]), std, share)


def budget_rows(
    direction: Orientation, stds: Mapping[str, Mapping[str, float]]
) -> tuple[BudgetTerm, ...]:
    """The rows of one direction.

    Parameters
    ----------
    direction : {"across", "along"}
    stds : mapping of str to mapping of str to float
        By term the standard deviation it gives to each of `MAIN_NUMBERS`. The terms are
        independent: their variances add up to that of the number.
    """
    variance = {number: sum(std[number] ** 2 for std in stds.values()) for number in MAIN_NUMBERS}
    return tuple(
        BudgetTerm(
            direction, name, std,
            {
                number: std[number] ** 2 / variance[number] if variance[number] > 0 else math.nan
                for number in MAIN_NUMBERS
            },
        )
        for name, std in stds.items()
    )  # fmt: skip


def main_stds(response: Response) -> dict[str, float]:
    """Standard deviations of `MAIN_NUMBERS` of some curves."""
    return {number: getattr(response, number).std for number in MAIN_NUMBERS}


def systematic_share(
    budget: Iterable[BudgetTerm],
    direction: str,
    number: str,
    terms: frozenset[str] = SYSTEMATIC_TERMS,
) -> float:
    """Part of a number's variance that does not average out over measurements of one sensor.

    It is the part of `terms`. Of a number without a budget, or that does not exist, it is the
    largest of those that have one, and all of it where none has; one in metres has that of the
    same in pixels.
    """
    return max(_systematic_shares(budget, direction, number, terms))


def least_systematic_share(budget: Iterable[BudgetTerm], direction: str, number: str) -> float:
    """The same, the smallest of those that have one: by the rest of its variance measurements of
    one sensor may surely differ."""
    return min(_systematic_shares(budget, direction, number, SYSTEMATIC_TERMS))


def _systematic_shares(
    budget: Iterable[BudgetTerm], direction: str, number: str, terms: frozenset[str]
) -> list[float]:
    """That of a number which has a budget, of another one those of all that have."""
    number = number.removesuffix("_m") + "_px" if number.endswith("_m") else number
    rows = [row for row in budget if row.direction == direction and row.name in terms]
    shares = {name: sum(row.share[name] for row in rows) for name in MAIN_NUMBERS}
    known = {name: share for name, share in shares.items() if math.isfinite(share)}
    return [known[number]] if number in known else [*known.values()] or [1.0]


def std_of_mean(weight: Floats, std: Floats, share: Floats, widened: float = 1.0) -> float:
    """Standard deviation of a weighted mean of measurements whose errors are common in part.

    Parameters
    ----------
    weight : (n,) array
        With a sum of 1.
    std : (n,) array
    share : (n,) array
        Part of every variance that all have in common (`systematic_share`).
    widened : float, optional
        Factor on what they do not have in common.

    Returns
    -------
    float
        ``sqrt(widened^2 sum w^2 s^2 (1 - c) + (sum w s sqrt(c))^2)``.
    """
    own = widened * float(np.linalg.norm(weight * std * np.sqrt(1 - share)))
    return math.hypot(own, float(weight @ (std * np.sqrt(share))))


def _rounded(numbers: Mapping[str, float]) -> dict[str, float | None]:
    return {
        name: float(f"{number:.{_DIGITS}g}") if math.isfinite(number) else None
        for name, number in numbers.items()
    }


def _with_nan(numbers: Mapping[str, float | None]) -> dict[str, float]:
    return {name: math.nan if one is None else float(one) for name, one in numbers.items()}
