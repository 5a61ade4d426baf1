"""A number and its standard deviation."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from numbers import Real
from statistics import NormalDist
from typing import Any, ClassVar, TypeGuard

from acutance.arguments import require_numbers
from acutance.errors import OptionError

__all__ = ["Estimate", "normal_quantile", "require_bounds"]

_MAX_DIGITS = 6
_ONLY_WIDTH = re.compile(r"(.?[<>^])?\d*")
"""Formats that say where a text stands, and nothing of its digits."""
_STANDARD_NORMAL = NormalDist()


def normal_quantile(level: float) -> float:
    """Half the width, in standard deviations, of the interval of probability `level`.

    Raises
    ------
    OptionError
        If `level` is no probability, or 0 or 1, which no interval has.
    """
    if not (isinstance(level, Real) and 0 < level < 1):
        raise OptionError(f"level is {level!r}: give a probability between 0 and 1, such as 0.95")
    return _quantile(float(level))


def require_bounds(**bounds: float | None) -> None:
    """Refuse bounds of a quantity that are neither numbers nor ``None``.

    Raises
    ------
    OptionError
        Names the bound.
    """
    require_numbers(**{name: bound for name, bound in bounds.items() if bound is not None})


@lru_cache
def _quantile(level: float) -> float:
    """The same of a number; every estimate of a measurement asks for that of 95 %."""
    return _STANDARD_NORMAL.inv_cdf(0.5 + level / 2)


@dataclass(frozen=True, eq=False)
class Estimate:
    """A measured number with its standard deviation.

    It adds to and multiplies with plain numbers, and compares to them and to other estimates by
    value (``<``, ``<=``, ``>``, ``>=``). Equality is that of all fields, so an estimate never
    equals a plain number. The sum or product of two estimates is refused, as their covariance is
    known to the curves they were read from, not to them; one without a deviation, a truth, is a
    number like any other.

    Parameters
    ----------
    value : float
        The estimate; ``nan`` where the quantity does not exist (an MTF that never falls to 0.3).
    std : float, optional
        One standard deviation, of everything the data can show. A truth has 0.
    lowest : float, optional
        What the quantity cannot fall below, 0 for an MTF or a width: intervals end there.
    highest : float, optional
        What it cannot exceed, 1 for a share: intervals end there, too.

    Raises
    ------
    OptionError
        If value, deviation or a bound is no number, or the deviation is negative.

    Examples
    --------
    >>> mtf_nyquist = Estimate(0.1511, 0.0032)
    >>> print(mtf_nyquist)
    0.1511 ± 0.0032
    >>> print(f"{mtf_nyquist:.3f}")
    0.151 ± 0.003
    >>> low, high = mtf_nyquist.interval(0.95)
    >>> print(2 * mtf_nyquist, mtf_nyquist > 0.1)
    0.3022 ± 0.0064 True
    """

    value: float
    std: float = 0.0
    lowest: float | None = None
    highest: float | None = None

    def __post_init__(self) -> None:
        # Thousands are made a second: one difference tells texts, None and negative deviations.
        try:
            wrong = bool(self.value - self.std > self.value)
        except (TypeError, ValueError):
            wrong = True
        if wrong:
            raise OptionError(
                f"an estimate of {self.value!r:.80} with a standard deviation of {self.std!r:.80}: "
                "give two numbers, the deviation not below 0; nan where one does not exist"
            )
        if self.lowest is not None or self.highest is not None:
            require_bounds(lowest=self.lowest, highest=self.highest)

    # numpy then leaves sums and products with its own scalars to the methods below.
    __array_ufunc__: ClassVar[None] = None

    def interval(self, level: float = 0.95) -> tuple[float, float]:
        """The interval that holds the truth with probability `level` (above 0, below 1).

        It is symmetric about the value, cut off where it would reach below `lowest` or above
        `highest`.

        Raises
        ------
        OptionError
            If `level` is no probability, or 0 or 1, which no interval has.
        """
        half = normal_quantile(level) * self.std
        low, high = self.value - half, self.value + half
        return (
            low if self.lowest is None else max(low, self.lowest),
            high if self.highest is None else min(high, self.highest),
        )

    def probability_above(self, limit: float) -> float:
        """How probable it is that the truth is at least `limit`, by a normal density.

        Certain of a bound that the quantity cannot cross; ``nan`` where the value or its deviation
        does not exist.

        Raises
        ------
        OptionError
            If `limit` is no number.
        """
        require_numbers(limit=limit)
        if math.isnan(self.value) or math.isnan(self.std):
            return math.nan
        if self.lowest is not None and limit <= self.lowest:
            return 1.0
        if self.highest is not None and limit > self.highest:
            return 0.0
        if self.std == 0:
            return float(self.value >= limit)
        return 0.5 * math.erfc((limit - self.value) / (math.sqrt(2) * self.std))

    def to_dict(self) -> dict[str, float | list[float] | None]:
        """Value, standard deviation and 95 % interval; ``None`` where they do not exist.

        A quantity with a bound has it as ``lowest`` or ``highest``: an interval that begins or
        ends there was cut off.
        """
        if not math.isfinite(self.value):
            return {"value": None, "std": None, "interval95": None}
        stated = math.isfinite(self.std)
        document: dict[str, float | list[float] | None] = {
            "value": self.value,
            "std": self.std if stated else None,
            "interval95": list(self.interval(0.95)) if stated else None,
        }
        bounds = {"lowest": self.lowest, "highest": self.highest}
        return document | {name: bound for name, bound in bounds.items() if bound is not None}

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Estimate:
        """The estimate that `to_dict` wrote; ``nan`` where it has ``None``.

        Raises
        ------
        OptionError
            If it is no such document.
        """
        try:
            value, std = (
                math.nan if document[name] is None else float(document[name])
                for name in ("value", "std")
            )
            bounds = document.get("lowest"), document.get("highest")
        except (TypeError, ValueError, LookupError, AttributeError):
            raise OptionError(
                f"{document!r:.80} is no document of an estimate: give what to_dict() wrote, with "
                "value and std"
            ) from None
        return cls(value, std, *bounds)

    def __float__(self) -> float:
        return float(self.value)

    def __eq__(self, other: object) -> bool:
        """Whether all fields are equal; ``nan`` equals ``nan``."""
        return self._key() == other._key() if isinstance(other, Estimate) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[float | None, ...]:
        value, std = (None if math.isnan(part) else part for part in (self.value, self.std))
        return value, std, self.lowest, self.highest

    def __lt__(self, other: float | Estimate) -> bool:
        return self.value < float(other) if _is_number(other) else NotImplemented

    def __le__(self, other: float | Estimate) -> bool:
        return self.value <= float(other) if _is_number(other) else NotImplemented

    def __gt__(self, other: float | Estimate) -> bool:
        return self.value > float(other) if _is_number(other) else NotImplemented

    def __ge__(self, other: float | Estimate) -> bool:
        return self.value >= float(other) if _is_number(other) else NotImplemented

    def __add__(self, other: float | Estimate) -> Estimate:
        return self._plus(1.0, other) if _is_one_exact(self, other, "sum") else NotImplemented

    def __sub__(self, other: float | Estimate) -> Estimate:
        one_exact = _is_one_exact(self, other, "difference")
        return self._plus(-1.0, other) if one_exact else NotImplemented

    def __rsub__(self, other: float) -> Estimate:
        return -self + other

    def __mul__(self, other: float | Estimate) -> Estimate:
        if not _is_one_exact(self, other, "product"):
            return NotImplemented
        if _is_uncertain(other):
            return other._linear(self.value, 0.0)
        return self._linear(float(other), 0.0)

    def __truediv__(self, other: float | Estimate) -> Estimate:
        if not _is_one_exact(self, other, "ratio"):
            return NotImplemented
        if _is_uncertain(other):
            return self.__rtruediv__(other)
        return self._linear(1 / float(other), 0.0)

    def __rtruediv__(self, other: object) -> Estimate:
        raise TypeError(
            "a number over an estimate has no standard deviation of its own, as it is not linear "
            "in it: use float() of the estimate"
        )

    def __neg__(self) -> Estimate:
        return self._linear(-1.0, 0.0)

    __radd__ = __add__
    __rmul__ = __mul__

    def _plus(self, sign: float, other: float | Estimate) -> Estimate:
        """``self + sign * other``, of which one at most has a deviation."""
        if _is_uncertain(other):
            return other._linear(sign, self.value)
        return self._linear(1.0, sign * float(other))

    def _linear(self, slope: float, offset: float) -> Estimate:
        """``slope * self + offset``; a negative slope exchanges the bounds."""
        slope, offset = float(slope), float(offset)
        ends = (self.lowest, self.highest) if slope >= 0 else (self.highest, self.lowest)
        bounds = (None if end is None else slope * end + offset for end in ends)
        return Estimate(slope * self.value + offset, abs(slope) * self.std, *bounds)

    def __format__(self, spec: str) -> str:
        """Value and standard deviation, both by `spec`; as `str` does where it has no digits."""
        if _ONLY_WIDTH.fullmatch(spec):
            return format(str(self), spec)
        if not math.isfinite(self.value):
            return "undefined"
        if not (self.std > 0 and math.isfinite(self.std)):
            return format(self.value, spec)
        return f"{self.value:{spec}} ± {self.std:{spec}}"

    def __str__(self) -> str:
        if not math.isfinite(self.value):
            return "undefined"
        if not (self.std > 0 and math.isfinite(self.std)):
            return f"{self.value:.4f}"
        if self.std < 10.0**-_MAX_DIGITS:
            return f"{self.value:.{_MAX_DIGITS}f} ± {self.std:.0e}"
        digits = min(1 - math.floor(math.log10(self.std)), _MAX_DIGITS)
        if digits < 0:
            return f"{round(self.value, digits):.0f} ± {round(self.std, digits):.0f}"
        return f"{self.value:.{digits}f} ± {self.std:.{digits}f}"


def _is_number(other: object) -> bool:
    return isinstance(other, Real | Estimate)


def _is_uncertain(one: object) -> TypeGuard[Estimate]:
    """Whether something is an estimate with a deviation, which a truth has not."""
    return isinstance(one, Estimate) and one.std != 0


def _is_one_exact(one: Estimate, other: object, operation: str) -> bool:
    """Whether `other` is a number, and it or the estimate has no deviation.

    Raises
    ------
    TypeError
        If both have one.
    """
    if _is_uncertain(one) and _is_uncertain(other):
        raise TypeError(
            f"the {operation} of two estimates has no standard deviation as long as their "
            "covariance is not known: use float() of one of them, or of both"
        )
    return _is_number(other)
