"""The edges of a scene, one array a column."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.scan.parquet import write_parquet

__all__ = ["SceneEdges", "ToLonLat"]

ToLonLat = Callable[[Floats, Floats], tuple[Floats, Floats]]
"""Function of (row, col): their longitudes and latitudes in degrees."""

_DIGITS = 6
_DEGREES = ("lon_deg", "lat_deg")
_DECIMALS = 8
"""Of degrees: a millimetre."""


@dataclass(frozen=True, eq=False)
class SceneEdges(ShortRepr):
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
        Probability that the object is ideal, with no softness at all.
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

    def summary(self) -> str:
        """How many were found and used."""
        return f"{self.size} found, {int(self.used.sum())} used"

    def columns(self) -> dict[str, NDArray[Any]]:
        """All arrays by name."""
        return {one.name: getattr(self, one.name) for one in fields(self)}

    def placed_columns(self, lonlat: ToLonLat | None = None) -> dict[str, NDArray[Any]]:
        """All arrays by name, with longitude and latitude in degrees where they are known."""
        columns = self.columns()
        if lonlat is None:
            return columns
        lon_deg, lat_deg = lonlat(self.row, self.col)
        return columns | {"lon_deg": np.asarray(lon_deg), "lat_deg": np.asarray(lat_deg)}

    def to_csv(self, lonlat: ToLonLat | None = None) -> str:
        """A table with one line an edge; NaN are empty.

        Parameters
        ----------
        lonlat : function of (row, col) arrays, optional
            Gives longitudes and latitudes, two more columns.
        """
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        columns = self.placed_columns(lonlat)
        writer.writerow(columns)
        cells = (map(_degrees if name in _DEGREES else _cell, column)
                 for name, column in columns.items())  # fmt: skip
        writer.writerows(zip(*cells, strict=True))
        return text.getvalue()

    def to_parquet(
        self, file: str | os.PathLike[str] | BinaryIO, lonlat: ToLonLat | None = None
    ) -> None:
        """Write a Parquet file with one row an edge; NaN are missing values.

        Parameters
        ----------
        file : path or binary file
        lonlat : function of (row, col) arrays, optional
            Gives longitudes and latitudes, two more columns.

        Raises
        ------
        OptionError
            If pyarrow is not installed.
        """
        write_parquet(file, self.placed_columns(lonlat))

    def to_geojson(self, lonlat: ToLonLat | None = None) -> dict[str, Any]:
        """Edges as line strings with all columns as properties.

        Parameters
        ----------
        lonlat : function of (row, col) arrays, optional
            Gives longitudes and latitudes. Without it coordinates are columns and rows of pixels.
        """
        angle = np.radians(self.normal_deg)
        half = 0.5 * self.length_px
        away_row, away_col = half * np.cos(angle), -half * np.sin(angle)
        ends = []
        for sign in (-1.0, 1.0):
            row, col = self.row + sign * away_row, self.col + sign * away_col
            x, y = (col, row) if lonlat is None else lonlat(row, col)
            ends.append(np.stack([x, y], axis=1))
        lines = np.round(np.stack(ends, axis=1), _DECIMALS).tolist()
        columns = self.columns()
        features = [
            {
                "type": "Feature",
                "geometry": {"type": "LineString", "coordinates": line},
                "properties": {name: _value(column[i]) for name, column in columns.items()},
            }
            for i, line in enumerate(lines)
        ]
        return {"type": "FeatureCollection", "features": features}


def _value(one: Any) -> Any:
    """A number of six digits, or None; a truth value; a text."""
    if isinstance(one, np.bool_):
        return bool(one)
    if isinstance(one, np.floating):
        return float(f"{one:.{_DIGITS}g}") if np.isfinite(one) else None
    return str(one)


def _degrees(one: Any) -> str:
    return f"{one:.{_DECIMALS}f}" if np.isfinite(one) else ""


def _cell(one: Any) -> str:
    value = _value(one)
    if isinstance(value, bool):
        return "1" if value else "0"
    return "" if value is None else str(value)
