"""What the reference's own transfer must answer."""

from __future__ import annotations

from typing import Protocol

from acutance.curves.grid import Floats
from acutance.targets.pair.tile import Complexes

__all__ = ["ReferenceOtf"]


class ReferenceOtf(Protocol):
    """The reference's own OTF, at frequencies in cycles per pixel of the LOW image."""

    @property
    def only_direction(self) -> str | None:
        """The single direction it was measured in, in words; ``None`` where it is known in all."""
        ...

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,), 1 at zero frequency."""
        ...

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k), 0 at zero frequency."""
        ...
