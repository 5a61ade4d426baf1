"""What of a standard deviation does not average out over images of one sensor.

The uncertainty budget of a record names the causes of its deviations. Those that come from the
pixels of an image differ with the next image. A prior, a stated border of the target or the MTF of
a reference stay the same: a mean of a hundred images has them in full.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from acutance.curves import MAIN_NUMBERS
from acutance.targets.uncertainty_budget import SYSTEMATIC_TERMS

__all__ = ["systematic_stds"]


def systematic_stds(document: Mapping[str, Any], orientation: str) -> dict[str, float | None]:
    """Standard deviations of `MAIN_NUMBERS` that do not average out, by column.

    Parameters
    ----------
    document : mapping
        Of a record.
    orientation : str

    Returns
    -------
    dict of float or None
        ``None`` where the document has no budget.
    """
    rows = [row for row in document.get("budget", ()) if row["direction"] == orientation]
    shared = [row["std"] for row in rows if row["term"] in SYSTEMATIC_TERMS]
    return {
        f"{name}_systematic_std": _root_sum(std.get(name) for std in shared) if rows else None
        for name in MAIN_NUMBERS
    }


def _root_sum(stds: Any) -> float:
    return math.hypot(*(std for std in stds if std is not None))
