"""Tables as Parquet files. Only here: pyarrow, loaded when such a file is written."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from acutance.errors import OptionError

__all__ = ["require_parquet", "write_parquet"]


def require_parquet() -> None:
    """Make sure that Parquet files can be written.

    Raises
    ------
    OptionError
        If pyarrow is not installed.
    """
    try:
        import pyarrow  # noqa: F401
    except ImportError as error:
        raise OptionError(
            "Parquet files need pyarrow, which is not installed: pip install 'acutance[parquet]', "
            "or choose .csv"
        ) from error


def write_parquet(
    file: str | os.PathLike[str] | BinaryIO, columns: Mapping[str, NDArray[Any]]
) -> None:
    """Write columns of equal length; NaN become missing values.

    Parameters
    ----------
    file : path or binary file
    columns : mapping of str to (n,) array

    Raises
    ------
    OptionError
        If pyarrow is not installed.
    """
    require_parquet()
    import pyarrow
    from pyarrow import parquet

    table = pyarrow.table({
        name: pyarrow.array(
            values.tolist() if values.dtype.kind == "U" else values,
            mask=np.isnan(values) if values.dtype.kind == "f" else None,
        )
        for name, values in columns.items()
    })  # fmt: skip
    parquet.write_table(table, file)
