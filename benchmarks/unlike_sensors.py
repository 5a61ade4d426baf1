"""Sensors unlike all families that priors know: do intervals hold behind them?

Example: python benchmarks/unlike_sensors.py --draws 20 --processes 2
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import j0
from trials import METRICS, TWO_SIDED_95, command, publish, table, work_through

import acutance as ac
from acutance.curves import Response
from acutance.optics import Block, Detector, Gaussian, Smear

SNR = 100.0
DARK, BRIGHT = 200.0, 1200.0


@dataclass(frozen=True)
class Jitter:
    """A sinusoidal vibration of some amplitude across, and of .7 of it along."""

    amplitude_px: float

    def otf(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        waves = 2 * np.pi * self.amplitude_px
        return np.asarray(j0(waves * u) * j0(0.7 * waves * v))


@dataclass(frozen=True)
class FourSpots:
    """An optical low-pass filter of two birefringent plates."""

    half_px: float

    def otf(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        waves = 2 * np.pi * self.half_px
        return np.asarray(np.cos(waves * u) * np.cos(waves * v))


@dataclass(frozen=True)
class Crosstalk:
    """A share of the charge in each of four neighbours."""

    share: float

    def otf(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        by_col, by_row = (1 - 2 * self.share * (1 - np.cos(2 * np.pi * f)) for f in (u, v))
        return np.asarray(by_col * by_row)


@dataclass(frozen=True)
class Secant:
    """A spot ``1 / cosh(r / a)``: round at its middle, far out an exponential."""

    radius_px: float

    def otf(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        r = np.linspace(0.0, 40.0 * self.radius_px, 8001)
        light = r / np.cosh(r / self.radius_px)
        freq_cpp = np.linspace(0.0, 4.0, 201)
        found = j0(2 * np.pi * freq_cpp[:, None] * r) @ light
        return np.asarray(np.interp(np.hypot(u, v), freq_cpp, found / found[0]))


@dataclass(frozen=True)
class SecondImage:
    """A share of the light in images on both sides, or in a ghost on one."""

    share: float
    away_px: float
    one_side: bool

    def otf(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        waves = 2 * np.pi * self.away_px * u + 0 * v
        other = np.exp(-1j * waves) if self.one_side else np.cos(waves)
        return np.asarray(1 - self.share + self.share * other)


@dataclass(frozen=True)
class Lorentz:
    """Diffusion that falls like an exponential: ``1 / (1 + (2 pi l f)^2)``."""

    length_px: float

    def otf(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.asarray(1 / (1 + (2 * np.pi * self.length_px) ** 2 * (u**2 + v**2)))


@dataclass(frozen=True)
class Amplifier:
    """Electronics of second order along rows: they lag, and swing about once."""

    corner_cpp: float
    damping: float

    def otf(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        share = u / self.corner_cpp
        return np.asarray(1 / (1 - share**2 + 2j * self.damping * share) + 0 * v)


def _blur(rng: np.random.Generator) -> list[Block]:
    return [Gaussian(rng.uniform(0.25, 0.45)), Detector()]


def _detector(low_px: float, high_px: float, rng: np.random.Generator) -> list[Block]:
    return [Gaussian(rng.uniform(0.25, 0.5)), Detector(rng.uniform(low_px, high_px))]


def _uneven(rng: np.random.Generator) -> list[Block]:
    width_px = rng.uniform(0.6, 1.6)
    detector = Detector(width_px, width_px * rng.uniform(0.7, 1.4))
    return [Gaussian(rng.uniform(0.25, 0.5)), detector]


SHAPES: dict[str, Callable[[np.random.Generator], list[Block]]] = {
    "sinusoidal vibration": lambda rng: [*_blur(rng), Jitter(rng.uniform(0.2, 0.5))],
    "optical low-pass filter": lambda rng: [*_blur(rng), FourSpots(rng.uniform(0.15, 0.33))],
    "crosstalk": lambda rng: [*_blur(rng), Crosstalk(rng.uniform(0.03, 0.12))],
    "secant spot": lambda rng: [Detector(), Secant(rng.uniform(0.2, 0.5))],
    "double image": lambda rng: [*_blur(rng), SecondImage(0.3, rng.uniform(0.3, 0.9), False)],
    "exponential diffusion": lambda rng: [*_blur(rng), Lorentz(rng.uniform(0.1, 0.3))],
    "electronics of second order": lambda rng: [
        *_blur(rng), Amplifier(rng.uniform(0.7, 1.5), rng.uniform(0.5, 0.8))
    ],
    "smear of changing speed": lambda rng: [
        *_blur(rng), *2 * [Smear(rng.uniform(0.3, 1.0), "across")]
    ],
    "detector of 1.2 to 1.8 px": lambda rng: _detector(1.2, 1.8, rng),
    "detector of 0.5 to 0.8 px": lambda rng: _detector(0.5, 0.8, rng),
    "detector that is not square": _uneven,
    "ghost of 1 to 4 %, 2 to 5 px away": lambda rng: [
        *_blur(rng), SecondImage(rng.uniform(0.01, 0.04), rng.uniform(2, 5), True)
    ],
}  # fmt: skip


@dataclass(frozen=True)
class Job:
    """One image of a target behind one sensor."""

    target: str
    shape: str
    seed: tuple[int, ...]


def edge(sensor: ac.Sensor, rng: np.random.Generator) -> tuple[list[Response], list[Response], str]:
    """Of 60 px, 2.5 to 14 degrees off the grid, across or along: what was found, and the truth."""
    image, true = ac.simulate.edge(
        sensor, angle_deg=rng.uniform(2.5, 14), orientation=("across", "along")[rng.integers(2)],
        shape=(60, 60), snr=SNR, offset_px=rng.uniform(-0.5, 0.5), rng=rng,
    )  # fmt: skip
    found = ac.measure_edge(image)
    return [found.response], [true], found.verdict.word


def pulse(
    sensor: ac.Sensor, rng: np.random.Generator
) -> tuple[list[Response], list[Response], str]:
    """Of 3 px in 60 px."""
    image, true = ac.simulate.pulse(
        sensor, width_px=3.0, angle_deg=rng.uniform(3, 10), shape=(60, 60), snr=SNR, rng=rng
    )
    found = ac.measure_pulse(image, width_px=3.0)
    return [found.response], [true], found.verdict.word


def mirrors(
    sensor: ac.Sensor, rng: np.random.Generator
) -> tuple[list[Response], list[Response], str]:
    """Twenty, at known places."""
    image, truth = ac.simulate.points(sensor, snr=SNR, rng=rng)
    found = ac.measure_points(image, positions=truth.positions)
    return _both(found.across, found.along, sensor, found.verdict.word)


def star(sensor: ac.Sensor, rng: np.random.Generator) -> tuple[list[Response], list[Response], str]:
    """Of 36 cycles and stated levels."""
    image, _ = ac.simulate.star(sensor, dark=DARK, bright=BRIGHT, snr=SNR, rng=rng)
    found = ac.measure_star(image, options=ac.StarOptions(dark=DARK, bright=BRIGHT))
    return _both(found.across, found.along, sensor, found.verdict.word)


def _both(
    across: Response, along: Response, sensor: ac.Sensor, word: str
) -> tuple[list[Response], list[Response], str]:
    true = [sensor.response(0.0, "across"), sensor.response(0.0, "along")]
    return [across, along], true, word


TARGETS = {"edges": edge, "pulses": pulse, "mirrors": mirrors, "stars": star}


def measured(job: Job) -> tuple[np.ndarray, str] | None:
    """Errors and deviations of every metric, (directions, 4, 2), and the verdict's word."""
    rng = np.random.default_rng(job.seed)
    sensor = ac.Sensor(SHAPES[job.shape](rng))
    try:
        found, true, word = TARGETS[job.target](sensor, rng)
    except ac.AcutanceError:
        return None
    pairs = [
        [(read(one).value - read(other).value, read(one).std) for read in METRICS.values()]
        for one, other in zip(found, true, strict=True)
    ]
    return np.array(pairs), word


def row(shape: str, found: Sequence[tuple[np.ndarray, str] | None]) -> tuple[str, ...]:
    """Of one shape: intervals that hold, RMS errors, verdicts."""
    told = [one for one in found if one is not None]
    pairs = np.concatenate([one[0] for one in told])
    held = 100 * np.mean(np.abs(pairs[..., 0]) < TWO_SIDED_95 * pairs[..., 1], axis=0)
    error = np.sqrt(np.mean(pairs[..., 0] ** 2, axis=0))
    trusted = sum(one[1] in ("good", "usable") for one in told)
    return (
        shape, f"{len(pairs)}", *(f"{share:.0f}" for share in held),
        *(f"{one:.4f}" for one in error), f"{trusted} of {len(found)}",
    )  # fmt: skip


def main() -> None:
    """A table of every kind of target."""
    arguments = command(__doc__.splitlines()[0], 20).parse_args()
    jobs = [
        Job(target, shape, (arguments.seed, place, i))
        for target in TARGETS
        for place, shape in enumerate(SHAPES)
        for i in range(arguments.draws)
    ]
    found = dict(
        zip(jobs, work_through(measured, jobs, arguments.processes, "sensors"), strict=True)
    )
    head = ("sensor", "numbers", *(f"{name}: held / %" for name in METRICS),
            *(f"{name}: RMS" for name in METRICS), "good or usable")  # fmt: skip
    parts = ["SNR 100; mirrors and stars across and along."]
    for target in TARGETS:
        rows = [
            row(shape, [found[job] for job in jobs if (job.target, job.shape) == (target, shape)])
            for shape in SHAPES
        ]
        parts.append(f"## {target.capitalize()}\n\n" + table(head, rows))
    publish("Sensors unlike all families", parts, arguments)


if __name__ == "__main__":
    main()
