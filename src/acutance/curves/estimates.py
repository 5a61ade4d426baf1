"""Numbers and their standard deviations at many places of a curve."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, overload

import numpy as np

from acutance.arguments import require_floats
from acutance.curves.estimate import Estimate, normal_quantile, require_bounds
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError

__all__ = ["Estimates", "estimates_of"]

_FEW = 4


@dataclass(frozen=True, eq=False)
class Estimates(ShortRepr):
    """The estimates of a curve at an array of places, one a place.

    Parameters
    ----------
    value : (n,) array
        In the shape of the places, which may have any number of axes.
    std : (n,) array
        One standard deviation of each.
    lowest : float, optional
        What the quantity cannot fall below; see `Estimate`.

    Examples
    --------
    >>> found = Estimates(np.array([0.9, 0.5]), np.array([0.01, 0.02]))
    >>> print(found[1], len(found))
    0.500 ± 0.020 2
    >>> found
    <Estimates: 0.900 ± 0.010, 0.500 ± 0.020>

    Raises
    ------
    OptionError
        If they hold something else than numbers, or have different shapes.
    """

    value: Floats
    std: Floats
    lowest: float | None = None

    def __post_init__(self) -> None:
        for name in ("value", "std"):
            object.__setattr__(self, name, require_floats(name, getattr(self, name)))
        if self.value.ndim == 0 or self.value.shape != self.std.shape:
            raise OptionError(
                f"estimates of shape {self.value.shape} with deviations of shape {self.std.shape}: "
                "give two arrays of one shape, or a single number to Estimate"
            )
        require_bounds(lowest=self.lowest)

    def interval(self, level: float = 0.95) -> tuple[Floats, Floats]:
        """Lower and upper ends of the intervals of probability `level`; see `Estimate.interval`.

        Raises
        ------
        OptionError
            If `level` is no probability, or 0 or 1, which no interval has.
        """
        half = normal_quantile(level) * self.std
        low, high = self.value - half, self.value + half
        return low if self.lowest is None else np.maximum(low, self.lowest), high

    def summary(self) -> str:
        """The numbers, of many the first and the last."""
        pairs = list(zip(self.value.flat, self.std.flat, strict=True))
        shown = pairs if len(pairs) <= _FEW else [pairs[0], pairs[-1]]
        words = [str(Estimate(float(value), float(std))) for value, std in shown]
        if 0 < len(pairs) <= _FEW and self.value.ndim == 1:
            return ", ".join(words)
        count = f"{' x '.join(map(str, self.value.shape))} of them"
        return f"{count}, {words[0]} to {words[-1]}" if words else count

    def __len__(self) -> int:
        return len(self.value)

    @overload
    def __getitem__(self, index: int) -> Estimate: ...
    @overload
    def __getitem__(self, index: Any) -> Estimate | Estimates: ...
    def __getitem__(self, index: Any) -> Estimate | Estimates:
        """One estimate, or those of a slice or a mask."""
        return estimates_of(self.value[index], self.std[index], self.lowest)

    def __iter__(self) -> Iterator[Any]:
        return (self[index] for index in range(len(self)))


def estimates_of(value: Any, std: Any, lowest: float | None = None) -> Estimate | Estimates:
    """An `Estimate` of a number, the `Estimates` of an array."""
    if np.ndim(value) == 0:
        return Estimate(float(value), float(std), lowest)
    return Estimates(value, std, lowest)
