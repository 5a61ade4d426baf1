"""Scenes against their truth: the sensor under ideal, partly soft, mostly soft, only soft objects.

Landscapes of fields (`acutance.simulate.landscape`) without anything beside them, SNR 100 of the
middle contrast; a share of the borders is soft, Gaussians of .15 to 2 px, or all of 0 to .4 px,
or all that face along within 22.5 degrees, the others being ideal. Four sensors, then one drawn
at random from each of the families of `acutance.optics`.
`acutance.scan_scene` measures across and along; the median of the used edges nearest to either
direction stands beside. Where the blur grows over the field, every pixel is a mean of two
landscapes under sensors a little sharper and a little softer than the one at its place; the sensor
in two corners is asked for.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from trials import TWO_SIDED_95, command, publish, table, work_through

import acutance as ac
from acutance.simulate import LandscapeOptions, LandscapeTruth

SYSTEMS = ("gaussian", "diffraction", "halo", "smeared")
DRAWN = tuple(f"drawn {family}" for family in ac.optics.FAMILIES)
CORNER_PX = 0.3
"""Blur that is added in the corners: that of a sensor of .4 px grows by a fourth."""
LEVELS = 7
CLEAN = {
    "roofs": 0.0, "roads": 0.0, "discs": 0.0, "rims": 0.0, "gutters": 0.0, "shadows": 0.0,
    "side_roads": 0.0, "neighbours": 0.0, "texture": (0.0, 0.0), "slope_per_px": 0.0,
    "curved": 0.0, "density_per_mpx": 60,
}  # fmt: skip
MIN_LENGTH_PX, MIN_SNR, WRONG = 20.0, 20.0, 4.0


@dataclass(frozen=True)
class Case:
    """A share of soft objects, whether the blur grows to the corners, how soft they are, where.

    And under which sensors.
    """

    soft: float
    has_soft_corners: bool
    softness_px: tuple[float, float] = (0.15, 2.0)
    soft_normal_deg: tuple[float, float] = (0.0, 180.0)
    sensors: tuple[str, ...] = SYSTEMS

    @property
    def name(self) -> str:
        if self.soft == 1:
            which = "all" if self.soft_normal_deg == (0.0, 180.0) else "along"
            return "{} soft by {:g} to {:g} px".format(which, *self.softness_px)
        return f"{100 * self.soft:.0f} % soft" + (", corners" if self.has_soft_corners else "")


CASES = (
    Case(0.0, False), Case(0.4, False), Case(0.75, False), Case(1.0, False, (0.0, 0.4)),
    Case(1.0, False, (0.0, 0.4), (67.5, 112.5)),
    Case(0.0, True), Case(0.4, True), Case(0.0, False, sensors=DRAWN),
    Case(0.4, False, sensors=DRAWN),
)  # fmt: skip


@dataclass(frozen=True)
class Scanned:
    """One scene: errors at Nyquist and .25 c/px across and along, deviations, edges, verdict.

    Of edges that stand out the share that is found; of used edges with ideal objects, the share
    that errs by more than four deviations.
    """

    error: tuple[float, ...]
    std: tuple[float, ...]
    median_error: float
    found_share: float
    wrong_share: float
    found: int
    used: int
    chance_constant: float
    verdict: str
    seconds: float


def sensor_of(name: str, seed: tuple[int, ...]) -> ac.Sensor:
    """The reference system of a name, or a sensor drawn from the family it names."""
    if name not in DRAWN:
        return ac.simulate.reference_systems()[name]
    rng = np.random.default_rng((*seed, 2))
    return ac.optics.draw_sensor(name.removeprefix("drawn "), rng)


def true_mtf(sensor: ac.Sensor, freq_cpp: float, normal_deg: float) -> float:
    """MTF of a sensor at one place of the plane."""
    turn = np.radians(normal_deg)
    u, v = np.array([freq_cpp * np.cos(turn)]), np.array([freq_cpp * np.sin(turn)])
    return float(np.abs(sensor.otf(u, v))[0])


def softened(sensor: ac.Sensor, variance_px2: float) -> ac.Sensor:
    """The sensor behind a further Gaussian."""
    if variance_px2 <= 0:
        return sensor
    return ac.Sensor([*sensor.blocks, ac.optics.Gaussian(float(np.sqrt(variance_px2)))])


def draw(
    case: Case, sensor: ac.Sensor, size_px: int, seed: tuple[int, ...]
) -> tuple[np.ndarray, LandscapeTruth]:
    """A scene, its noise added, and its truth in the middle of the field."""
    options = LandscapeOptions(
        soft=case.soft, softness_px=case.softness_px, soft_normal_deg=case.soft_normal_deg, **CLEAN
    )
    shape, noise = (size_px, size_px), np.random.default_rng((*seed, 1))

    def landscape(variance_px2: float) -> tuple[np.ndarray, LandscapeTruth]:
        return ac.simulate.landscape(
            softened(sensor, variance_px2), shape=shape, options=options,
            rng=np.random.default_rng(seed),
        )  # fmt: skip

    image, truth = landscape(0.0)
    if case.has_soft_corners:
        away = (np.arange(size_px) - 0.5 * (size_px - 1)) / (0.5 * (size_px - 1))
        level = 0.5 * (LEVELS - 1) * (away[:, None] ** 2 + away**2)
        image = np.maximum(1 - level, 0.0) * image
        for k in range(1, LEVELS):
            softer, _ = landscape(CORNER_PX**2 * k / (LEVELS - 1))
            image += np.clip(1 - np.abs(level - k), 0.0, 1.0) * softer
    return image + noise.normal(0, options.typical_contrast / 100, shape), truth


def scan(job: tuple[Case, str, int, tuple[int, ...]]) -> Scanned | None:
    """Draw a scene and scan it; nothing if it is refused."""
    case, name, size_px, seed = job
    sensor = sensor_of(name, seed)
    image, truth = draw(case, sensor, size_px, seed)
    start = time.process_time()
    try:
        scene = ac.scan_scene(image)
    except ac.AcutanceError:
        return None
    seconds = time.process_time() - start
    asked = [(scene, sensor)]
    if case.has_soft_corners:
        softest = softened(sensor, CORNER_PX**2)
        asked = [(scene.at(place, place), softest) for place in (0, size_px - 1)]
    error, std = [], []
    for place, own in asked:
        for direction, normal_deg in ((place.across, 0.0), (place.along, 90.0)):
            for freq_cpp in (0.5, 0.25):
                number = direction.mtf(freq_cpp)
                error.append(number.value - true_mtf(own, freq_cpp, normal_deg))
                std.append(number.std)
    edges, used = scene.edges, scene.edges.used
    off = edges.mtf_nyquist[used] - [
        true_mtf(sensor, 0.5, normal) for normal in edges.normal_deg[used]
    ]
    ideal = edges.ideal[used] > 0.5
    return Scanned(
        tuple(error), tuple(std), float(np.median(off)), found_share(truth, edges),
        float(np.mean(np.abs(off[ideal]) > WRONG * edges.mtf_nyquist_std[used][ideal])),
        edges.size, int(used.sum()), scene.field.chance_constant, scene.verdict.word, seconds,
    )  # fmt: skip


def found_share(truth: LandscapeTruth, edges: ac.SceneEdges) -> float:
    """Of the edges that are long enough and stand out, how many were found."""
    found = []
    for edge in truth.edges:
        if edge.length_px >= MIN_LENGTH_PX and edge.snr >= MIN_SNR:
            away = edge.line.normal_distance(edges.row, edges.col)
            along = edge.line.tangent_distance(edges.row, edges.col)
            near = (np.abs(away) < 1.5) & (np.abs(along) < 0.5 * edge.length_px)
            found.append(bool(near.any()))
    return float(np.mean(found)) if found else np.nan


def row(name: str, scanned: list[Scanned]) -> list[str]:
    """RMS, bias and coverage over scenes, directions and both frequencies."""
    error = np.concatenate([one.error for one in scanned]).reshape(-1, 2)
    std = np.concatenate([one.std for one in scanned]).reshape(-1, 2)
    holds = np.abs(error) < TWO_SIDED_95 * std
    good = sum(one.verdict in ("good", "usable") for one in scanned)

    def mean(field: str) -> float:
        return float(np.mean([getattr(one, field) for one in scanned]))

    numbers = [
        cell
        for k in range(2)
        for cell in (
            f"{np.sqrt(np.mean(error[:, k] ** 2)):.4f}",
            f"{np.mean(error[:, k]):+.4f}",
            f"{100 * np.mean(holds[:, k]):.0f}",
        )
    ]
    return [
        name,
        *numbers,
        f"{np.mean(std[:, 0]):.4f}",
        f"{mean('median_error'):+.4f}",
        f"{mean('used'):.0f} of {mean('found'):.0f}",
        f"{100 * mean('found_share'):.1f}",
        f"{100 * mean('wrong_share'):.1f}",
        f"{mean('chance_constant'):.2f}",
        f"{good} of {len(scanned)}",
        f"{mean('seconds'):.1f}",
    ]


def main() -> None:
    parser = command(__doc__.partition("\n")[0], draws=3)
    parser.add_argument("--size", type=int, default=1900, help="rows and columns of a scene")
    arguments = parser.parse_args()
    jobs = [
        (case, name, arguments.size, (arguments.seed, draw_number, number))
        for case in CASES
        for number, name in enumerate(case.sensors)
        for draw_number in range(arguments.draws)
    ]
    found = work_through(scan, jobs, arguments.processes, "scenes")
    rows = []
    for case in CASES:
        own = [
            (one, job)
            for one, job in zip(found, jobs, strict=True)
            if one is not None and job[0] == case
        ]
        for name in case.sensors:
            some = [one for one, job in own if job[1] == name]
            if some:
                rows.append(row(f"{case.name}, {name}", some))
        if own:
            every = "all drawn" if case.sensors is DRAWN else "all"
            rows.append(row(f"**{case.name}, {every}**", [one for one, _ in own]))
    head = [
        "objects, sensor", "RMS at Nyquist", "bias", "held / %", "RMS at .25", "bias", "held / %",
        "std at Nyquist", "median of the edges, bias", "edges used", "found / %", "wrong / %",
        "chance of a constant field", "good or usable", "time / s",
    ]  # fmt: skip
    refused = sum(one is None for one in found)
    parts = [
        f"Scenes of {arguments.size} x {arguments.size} px, {arguments.draws} a row, SNR 100; "
        "errors of the MTF across and along, and how often 95 % intervals hold the truth. Soft "
        'borders: Gaussians of .15 to 2 px where not said otherwise. "Along": those of normals '
        'within 22.5 degrees of along, all others being ideal. "Corners": the blur grows to '
        "the corners by a Gaussian of .3 px; errors are those in two corners, the median of the "
        f"edges is compared with the middle. Found: of true edges of {MIN_LENGTH_PX:.0f} px and "
        f"SNR {MIN_SNR:.0f} and more. Wrong: of used edges with ideal objects, those that err by "
        f"more than {WRONG:.0f} deviations from the sensor in the middle. Processor time of one "
        f"scan. {refused} scenes were refused.",
        table(head, rows),
    ]
    publish("Whole scenes", parts, arguments)


if __name__ == "__main__":
    main()
