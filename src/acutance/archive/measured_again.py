"""The note of a mean over measurements of which some were made again by another run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.archive.columns import Columns
from acutance.archive.counted import counted

__all__ = ["measured_again_notes"]

_SAME: Final = ("image_id", "band", "site", "target", "kind", "method", "orientation")
_NO_RUN: Final = -1


def measured_again_notes(rows: Columns, mask: NDArray[np.bool_]) -> Iterator[str]:
    """The note, if targets with names stand in a mean by several runs, in the same image and band.

    They have the same pixels, and their noise does not average out.

    Parameters
    ----------
    rows : Columns
        Of `acutance.Archive.measurements`.
    mask : (n,) bool array
        Which of the rows are meant.
    """
    if "run" not in rows.columns:
        return
    runs: dict[tuple[object, ...], set[int]] = {}
    parts = [rows[name][mask].tolist() for name in _SAME]
    written = np.nan_to_num(rows["run"][mask], nan=_NO_RUN).astype(int).tolist()
    for *same, run in zip(*parts, written, strict=True):
        runs.setdefault(tuple(same), set()).add(run)
    target = _SAME.index("target")
    again = [own for same, own in runs.items() if len(own) > 1 and same[target] is not None]
    if again:
        numbers = sorted(set().union(*again) - {_NO_RUN})
        were, count = ("was", "counts") if len(again) == 1 else ("were", "count")
        yield (
            f"{counted(len(again), 'target')} of single images {were} measured more than once, "
            "with other options or another reading of the pixels (runs "
            f"{', '.join(map(str, numbers))}), and {count} each time, though the noise is the "
            "same: select one run (--run)."
        )
