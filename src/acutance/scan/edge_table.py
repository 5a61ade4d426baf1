"""Tables of edges, one array a column: as CSV, GeoJSON and Parquet."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Callable
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import OptionError
from acutance.scan.parquet import write_parquet

__all__ = ["EdgeTable", "ToLonLat"]

ToLonLat = Callable[[Floats, Floats], tuple[Floats, Floats]]
"""Function of (row, col): their longitudes and latitudes in degrees."""

_DIGITS = 6
_PLACES, _PLACE_DECIMALS = ("row", "col"), 4
"""Of pixels: known to .004 px, also where a scene has 40,000 of them."""
_DEGREES = ("lon_deg", "lat_deg")
_DECIMALS = 8
"""Of degrees: a millimetre."""


class EdgeTable:
    """Edges with one array a column, among them row, col, normal_deg and length_px."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """All arrays by name."""
        raise NotImplementedError

    def __len__(self) -> int:
        """Rows of the table."""
        return int(self.columns()["row"].size)

    def placed_columns(self, lonlat: ToLonLat | None = None) -> dict[str, NDArray[Any]]:
        """All arrays by name, with longitude and latitude in degrees where they are known."""
        _require_function(lonlat)
        columns = self.columns()
        if lonlat is None:
            return columns
        lon_deg, lat_deg = lonlat(columns["row"], columns["col"])
        return columns | {"lon_deg": np.asarray(lon_deg), "lat_deg": np.asarray(lat_deg)}

    def to_csv(self, lonlat: ToLonLat | None = None) -> str:
        """The text of a table with one line an edge; NaN are empty.

        Parameters
        ----------
        lonlat : function of (row, col) arrays, optional
            Gives longitudes and latitudes, two more columns.

        Raises
        ------
        OptionError
            If that is no function, such as the path of a file: the text is returned.
        """
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        columns = self.placed_columns(lonlat)
        writer.writerow(columns)
        cells = (map(_degrees, column) if name in _DEGREES else map(_cell, _values(name, column))
                 for name, column in columns.items())  # fmt: skip
        writer.writerows(zip(*cells, strict=True))
        return text.getvalue()

    def to_pandas(self, lonlat: ToLonLat | None = None) -> Any:
        """The table as a `pandas.DataFrame` with one row an edge.

        Parameters
        ----------
        lonlat : function of (row, col) arrays, optional
            Gives longitudes and latitudes, two more columns.

        Raises
        ------
        OptionError
            If pandas is not installed.
        """
        try:
            import pandas
        except ImportError as error:
            raise OptionError(
                "to_pandas needs pandas, which is not installed: pip install 'acutance[pandas]', "
                "or take the arrays of columns()"
            ) from error
        return pandas.DataFrame(self.placed_columns(lonlat))

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
            Gives longitudes and latitudes. Without it coordinates are columns and rows of pixels,
            and "crs" is "pixel".
        """
        _require_function(lonlat)
        columns = self.columns()
        angle = np.radians(columns["normal_deg"])
        half = 0.5 * columns["length_px"]
        away_row, away_col = half * np.cos(angle), -half * np.sin(angle)
        ends = []
        for sign in (-1.0, 1.0):
            row, col = columns["row"] + sign * away_row, columns["col"] + sign * away_col
            x, y = (col, row) if lonlat is None else lonlat(row, col)
            ends.append(np.stack([x, y], axis=1))
        lines = np.round(np.stack(ends, axis=1), _DECIMALS).tolist()
        values = {name: _values(name, column) for name, column in columns.items()}
        features = [
            {
                "type": "Feature",
                "geometry": {"type": "LineString", "coordinates": line},
                "properties": {name: column[i] for name, column in values.items()},
            }
            for i, line in enumerate(lines)
        ]
        crs = {"crs": "pixel"} if lonlat is None else {}
        return {"type": "FeatureCollection", **crs, "features": features}


def _require_function(lonlat: Any) -> None:
    """Refuse what is no function of places, most of all the name of a file.

    Raises
    ------
    OptionError
        If it is none.
    """
    if lonlat is None or callable(lonlat):
        return
    raise OptionError(
        f"lonlat is {lonlat!r:.80}: give a function of (row, col), such as "
        "image.geolocation.to_lonlat. Texts are returned, and written by "
        'pathlib.Path("edges.csv").write_text(edges.to_csv())'
    )


def _values(name: str, column: NDArray[Any]) -> list[Any]:
    """A column as it is written: places to a ten thousandth of a pixel, see `_value`."""
    if name in _PLACES:
        return [round(float(one), _PLACE_DECIMALS) for one in column]
    return list(map(_value, column))


def _value(one: Any) -> Any:
    """A number of six digits, or None; a truth value; a text."""
    if isinstance(one, np.bool_):
        return bool(one)
    if isinstance(one, np.floating):
        return float(f"{one:.{_DIGITS}g}") if np.isfinite(one) else None
    return str(one)


def _degrees(one: Any) -> str:
    return f"{one:.{_DECIMALS}f}" if np.isfinite(one) else ""


def _cell(value: Any) -> str:
    if isinstance(value, bool):
        return "1" if value else "0"
    return "" if value is None else str(value)
