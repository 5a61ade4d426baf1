"""A number and its standard deviation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Real
from statistics import NormalDist

from acutance.errors import OptionError

__all__ = ["Estimate"]

_MAX_DIGITS = 6


@dataclass(frozen=True)
class Estimate:
    """A measured number with its standard deviation.

    Parameters
    ----------
    value : float
        The estimate; ``nan`` where the quantity does not exist (an MTF that never falls to 0.3).
    std : float, optional
        One standard deviation, of everything the data can show. A truth has 0.

    Examples
    --------
    >>> mtf_nyquist = Estimate(0.1511, 0.0032)
    >>> print(mtf_nyquist)
    0.1511 ± 0.0032
    >>> print(f"{mtf_nyquist:.3f}")
    0.151 ± 0.003
    >>> low, high = mtf_nyquist.interval(0.95)
    """

    value: float
    std: float = 0.0

    def interval(self, level: float = 0.95) -> tuple[float, float]:
        """The symmetric interval that holds the truth with probability `level` (0..1).

        Raises
        ------
        OptionError
            If `level` is no probability, or 1, which no interval reaches.
        """
        if not (isinstance(level, Real) and 0 <= level < 1):
            raise OptionError(
                f"level is {level!r}: give a probability between 0 and 1, such as 0.95"
            )
        half = NormalDist().inv_cdf(0.5 + level / 2) * self.std
        return self.value - half, self.value + half

    def scaled(self, factor: float) -> Estimate:
        """The same quantity in another unit."""
        return Estimate(self.value * factor, abs(factor) * self.std)

    def to_dict(self) -> dict[str, float | list[float] | None]:
        """Value, standard deviation and 95 % interval; ``None`` where they do not exist."""
        if not math.isfinite(self.value):
            return {"value": None, "std": None, "interval95": None}
        if not math.isfinite(self.std):
            return {"value": self.value, "std": None, "interval95": None}
        return {"value": self.value, "std": self.std, "interval95": list(self.interval(0.95))}

    def __float__(self) -> float:
        return self.value

    def __format__(self, spec: str) -> str:
        """Value and standard deviation, both by `spec`; without one as `str` does."""
        if not spec:
            return str(self)
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
        digits = min(max(0, 1 - math.floor(math.log10(self.std))), _MAX_DIGITS)
        return f"{self.value:.{digits}f} ± {self.std:.{digits}f}"
