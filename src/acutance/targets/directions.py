"""The directions of a result, by name: what a measurement and its record have in common."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

if TYPE_CHECKING:
    from acutance.targets.conformity import Conformity, ToleranceLimit
    from acutance.targets.measurement import Measurement
    from acutance.targets.record import Record

__all__ = ["HasDirections"]

One = TypeVar("One")


class HasDirections(Generic[One]):
    """Shortcuts of whatever has curves and numbers by direction, and how a notebook shows it."""

    if TYPE_CHECKING:

        @property
        def kind(self) -> str: ...

        @property
        def directions(self) -> Mapping[Any, One]: ...

    @property
    def across(self) -> One:
        """The curves and numbers across track: along the rows of pixels, if not declared else."""
        return self._direction("across")

    @property
    def along(self) -> One:
        """The curves and numbers along track: down the columns of pixels, if not declared else."""
        return self._direction("along")

    def _direction(self, name: str) -> One:
        if name not in self.directions:
            (found,) = self.directions
            raise AttributeError(
                f"this {self.kind} was measured {found} track, not {name}: read .{found}"
            )
        return self.directions[name]

    def conformity(self, *limits: ToleranceLimit | str) -> tuple[Conformity, ...]:
        """Whether requirements are met, with the probability: one answer a limit and direction.

        Parameters
        ----------
        *limits : ToleranceLimit or str
            "mtf_nyquist >= 0.09", or "along.fwhm_m <= 1.5" for one direction.

        Raises
        ------
        OptionError
            If a text states no limit.
        """
        from acutance.targets.conformity import conformity_of

        return conformity_of(self._whole, limits)

    def _repr_html_(self) -> str:
        from acutance.report import notebook_html

        return notebook_html(self._whole)

    @property
    def _whole(self) -> Measurement | Record:
        return cast("Measurement | Record", self)
