"""Years with decimals on the axis of a drawing."""

from __future__ import annotations

from datetime import date
from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.curves.grid import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["axis_days", "date_axis", "day_on_axis"]

_DAYS_FROM_1970 = "datetime64[D]"


def axis_days(years: Floats | float) -> Any:
    """Years with decimals as days since 1970, the unit of matplotlib's dates; shape kept."""
    years = np.asarray(years, float)
    whole = np.floor(years).astype(int)
    begin, end = ((whole + more - 1970).astype("datetime64[Y]") for more in (0, 1))
    first, last = (day.astype(_DAYS_FROM_1970).astype(float) for day in (begin, end))
    return first + (years - whole) * (last - first)


def day_on_axis(day: date) -> float:
    """A date in the unit of the axis: days since 1970."""
    return float((day - date(1970, 1, 1)).days)


def date_axis(axes: Axes) -> None:
    """Ticks at months or years, as many as have room."""
    from matplotlib.dates import AutoDateLocator, ConciseDateFormatter

    locator = AutoDateLocator(minticks=4, maxticks=9)  # type: ignore[no-untyped-call]
    axes.xaxis.set_major_locator(locator)
    # Beside the axis stands the year, or the month, that no tick has.
    formatter = ConciseDateFormatter(locator)  # type: ignore[no-untyped-call]
    axes.xaxis.set_major_formatter(formatter)
