"""Every real edge of a folder of images, with its numbers and its verdict.

The folder and its files are described in its README; images are no part of this project. Each edge
has a judgement by eye: good, or a trap (rims, a road or a line beside the edge, or a weak and
asymmetric border that is too sharp or too soft for its sensor). Regions are 12 to
20 px wide on either side where the ground allows it. Of scenes without a single good edge (clouds,
decimated or averaged products), the strongest edge of every box of a grid is measured.
"""

from __future__ import annotations

import argparse
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from trials import command, publish, table, work_through

import acutance as ac
from acutance.raster import Region

WARNED = ("doubtful", "invalid")
BOX_PX = 40
MAX_BOXES = 200
OLI_30M, OLI_15M = "20_l8_224077_B4.tif", "10_l8_oli_pan15m_robinson.tif"
S2_10M, S2_20M = "08_s2a_T33UUB_10m_B4B3B2B8.tif", "08_s2a_T33UUB_20m_B5B6B7B8AB11B12.tif"
MEMPHIS, MATO_GROSSO = "11_l8_oli_b7_30m_memphis.tif", "12_l8_oli_b5_30m_matogrosso.tif"
RUNWAY_04, RUNWAY_92 = "13_ucmerced_runway04.tif", "13_ucmerced_runway92.tif"
ROTTERDAM = "07_spacenet6_wv2_pan_rotterdam.tif"
LIMA = "22_s2a_T18LTM_B01_60m.jp2"
TRAPS = (
    "25_trap_gf2_quicklook_decimated.jpg",
    "25_trap_l8_224077_B2_resampled_60m.tif",
    "25_trap_l8_clouds_swath_edge.tif",
    "26_naip_20090818.tif",
    "26_naip_20140720.tif",
    "26_naip_20180716.tif",
)


@dataclass(frozen=True)
class RealEdge:
    """One edge, in pixels: a box (row, col, height, width), or both ends (x, y), a half width."""

    file: str
    place: tuple[float, float, float, float]
    half_width_px: float = 0.0
    """0 of a box."""
    band: int = 1
    good: bool = True

    @property
    def roi(self) -> tuple[int, int, int, int] | Region:
        """The region that is measured."""
        if not self.half_width_px:
            row, col, height, width = (round(number) for number in self.place)
            return row, col, height, width
        ends = np.array(self.place).reshape(2, 2)
        along = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))
        across = self.half_width_px * np.array([-along[1], along[0]])
        corners = [ends[0] + across, ends[1] + across, ends[1] - across, ends[0] - across]
        return Region(tuple((float(y), float(x)) for x, y in corners))


def around(
    file: str, row: int, col: int, half: tuple[int, int] = (14, 14), *, good: bool = True
) -> RealEdge:
    """An edge in the middle of a box."""
    high, wide = half
    place = (row - high, col - wide, 2 * high, 2 * wide)
    return RealEdge(f"scenes/{file}", place, good=good)


EDGES = [
    RealEdge("03_sfrmat5_chart_edge1_mono.tif", (2, 47.1, 340, 79.7), 20),
    RealEdge(ROTTERDAM, (250.7, 114.1, 322.8, 99.5), 12),
    RealEdge(ROTTERDAM, (357.1, 48.7, 406.4, 39.0), 12),
    *(RealEdge(S2_10M, (255, 504.5, 242.6, 463.3), 12, band) for band in (1, 2, 3, 4)),
    RealEdge(S2_10M, (282.8, 451, 271.8, 414.4), 12, 4),
    RealEdge(S2_10M, (475.3, 1.3, 440.6, 15.3), 12, 4),
    RealEdge(S2_10M, (114.4, 190.6, 125.4, 157.7), 6, 4, good=False),
    RealEdge(S2_10M, (145.3, 250.5, 125.7, 245.5), 12, 3),
    RealEdge(S2_20M, (126.5, 249.4, 121.6, 233.3), 10, 4),
    RealEdge(S2_20M, (205.1, 121.8, 219.5, 114.9), 10, 4),
    RealEdge(S2_20M, (100.3, 186.6, 98.7, 175.7), 10, 4),
    RealEdge("09_s2_maricopa_10m.tif", (497.5, 100.2, 493.5, 47.9), 12),
    RealEdge("09_s2_maricopa_10m.tif", (97.1, 188.4, 125.4, 189.6), 12, good=False),
    RealEdge(OLI_15M, (125.4, 435.5, 112.1, 436), 12),
    RealEdge(OLI_15M, (11.3, 102.6, 12, 118.7), 12),
    RealEdge(OLI_15M, (508.8, 55, 507.2, 98), 12),
    RealEdge(MEMPHIS, (82.1, 370, 59, 388.2), 12),
    RealEdge(MEMPHIS, (146.5, 147.9, 158, 155.9), 12),
    RealEdge(MEMPHIS, (916, 570.4, 915.3, 554.7), 12),
    RealEdge(MATO_GROSSO, (168.3, 144.8, 148.4, 122.2), 12, good=False),
    RealEdge(MATO_GROSSO, (164.8, 99.3, 192.1, 121.2), 12),
    RealEdge(MATO_GROSSO, (97.8, 137.7, 79.4, 114), 12, good=False),
    RealEdge(MATO_GROSSO, (37.9, 75.1, 29.2, 69.9), 12, good=False),
    RealEdge(RUNWAY_04, (110.1, 61.7, 247.4, 101.6), 14, 2),
    RealEdge(RUNWAY_04, (102.7, 92.2, 240.8, 132.5), 14, 2),
    RealEdge(RUNWAY_04, (81.4, 160, 219, 199.4), 14, 2),
    RealEdge(RUNWAY_04, (73, 189.9, 210.6, 229.4), 14, 2),
    RealEdge(RUNWAY_04, (105.3, 64.1, 98.5, 87.8), 14, 2),
    RealEdge(RUNWAY_92, (53.8, 91.5, 151.6, 195.4), 14, 2),
    RealEdge(RUNWAY_92, (104.1, 41.6, 203.5, 146.7), 14, 2),
    around(OLI_30M, 194, 1152),
    around(OLI_30M, 385, 1005),
    around(OLI_30M, 903, 1868),
    around(OLI_30M, 872, 1880),
    around(OLI_30M, 189, 1119),
    around(OLI_30M, 829, 1520, (12, 10)),
    around(OLI_30M, 162, 1055),
    around("21_s2_B04.jp2", 240, 67),
    around("21_s2_B04.jp2", 744, 700),
    around("21_s2_B04.jp2", 289, 1118, good=False),
    around("21_s2_B02.jp2", 289, 1117, good=False),
    around("21_s2_B08.jp2", 826, 1104),
    around("21_s2_B08.jp2", 1892, 738, (11, 11)),
    around("21_s2_B08.jp2", 939, 1126),
    around("21_s2_B02.jp2", 59, 591),
    around("21_s2_B02.jp2", 810, 1137),
    around("21_s2_B8A.jp2", 898, 496, (22, 9)),
    around(LIMA, 438, 1121, good=False),
    around(LIMA, 1143, 1749),
    around(LIMA, 587, 1122),
    around("23_wv2_rotterdam_pan1.tif", 136, 268),
    around("23_wv2_rotterdam_pan1.tif", 494, 425),
    around("23_wv2_rotterdam_pan1.tif", 389, 561),
    around("23_wv2_rotterdam_pan2.tif", 495, 109),
    around("23_wv2_rotterdam_pan2.tif", 521, 174),
    around("23_wv2_rotterdam_pan2.tif", 562, 181, (11, 11)),
    around("24_phr1a_aubagne_1.tif", 135, 458),
    around("24_phr1a_aubagne_2.tif", 75, 457),
    around("24_phr1a_aubagne_1.tif", 680, 840),
]


@dataclass(frozen=True)
class Finding:
    """A row of the table: what was found, and the word of the verdict or of the refusal."""

    word: str
    cells: tuple[str, ...]


def measured(job: tuple[Path, RealEdge]) -> Finding:
    """Measure one edge."""
    folder, edge = job
    try:
        image = ac.open_image(folder / edge.file, band=edge.band)
        found = ac.measure_edge(image, roi=edge.roi)
    except ac.AcutanceError as error:
        return Finding("refused", ("", "", "", "", str(error).partition(":")[0]))
    numbers = f"{found.mtf_nyquist}", f"{found.rer}", f"{found.fwhm_px}", f"{found.snr:.0f}"
    return Finding(found.verdict.word, (*numbers, found.verdict.sentence.partition(":")[0]))


def of_trap(path: Path) -> Counter[str]:
    """Verdicts on the strongest edge of every box of a grid, in a random order of boxes."""
    image = ac.open_image(path)
    rows, cols = (range(0, size - BOX_PX + 1, BOX_PX) for size in image.shape)
    boxes = [(row, col, BOX_PX, BOX_PX) for row in rows for col in cols]
    np.random.default_rng(0).shuffle(boxes)
    words: Counter[str] = Counter()
    for row, col, height, width in boxes[:MAX_BOXES]:
        try:
            words[ac.measure_edge(image, roi=(int(row), int(col), height, width)).verdict.word] += 1
        except ac.AcutanceError:
            words["refused"] += 1
    return words


def name_of(edge: RealEdge) -> str:
    """File, band and place of an edge."""
    words = Path(edge.file).stem.split("_")
    place = ", ".join(f"{number:.0f}" for number in edge.place)
    kind = f"ends {place}" if edge.half_width_px else f"box {place}"
    return f"{' '.join(words[:4])}, band {edge.band}, {kind}"


def trusted_share(found: list[tuple[RealEdge, Finding]], *, good: bool) -> str:
    """How many are good or usable."""
    words = [finding.word for edge, finding in found if edge.good is good]
    return f"{sum(word in ('good', 'usable') for word in words)} of {len(words)}"


def main() -> None:
    parser = command(__doc__.partition("\n")[0], draws=1)
    parser.add_argument("folder", type=Path, help="of the images")
    arguments = parser.parse_args()
    jobs = [(arguments.folder, edge) for edge in EDGES]
    results = work_through(measured, jobs, arguments.processes, "edges")
    found = list(zip(EDGES, results, strict=True))
    paths = [arguments.folder / "scenes" / name for name in TRAPS]
    traps = work_through(of_trap, paths, arguments.processes, "traps")
    head = ["edge", "by eye", "verdict", "MTF(0.5)", "RER", "FWHM / px", "SNR", "reason"]
    rows = [
        [name_of(edge), "good" if edge.good else "trap", finding.word, *finding.cells]
        for edge, finding in found
    ]
    words = ("good", "usable", *WARNED, "refused")
    boxes = [
        [name, *(f"{count[word]}" for word in words)]
        for name, count in zip(TRAPS, traps, strict=True)
    ]
    parts = [
        f"Good or usable: {trusted_share(found, good=True)} edges that are good by eye, "
        f"{trusted_share(found, good=False)} traps.",
        table(head, rows, texts=3),
        "## Scenes without a good edge",
        f"Strongest edge in each of up to {MAX_BOXES} boxes of {BOX_PX} px.",
        table(["scene", *words], boxes),
    ]
    how = argparse.Namespace(processes=arguments.processes, out=arguments.out)
    publish("Verdicts on real edges", parts, how)


if __name__ == "__main__":
    main()
