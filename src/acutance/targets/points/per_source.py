"""Least squares in which every source has unknowns of its own, and all share some.

The own unknowns are eliminated source by source (a QR factor each); what is left are normal
equations in the shared ones, after which the own ones follow.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
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
    count, q, pixels = starts.size - 1, own.shape[1], root.size
    # What ties a source's unknowns to zero are q more rows for it, after all pixels.
    bound = np.zeros(q) if tie is None else tie
    axes = np.concatenate([own * root[:, None], np.tile(np.diag(bound), (count, 1))])
    left = np.zeros((axes.shape[0], shared.shape[1] + 1))
    np.multiply(shared, root[:, None], out=left[:pixels, :-1])
    np.multiply(data, root, out=left[:pixels, -1])
    inverse, along = _eliminate(axes, left, starts)
    own_along = inverse @ along
    free = q if tie is None else int(np.count_nonzero(tie == 0))
    return Blocks(
        np.ascontiguousarray(left[:, :-1]), left[:, -1].copy(), inverse, own_along[:, :, :-1],
        own_along[:, :, -1], np.einsum("ij,ij->i", axes[:pixels], axes[:pixels]),
        float(np.log(np.abs(np.einsum("kii->ki", inverse))).sum()), pixels - count * free,
    )  # fmt: skip


@compiled
def _eliminate(axes: Floats, left: Floats, starts: NDArray[np.intp]) -> tuple[Floats, Floats]:
    """Take out of the columns of a system what the own unknowns of each source explain.

    By Gram and Schmidt's method in its modified form, source by source.

    Parameters
    ----------
    axes : (n + k q, q) array
        Columns of the own unknowns, the pixels first, then q rows that tie those of each source;
        they become orthonormal within a source.
    left : (n + k q, c) array
        The system's other columns; what the axes explain of them is taken out.
    starts : (k + 1,) int array
        Where each source's pixels start, and the end.

    Returns
    -------
    inverse : (k, q, q) array
        Inverses of the triangular factors: old columns times it are the axes.
    along : (k, q, c) array
        What was taken out, along the axes.
    """
    count, q, width = starts.size - 1, axes.shape[1], left.shape[1]
    pixels = starts[count]
    inverse, along = np.zeros((count, q, q)), np.zeros((count, q, width))
    for k in range(count):
        first, size = starts[k], starts[k + 1] - starts[k]
        rows = np.empty(size + q, np.intp)
        for i in range(size):
            rows[i] = first + i
        for i in range(q):
            rows[size + i] = pixels + q * k + i
        own = inverse[k]
        for a in range(q):
            own[a, a] = 1.0
            for b in range(a):
                share = 0.0
                for i in rows:
                    share += axes[i, a] * axes[i, b]
                for i in rows:
                    axes[i, a] -= share * axes[i, b]
                for c in range(b + 1):
                    own[c, a] -= share * own[c, b]
            power = 0.0
            for i in rows:
                power += axes[i, a] ** 2
            length = np.sqrt(power)
            for i in rows:
                axes[i, a] /= length
            for c in range(a + 1):
                own[c, a] /= length
        for i in rows:
            for a in range(q):
                for c in range(width):
                    along[k, a, c] += axes[i, a] * left[i, c]
        for i in rows:
            for a in range(q):
                for c in range(width):
                    left[i, c] -= axes[i, a] * along[k, a, c]
    return inverse, along
