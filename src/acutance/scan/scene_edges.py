"""The edges of a scene, one array a column."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.scan.edge_table import EdgeTable

__all__ = ["SceneEdges"]


@dataclass(frozen=True, eq=False)
class SceneEdges(EdgeTable, ShortRepr):
    """Every edge that was found in a scene, (n,) arrays in the order of rows and columns.

    Parameters
    ----------
    row, col : float arrays
        Middle of the edge in pixels of the whole image; integers are pixel centres.
    normal_deg : float array
        Direction from dark to bright, from the column axis towards the row axis.
    length_px : float array
    place_std_px : float array
        Standard deviation of its place along the normal; NaN of an edge that was not measured, as
        the numbers that follow.
    snr : float array
        Contrast over noise.
    mtf_nyquist, mtf_nyquist_std, rer, rer_std, fwhm_px, fwhm_px_std : float arrays
        Of the edge along its normal: of sensor and object together.
    softness_px : float array
        Mean softness of the object, Gaussian standard deviation; NaN of edges that are not used.
    ideal : float array
        Probability that the object is ideal, with a softness of 0.1 px at most.
    used : bool array
        Whether the edge is part of the answer.
    verdict : str array
        good, usable, doubtful, invalid; "rejected" of an edge that could not be measured.
    reason : str array
        Why an edge is not used: the sentence of its verdict, or the error.
    """

    row: Floats
    col: Floats
    normal_deg: Floats
    length_px: Floats
    place_std_px: Floats
    snr: Floats
    mtf_nyquist: Floats
    mtf_nyquist_std: Floats
    rer: Floats
    rer_std: Floats
    fwhm_px: Floats
    fwhm_px_std: Floats
    softness_px: Floats
    ideal: Floats
    used: NDArray[np.bool_]
    verdict: NDArray[np.str_]
    reason: NDArray[np.str_]

    @classmethod
    def of_rows(cls, rows: Sequence[dict[str, Any]]) -> SceneEdges:
        """From one mapping an edge; what it does not say is NaN, False or empty."""
        columns: dict[str, Any] = {}
        for one in fields(cls):
            missing: Any = {"used": False, "verdict": "rejected", "reason": ""}.get(
                one.name, np.nan
            )
            kind = type(missing)
            columns[one.name] = np.array([row.get(one.name, missing) for row in rows], kind)
        return cls(**columns)

    @property
    def size(self) -> int:
        """Number of edges."""
        return int(self.row.size)

    def with_objects(self, softness_px: Floats, ideal: Floats) -> SceneEdges:
        """The same edges, with what the objects of the used ones are, (m,) each."""
        soft, chance = np.full(self.size, np.nan), np.full(self.size, np.nan)
        soft[self.used], chance[self.used] = softness_px, ideal
        return replace(self, softness_px=soft, ideal=chance)

    @property
    def only_used(self) -> SceneEdges:
        """Those that are part of the answer, (m,) each."""
        return replace(self, **{name: column[self.used] for name, column in self.columns().items()})

    def summary(self) -> str:
        """How many were found and used."""
        return f"{self.size} found, {int(self.used.sum())} used"

    def columns(self) -> dict[str, NDArray[Any]]:
        """All arrays by name."""
        return {one.name: getattr(self, one.name) for one in fields(self)}
