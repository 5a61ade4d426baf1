"""What can go wrong, drawn once.

::

    AcutanceError
    ├── ImageError          (OSError)     a file is missing, unreadable, or holds no image
    ├── RegionError         (ValueError)  a region lies outside the image or is too small
    │   └── NoDataError                   what it holds is nodata, masked, NaN, infinite or fill
    ├── TargetError         (ValueError)  the pixels hold no target that can be measured
    │   ├── NoEdgeError                   no straight edge stands out of the noise
    │   │   └── FewEdgesError             the edges of a scene do not tell its sensor; holds them
    │   ├── NoBarsError                   no groups of bars, or not as described
    │   ├── NoStarError                   no Siemens star, or not with that number of cycles
    │   ├── PhaseError                    the edge is aligned with the grid: no sub-pixel phases
    │   └── SupportError                  too few rows or too narrow plateaus
    ├── OptionError         (ValueError)  an option has a value out of its range
    │   └── NothingSelectedError          the filters of an archive let no measurement pass
    ├── ModelError          (ValueError)  a sensor or a scene is described in contradiction
    ├── ArchiveError        (OSError)     an archive is missing, of another program, not reachable,
    │                                     or cannot be written
    └── WorkerError         (OSError)     a process that worked for this one was killed

Every message names what was asked, what was found and what to do. Every class is also
the builtin that fits, so that code which does not import acutance can catch it.
"""

from __future__ import annotations

from typing import Any

__all__ = [
    "AcutanceError",
    "ArchiveError",
    "FewEdgesError",
    "ImageError",
    "ModelError",
    "NoBarsError",
    "NoDataError",
    "NoEdgeError",
    "NoStarError",
    "NothingSelectedError",
    "OptionError",
    "PhaseError",
    "RegionError",
    "SupportError",
    "TargetError",
    "WorkerError",
]


class AcutanceError(Exception):
    """The root of everything acutance raises on purpose."""


class ImageError(AcutanceError, OSError):
    """A file is missing, unreadable, or holds no image."""


class RegionError(AcutanceError, ValueError):
    """A region lies outside the image, is too small, or far larger than any target."""


class NoDataError(RegionError):
    """A region holds too few pixels with data: others are nodata, masked, not finite or fill."""


class TargetError(AcutanceError, ValueError):
    """The pixels hold no target that can be measured."""


class NoEdgeError(TargetError):
    """No straight edge stands out of the noise."""


class FewEdgesError(NoEdgeError):
    """The edges of a scene are too few to tell its sensor, or all have one direction.

    Parameters
    ----------
    message : str
    edges : SceneEdges or BandEdges
        Every edge that was found, and why it is not used.
    """

    def __init__(self, message: str, edges: Any) -> None:
        super().__init__(message)
        self.edges = edges

    def __reduce__(self) -> tuple[type[FewEdgesError], tuple[str, Any]]:
        return type(self), (str(self), self.edges)


class NoBarsError(TargetError):
    """No groups of bars, or not as they were described."""


class NoStarError(TargetError):
    """No Siemens star, or not with the number of cycles that was stated."""


class PhaseError(TargetError):
    """The edge is aligned with the pixel grid, so it has too few sub-pixel phases."""


class SupportError(TargetError):
    """The edge has too few rows or its plateaus are too narrow."""


class OptionError(AcutanceError, ValueError):
    """An option has a value that means nothing."""


class NothingSelectedError(OptionError):
    """The filters of an archive let no measurement pass."""


class ModelError(AcutanceError, ValueError):
    """A sensor or a scene is described in contradiction with itself."""


class ArchiveError(AcutanceError, OSError):
    """An archive is missing, of another program, not reachable, or cannot be written."""


class WorkerError(AcutanceError, OSError):
    """A process that worked for this one was killed, most likely for want of memory."""
