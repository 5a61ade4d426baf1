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
STEP_CPP = 1 / 64
_NOTHING_FOUND = 4
"""Its exit code where it finds no square."""
_COL, _ROW, _ANGLE, _CURVE = 1, 2, 3, 13
"""Columns of its table of edges (output version 2); the curve fills the rest."""


@dataclass(frozen=True)
class MapperEdges:
    """What it found.

    Attributes
    ----------
    processor_s : float
        Its processor time, the reading of the file included.
    row, col : (n,) array
        Middle of every edge.
    angle_deg : (n,) array
        Angle between each edge and the nearer axis.
    curve : (n, m) array
        MTF at multiples of `STEP_CPP`.
    """

    processor_s: float
    row: np.ndarray
    col: np.ndarray
    angle_deg: np.ndarray
    curve: np.ndarray

    def mtf(self, freq_cpp: float) -> np.ndarray:
        """MTF of every edge at a multiple of `STEP_CPP`, (n,)."""
        return np.asarray(self.curve[:, round(freq_cpp / STEP_CPP)])


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
        command = [program, str(path), folder, "--edges", "--output-version", "2"]
        command += ["--invert"] if bright_targets else []
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run(command, capture_output=True)
        spent = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        if done.returncode == _NOTHING_FOUND:
            found = np.empty((0, _CURVE + round(0.5 / STEP_CPP) + 1))
        else:
            done.check_returncode()
            found = np.loadtxt(Path(folder) / "edge_sfr_values.txt", ndmin=2)
    return MapperEdges(
        spent, found[:, _ROW], found[:, _COL], np.abs(found[:, _ANGLE]), found[:, _CURVE:]
    )
