"""Bands that are not named, told apart by their GSD."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from acutance.archive.trends.measured_series import by_gsd, gsd_words, pixel_side_m

if TYPE_CHECKING:
    from acutance.archive.measurements import Measurements

__all__ = ["with_gsd_bands"]


def with_gsd_bands(rows: Measurements) -> Measurements:
    """Measurements whose unnamed bands are called by their GSD, where there are several.

    Parameters
    ----------
    rows : Measurements
        Of one sensor.
    """
    band = rows["band"].copy()
    classes = by_gsd(rows, np.array([one is None for one in band.tolist()], bool))
    if len(classes) < 2:
        return rows
    for mask in classes:
        band[mask] = gsd_words(pixel_side_m(rows, mask))
    return replace(rows, columns={**rows.columns, "band": band})
