"""What the pixels of a straight target say of its transfer function (OTF), the prior apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.targets.otf_likelihood import OtfLikelihood

__all__ = ["PixelsAlone"]


@dataclass(frozen=True, eq=False)
class PixelsAlone(ShortRepr):
    """A normal posterior of the line spread function and the prior that it has.

    All by the columns of the curves' factors: spline and tail of the response to a step.

    Attributes
    ----------
    away : (c,) array
        Its mean minus that of the reported curves.
    posterior, prior : (c, ...) array
        Factors of the covariances.
    """

    away: Floats
    posterior: Floats
    prior: Floats

    def likelihood(
        self, rows: NDArray[np.complex128], from_expected: NDArray[np.complex128]
    ) -> OtfLikelihood:
        """The likelihood of the OTF about the reported one.

        Parameters
        ----------
        rows : (n, c) complex array
            Factor of the OTF at n frequencies.
        from_expected : (n,) complex array
            The reported OTF minus the one that was expected.
        """
        away = rows @ self.away
        found = OtfLikelihood.of_posterior(
            from_expected + away, rows @ self.posterior, rows @ self.prior
        )
        return found.about(-away)
