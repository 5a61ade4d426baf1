"""How often the 95 % intervals of `acutance.combine` hold the truth, and which of its checks fail.

Four edges near 6, 97, 30 and 62 degrees and two pulses of 3 px, 50 by 50 and 50 by 40 px each,
SNR 50 or 100, are combined. Twelve systems, then sensors drawn from every family of
`acutance.optics`: another one in every draw. Then two and six edges, half of them across and half
along, as a checkerboard has them.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np
from trials import METRICS, TWO_SIDED_95, command, publish, rms, table, work_through

import acutance as ac
from acutance import optics
from acutance.curves.grid import Floats
from acutance.optics import FAMILIES, draw_sensor

CONFIGURATION = (
    ("edge", 6.0, "across"),
    ("edge", 7.0, "along"),
    ("edge", 30.0, "across"),
    ("edge", -28.0, "along"),
    ("pulse", -8.0, "across"),
    ("pulse", 5.0, "along"),
)
FAMILY = "family: "
FEW = ("gaussian", "elliptical", "smear 1 px along", "diffraction")
DIRECTIONS_DEG = {"across": 0.0, "along": 90.0, "45 deg": 45.0}


@dataclass(frozen=True)
class RotatedGaussian:
    """A Gaussian blur whose axes are not those of the grid."""

    major_px: float
    minor_px: float
    turn_deg: float

    def otf(self, u: Floats, v: Floats) -> Floats:
        turn = np.radians(self.turn_deg)
        p, q = np.cos(turn) * u + np.sin(turn) * v, np.cos(turn) * v - np.sin(turn) * u
        return np.asarray(
            np.exp(-2 * np.pi**2 * ((self.major_px * p) ** 2 + (self.minor_px * q) ** 2))
        )


def systems() -> dict[str, ac.Sensor]:
    """Systems by name."""
    pixel, known = optics.Detector(), ac.simulate.reference_systems()
    return {
        "gaussian": known["gaussian"],
        "elliptical": ac.Sensor([optics.Gaussian(0.38, 0.5), pixel]),
        "rotated": ac.Sensor([RotatedGaussian(0.5, 0.34, 30.0), pixel]),
        "smear 1 px along": ac.Sensor([optics.Gaussian(0.35), optics.Smear(1.0, "along"), pixel]),
        "generic sensor": ac.Sensor(
            [optics.Gaussian(0.39), pixel, optics.Smear(0.25, "along"), optics.Butterworth(1.4)]
        ),
        "halo": known["halo"],
        "asymmetric": known["asymmetric"],
        "sharpened": known["sharpened"],
        "unsharp mask": ac.Sensor([optics.Gaussian(0.5), pixel, unsharp_mask(0.8, 1.0)]),
        "diffraction": known["diffraction"],
        "defocused": known["defocused"],
        "diffracting, sharpened": ac.Sensor(
            [
                optics.Diffraction(1.2, obscuration=0.3), optics.Gaussian(0.3), pixel,
                optics.Sharpening.both_axes(0.15),
            ]
        ),
    }  # fmt: skip


def unsharp_mask(gain: float, sigma_px: float) -> optics.Sharpening:
    """The image and `gain` times what a Gaussian of 5 x 5 pixels takes out of it."""
    fall = np.exp(-0.5 * (np.arange(-2, 3) / sigma_px) ** 2)
    kernel = -gain * np.outer(fall, fall) / fall.sum() ** 2
    kernel[2, 2] += 1 + gain
    return optics.Sharpening(tuple(map(tuple, kernel.tolist())))


@dataclass(frozen=True)
class Draw:
    """One combination, reproducible from its seeds."""

    system: str
    seeds: tuple[int, ...]


@dataclass(frozen=True)
class Found:
    """Errors over standard deviations by direction and metric, standard deviations, checks."""

    errors: dict[str, float]
    share: float
    form: str
    ratio: float
    agreement: float
    plain: float
    correction: float


def combined(draw: Draw) -> Found | str:
    """Combine one draw; the message of the error if it was refused."""
    rng = np.random.default_rng(draw.seeds)
    family = draw.system.removeprefix(FAMILY)
    is_family = family != draw.system
    sensor = draw_sensor(family, rng) if is_family else systems()[draw.system]
    try:
        result = ac.combine([_measured(sensor, rng, *one) for one in CONFIGURATION])
    except ac.AcutanceError as error:
        return str(error)
    errors, share = {}, 0.0
    for name, angle in DIRECTIONS_DEG.items():
        own, true = result.response_at(angle), sensor.response_along(angle)
        for metric, read in METRICS.items():
            number, wanted = read(own), read(true).value
            errors[f"{metric} {name}"] = (number.value - wanted) / number.std
        share += own.mtf_nyquist.std / true.mtf_nyquist.value / len(DIRECTIONS_DEG)
    total, sensor_found = result.chi_square, result.sensor
    return Found(
        errors, share, sensor_found.forms[0].form.name, total.value / total.expected,
        total.p_value, result.plain_sensor.p_value, sensor_found.correction_share,
    )  # fmt: skip


def _measured(sensor: ac.Sensor, rng: np.random.Generator, kind: str, tilt: float, way: Any) -> Any:
    angle = tilt + rng.uniform(-1.5, 1.5)
    levels: dict[str, Any] = {"dark": 200, "bright": 1200, "snr": rng.choice([50, 100]), "rng": rng}
    if kind == "edge":
        image, _ = ac.simulate.edge(
            sensor, angle_deg=angle, orientation=way, shape=(50, 50), **levels
        )
        return ac.measure_edge(image)
    shape = (50, 40) if way == "across" else (40, 50)
    image, _ = ac.simulate.pulse(
        sensor, angle_deg=angle, orientation=way, width_px=3.0, shape=shape, **levels
    )
    return ac.measure_pulse(image, width_px=3.0)


@dataclass(frozen=True)
class Few:
    """Edges across and along by turns, reproducible from their seeds."""

    system: str
    count: int
    seeds: tuple[int, ...]


def few_edges(draw: Few) -> tuple[list[float], list[float], list[float]]:
    """Errors of MTF at Nyquist of the combination across and along, their deviations, and the
    errors of single edges along their normals."""
    rng = np.random.default_rng(draw.seeds)
    sensor = systems()[draw.system]
    edges, single = [], []
    for number in range(draw.count):
        image, truth = ac.simulate.edge(
            sensor, shape=(80, 80), angle_deg=rng.uniform(4, 12), snr=100,
            orientation=("across", "along")[number % 2], rng=rng,
        )  # fmt: skip
        edges.append(ac.measure_edge(image))
        single.append(edges[-1].mtf_nyquist.value - truth.mtf_nyquist.value)
    found = ac.combine(edges)
    numbers = {0.0: found.across.mtf_nyquist, 90.0: found.along.mtf_nyquist}
    errors = [
        one.value - sensor.response_along(angle).mtf_nyquist.value for angle, one in numbers.items()
    ]
    return errors, [one.std for one in numbers.values()], single


def few_rows(arguments: Any) -> list[list[str]]:
    """Two and six edges of some systems."""
    cases = [(name, count) for name in FEW for count in (2, 6)]
    jobs = [
        Few(*case, (arguments.seed, 100 + number, draw))
        for number, case in enumerate(cases)
        for draw in range(arguments.draws)
    ]
    results = work_through(few_edges, jobs, arguments.processes, "few edges")
    rows = []
    for case in cases:
        own = [
            one for job, one in zip(jobs, results, strict=True) if (job.system, job.count) == case
        ]
        errors, std, single = (np.array(part) for part in zip(*own, strict=True))
        rows.append([
            case[0], f"{case[1]}", f"{rms(single):.4f}", f"{rms(errors):.4f}",
            f"{np.median(std):.4f}", f"{100 * np.mean(np.abs(errors) < TWO_SIDED_95 * std):.0f}",
        ])  # fmt: skip
    return rows


def row(name: str, results: list[Found | str]) -> list[str]:
    """One line of the table."""
    found = [one for one in results if isinstance(one, Found)]
    cells = [name, str(len(found))]
    for metric in METRICS:
        z = np.array([[one.errors[f"{metric} {way}"] for way in DIRECTIONS_DEG] for one in found])
        held = 100 * np.mean(np.abs(z) < 1.96)
        cells.append(f"{held:.1f} ({z.mean():+.2f} ± {z.std():.2f})")
    forms = Counter(one.form.replace("gaussian x detector", "G") for one in found)
    return [
        *cells,
        f"{100 * np.mean([one.share for one in found]):.1f}",
        f"{np.mean([one.ratio for one in found]):.2f}",
        f"{100 * np.mean([one.agreement < 0.01 for one in found]):.0f}",
        f"{100 * np.mean([one.plain < 0.01 for one in found]):.0f}",
        f"{100 * np.mean([one.correction for one in found]):.1f}",
        ", ".join(f"{form} {count}" for form, count in forms.most_common(2)),
    ]


def main() -> None:
    arguments = command(__doc__.partition("\n")[0], draws=60).parse_args()
    families = [FAMILY + name for name in FAMILIES]
    names = [*systems(), *families]
    jobs = [
        Draw(name, (arguments.seed, number, draw))
        for number, name in enumerate(names)
        for draw in range(arguments.draws)
    ]
    results = work_through(combined, jobs, arguments.processes, "combinations")
    by_name = {
        name: [one for job, one in zip(jobs, results, strict=True) if job.system == name]
        for name in names
    }
    rows = [row(name, found) for name, found in by_name.items()]
    rows += [
        row("all systems", [one for name in systems() for one in by_name[name]]),
        row("all families", [one for name in families for one in by_name[name]]),
    ]
    head = [
        "system", "draws", *METRICS, "std / %", "chi² ratio", "disagree / %", "no plain / %",
        "correction / %", "form of largest weight",
    ]  # fmt: skip
    text = (
        "Cells: per cent of the intervals that hold the truth across, along and at 45 degrees "
        "(mean z ± deviation of z). Std: mean standard deviation of MTF at Nyquist over its "
        "value. Chi² ratio: chi-square of the agreement over its expectation. Disagree, no "
        "plain: combinations whose checks `agreement` and `plain_sensor` failed. Correction: mean "
        "size of the correction of the parametric form. G: Gaussian and detector. The last "
        "rows are families of sensors, another one in every draw."
    )
    few_text = (
        "Edges of 80 by 80 px at SNR 100, half of them 4 to 12 degrees off across and half off "
        "along: MTF at Nyquist across and along."
    )
    few_head = [
        "system", "edges", "RMS error of one edge", "RMS error, combined", "stated, combined",
        "held / %",
    ]  # fmt: skip
    parts = [text, table(head, rows), few_text, table(few_head, few_rows(arguments))]
    publish("Combination of edges and pulses", parts, arguments)


if __name__ == "__main__":
    main()
