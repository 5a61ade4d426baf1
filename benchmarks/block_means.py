"""Real ground at two resolutions: scans of scenes against scans of their means over k x k pixels.

A mean over pixels is a sensor too: its MTF at f cycles per coarse pixel is that of the scene at
f / k, times the mean's own. No image of real ground has a known truth; this ratio of two is exact.
Borders are the same ones, but other edges are found and pass, half as many pixels of the blur are
seen, and objects of .4 px are ones of .2 px: what a scan takes for the sensor's must not depend on
that. (A softness that all objects have in common is blur of both, and not tested.) Scans that are
refused or doubtful at one of the resolutions are left out.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from real_scenes import Band, bands_of
from trials import TWO_SIDED_95, command, publish, table, work_through

import acutance as ac
from acutance.curves import Estimate, Response
from acutance.raster import Box
from acutance.targets.region import read_data

FREQ_CPP = (0.25, 0.5)
BLOCKS = (2, 3)


@dataclass(frozen=True)
class Compared:
    """One number of a coarse scan, beside what the fine one predicts."""

    band: str
    block: int
    direction: str
    freq_cpp: float
    predicted: Estimate
    found: Estimate

    @property
    def deviations(self) -> float:
        """How many standard deviations they are apart, as if their errors were independent."""
        std = math.hypot(self.predicted.std, self.found.std)
        return (self.found.value - self.predicted.value) / std


def means(pixels: np.ndarray, block: int) -> np.ndarray:
    """Means over `block` x `block` pixels, NaN where one of them is."""
    rows, cols = (size // block for size in pixels.shape)
    whole = pixels[: rows * block, : cols * block].reshape(rows, block, cols, block)
    return np.asarray(whole.mean(axis=(1, 3)))


def transfer_of_mean(freq_cpp: float, block: int) -> float:
    """Of a mean over `block` pixels in a row, at cycles per pixel."""
    return math.sin(math.pi * freq_cpp * block) / (block * math.sin(math.pi * freq_cpp))


def predicted(fine: Response, freq_cpp: float, block: int) -> Estimate:
    """The MTF of the means at cycles per coarse pixel."""
    own, gain = fine.mtf(freq_cpp / block), transfer_of_mean(freq_cpp / block, block)
    return Estimate(gain * own.value, gain * own.std)


def trusted_scan(pixels: np.ndarray) -> ac.SceneMeasurement | None:
    """A scan that may be trusted."""
    try:
        scene = ac.scan_scene(pixels)
    except ac.AcutanceError:
        return None
    return None if scene.verdict.warns else scene


def compared(band: Band) -> list[Compared]:
    """All numbers of one band."""
    image = ac.open_image(band.path, band=band.number)
    pixels, _ = read_data(image, Box.whole(image.shape))
    fine = trusted_scan(pixels)
    found = []
    for block in BLOCKS if fine is not None else ():
        coarse = trusted_scan(means(pixels, block))
        if coarse is None:
            continue
        for name in ("across", "along"):
            for freq_cpp in FREQ_CPP:
                known = predicted(getattr(fine, name), freq_cpp, block)
                seen = getattr(coarse, name).mtf(freq_cpp)
                found.append(Compared(band.name, block, name, freq_cpp, known, seen))
    return found


def main() -> None:
    parser = command(__doc__.partition("\n")[0], draws=1)
    parser.add_argument("folder", type=Path, help="of the images")
    arguments = parser.parse_args()
    bands = bands_of(arguments.folder)
    every = [
        one for some in work_through(compared, bands, arguments.processes, "bands") for one in some
    ]
    rows = [
        [
            one.band, f"{one.block}", one.direction, f"{one.freq_cpp:g}", f"{one.predicted}",
            f"{one.found}", f"{one.deviations:+.1f}",
        ]
        for one in every
    ]  # fmt: skip
    away = np.abs([one.deviations for one in every])
    pooled = (
        f"{away.size} numbers of {len({(one.band, one.block) for one in every})} pairs of scans: "
        f"{np.mean(away < TWO_SIDED_95):.0%} within two deviations, {np.mean(away < 1):.0%} within "
        f"one; root mean square {math.sqrt(np.mean(away**2)):.2f} deviations, mean ratio of found "
        f"to predicted {np.mean([one.found.value / one.predicted.value for one in every]):.3f}."
    )
    head = ["file, band", "k", "direction", "c/px", "predicted", "found", "deviations"]
    how = argparse.Namespace(processes=arguments.processes, out=arguments.out)
    text = __doc__.partition("\n\n")[2].strip()
    publish("Real ground at two resolutions", [text, pooled, table(head, rows, texts=3)], how)


if __name__ == "__main__":
    main()
