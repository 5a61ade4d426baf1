"""A drawing with its title and caption."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

__all__ = ["Panel", "on_axes", "required"]

Details = TypeVar("Details")


@dataclass(frozen=True)
class Panel:
    """A drawing of a measurement.

    Parameters
    ----------
    title, caption : str
        What stands over and under it on a page.
    draw : function of a figure or a part of one
    wide : bool, optional
        Whether it takes a whole row.
    height_in : float, optional
        Height of its row in inches.
    is_target : bool, optional
        Whether it is the picture of the target itself.
    """

    title: str
    caption: str
    draw: Callable[[FigureBase], None]
    wide: bool = False
    height_in: float = 4.3
    is_target: bool = False

    @property
    def name(self) -> str:
        """The title as part of a file's name: modulation-transfer-function."""
        return re.sub(r"\W+", "-", self.title.lower()).strip("-")


def on_axes(draw: Callable[..., None], measurement: Any) -> Callable[[FigureBase], None]:
    """What draws a measurement on the only axes of a part of a figure."""
    return lambda page: draw(page.subplots(), measurement)


def required(details: Details | None) -> Details:
    """The details a panel draws: a measurement without them has no such panel."""
    assert details is not None
    return details
