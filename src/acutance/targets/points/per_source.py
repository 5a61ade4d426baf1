"""Least squares in which every source has unknowns of its own, and all share some.

The own unknowns are eliminated source by source (a QR factor each); what is left are normal
equations in the shared ones, after which the own ones follow.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from acutance.curves.grid import Floats
from acutance.numerics.normal_equations import Normal

__all__ = ["Blocks", "SourceProblem"]


@dataclass(frozen=True, eq=False)
class Blocks:
    """The eliminated system of k sources with q own unknowns each, and m shared ones.

    Parameters
    ----------
    shared : (n + k q, m) array
        Weighted shared columns, without what the own ones explain; the pixels first, then the
        rows that tie the own unknowns to zero.
    data : (n + k q,) array
        Weighted data, likewise.
    inverse : (k, q, q) array
        Inverses of the triangular factors.
    own_shared : (k, q, m) array
        How much the own unknowns fall for every unit of the shared ones.
    own_data : (k, q) array
        The own unknowns when the shared ones are zero.
    leverage : (n,) array
        How much of a pixel's own noise the own unknowns take up, 0 to 1.
    log_volume : float
        Logarithm of the volume of the own unknowns' posterior at unit noise, but for a constant.
    count : int
        Number of pixels less that of the free own unknowns.
    """

    shared: Floats
    data: Floats
    inverse: Floats
    own_shared: Floats
    own_data: Floats
    leverage: Floats
    log_volume: float
    count: int

    @cached_property
    def normal(self) -> Normal:
        """Normal equations of the shared unknowns."""
        gram = self.shared.T @ self.shared
        return Normal(gram, self.shared.T @ self.data, float(self.data @ self.data), self.count)

    def own(self, shared: Floats) -> Floats:
        """The own unknowns that go with shared ones, (k, q)."""
        return np.asarray(self.own_data - self.own_shared @ shared)

    def own_factor(self, std: float, latent: Floats) -> tuple[Floats, Floats]:
        """Factors of the own unknowns' covariance: of their own noise, and of the shared ones'.

        Parameters
        ----------
        std : float
            Noise for unit weight.
        latent : (m, l) array
            Factor of the covariance of the shared unknowns.

        Returns
        -------
        (k, q, q) array
        (k, q, l) array
        """
        return std * self.inverse, -self.own_shared @ latent


@dataclass(frozen=True, eq=False)
class SourceProblem:
    """A least squares problem: what own and shared unknowns do to the pixels.

    Parameters
    ----------
    own : (n, q) array
        Columns of the own unknowns, one source's rows after the other's.
    shared : (n, m) array
        Columns of the shared unknowns.
    data : (n,) array
    starts : (k + 1,) int array
        Where each source's rows start, and the end.
    tie : (q,) array, optional
        Noise for unit weight over the prior standard deviation of an own unknown about zero; 0
        for one that is free.
    """

    own: Floats
    shared: Floats
    data: Floats
    starts: NDArray[np.intp]
    tie: Floats | None = None

    def eliminated(self, weight: Floats) -> Blocks:
        """The problem without its own unknowns, at inverse variances `weight` of the data, (n,)."""
        return _eliminated(self.own, self.shared, self.data, weight, self.starts, self.tie)


def _eliminated(
    own: Floats,
    shared: Floats,
    data: Floats,
    weight: Floats,
    starts: NDArray[np.intp],
    tie: Floats | None,
) -> Blocks:
    root = np.sqrt(weight)
    count, q = starts.size - 1, own.shape[1]
    # What ties a source's unknowns to zero are q more rows for it, after all pixels.
    bound = np.zeros((q, q)) if tie is None else np.diag(tie)
    own = own * root[:, None]
    shared = np.concatenate([shared * root[:, None], np.zeros((count * q, shared.shape[1]))])
    data = np.concatenate([data * root, np.zeros(count * q)])
    inverse = np.empty((count, q, q))
    own_shared = np.empty((count, q, shared.shape[1]))
    own_data = np.empty((count, q))
    leverage = np.empty(root.size)
    unit = np.eye(q)
    for k, (first, last) in enumerate(zip(starts[:-1].tolist(), starts[1:].tolist(), strict=True)):
        ties = slice(root.size + q * k, root.size + q * (k + 1))
        axes, triangle = np.linalg.qr(np.vstack([own[first:last], bound]))
        pixel_axes, tie_axes = axes[: last - first], axes[last - first :]
        leverage[first:last] = np.einsum("ij,ij->i", pixel_axes, pixel_axes)
        inverse[k] = solve_triangular(triangle, unit)
        along, along_data = pixel_axes.T @ shared[first:last], pixel_axes.T @ data[first:last]
        shared[first:last] -= pixel_axes @ along
        data[first:last] -= pixel_axes @ along_data
        shared[ties] -= tie_axes @ along
        data[ties] -= tie_axes @ along_data
        own_shared[k], own_data[k] = inverse[k] @ along, inverse[k] @ along_data
    free = q if tie is None else int(np.count_nonzero(tie == 0))
    log_volume = float(np.log(np.abs(np.einsum("kii->ki", inverse))).sum())
    return Blocks(
        shared, data, inverse, own_shared, own_data, leverage, log_volume, root.size - count * free
    )
