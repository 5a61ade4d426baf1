"""All windows of an image, each a task of its own: in this process or in several."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from acutance.execution import results_in_turn
from acutance.raster import Image
from acutance.raster.disk_copy import disk_copy
from acutance.scan.window_edges import WindowEdges
from acutance.scan.windows import Window

__all__ = ["Progress", "scan_windows"]

Progress = Callable[[int, int], None]
"""Function of (windows done, windows in all)."""


def scan_windows(
    image: Image,
    parts: Sequence[Window],
    scan: Callable[[Image, Window], WindowEdges],
    *,
    workers: int,
    progress: Progress | None = None,
) -> list[WindowEdges]:
    """The edges of all windows, in their order.

    Parameters
    ----------
    image : Image
    parts : sequence of Window
    scan : function of (image, window)
        At the top of a module, or a ``functools.partial`` of one.
    workers : int
        Processes.
    progress : function of (windows done, windows in all), optional
    """
    found: list[WindowEdges] = []
    with ExitStack() as stack:
        used = min(workers, len(parts))
        if used > 1:
            folder = stack.enter_context(TemporaryDirectory(prefix="acutance-"))
            image = disk_copy(image, Path(folder))
        for window in results_in_turn(partial(scan, image), parts, workers=used, chunk=1):
            found.append(window)
            if progress is not None:
                progress(len(found), len(parts))
    return found
