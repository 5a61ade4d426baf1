"""MTF Mapper (Frans van den Bergh's program) on the images of a benchmark, where it is installed.

It is searched on the path as ``mtf_mapper``. It finds the squares itself, and
hands out the MTF of every side without a standard deviation.
"""

from __future__ import annotations

import resource
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from acutance.raster import write_geotiff

PROGRAM = "mtf_mapper"
_NYQUIST = 32
"""Place of 0.5 c/px in its curves, whose step is 1/64 c/px."""


@dataclass(frozen=True)
class MapperEdges:
    """What it found.

    Attributes
    ----------
    processor_s : float
        Its processor time, the reading of the file included.
    angle_deg : (n,) array
        Acute angle between each edge and the nearer axis.
    nyquist : (n,) array
    """

    processor_s: float
    angle_deg: np.ndarray
    nyquist: np.ndarray


def mtf_mapper_edges(image: np.ndarray, *, bright_targets: bool) -> MapperEdges | None:
    """The sides of the squares of an image; ``None`` where the program is not installed.

    Parameters
    ----------
    image : (rows, cols) uint16 array
    bright_targets : bool
        It looks for dark squares; bright ones need its option ``--invert``.
    """
    program = shutil.which(PROGRAM)
    if program is None:
        return None
    with TemporaryDirectory() as folder:
        path = Path(folder) / "squares.tif"
        write_geotiff(path, image)
        options = ["--sfr", "--invert"] if bright_targets else ["--sfr"]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        subprocess.run([program, str(path), folder, *options], check=True, capture_output=True)
        spent = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        curves = np.loadtxt(Path(folder) / "raw_sfr_values.txt", ndmin=2)
    return MapperEdges(spent, curves[:, 0], curves[:, 1 + _NYQUIST])
