"""How exact MTF curves from Siemens stars and from bars are, and whether their intervals hold.

Random stars (centre, turn, sine and square waves in turn) and random groups of bars (periods,
tilt up to 12 degrees, length, 3 to 6 bars, found in the image) at SNR 100, seen by the reference
systems. RMS is that of the error of the MTF over 0.1..0.5 c/px; coverage the share of 95 %
intervals that hold the truth, over those frequencies. Stars: curves across, along and the mean
over directions. Bars: the curve along their normal, and the plain readings of every group for
comparison. Levels stated: dark and bright are known from patches of 100 pixels each, and as
uncertain.

Families: a sensor drawn at random for every target, from broad ranges of optics, motion, charge
and processing; coverage of MTF(.5), MTF(.25), RER and FWHM by the same intervals. Refused: targets
that were not measured, of products that are sharpened to more than three times their contrast.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from trials import METRICS, TWO_SIDED_95, command, publish, table, work_through

import acutance as ac
from acutance.optics import FAMILIES, draw_sensor
from acutance.simulate import StarTruth
from acutance.targets.periodic import BarsOptions, StarOptions, measure_bars, measure_star

FREQ = np.arange(10, 51, 2) / 100
DARK, BRIGHT, SNR = 200.0, 1200.0, 100.0
PATCH_STD = (BRIGHT - DARK) / SNR / 10


@dataclass(frozen=True)
class StarCase:
    """One kind of star: cycles, radius, whether its levels are stated."""

    name: str
    cycles: int
    radius_px: float
    levels: bool
    sweep_deg: float = 360.0


STARS = (
    StarCase("36 cycles, 52 px, levels stated", 36, 52.0, levels=True),
    StarCase("14 cycles, 60 px, levels unknown", 14, 60.0, levels=False),
    StarCase("fan of 110 degrees, 48 cycles, 90 px, levels stated", 48, 90.0, True, 110.0),
)


@dataclass(frozen=True)
class BarsCase:
    """One kind of target: periods of its groups, whether its levels are stated."""

    name: str
    periods_px: tuple[float, ...]
    levels: bool


BARS = (
    BarsCase("8 groups of 12 to 2 px, levels unknown", (12, 8, 6, 5, 4, 3.2, 2.5, 2), levels=False),
    BarsCase("8 groups of 12 to 2 px, levels stated", (12, 8, 6, 5, 4, 3.2, 2.5, 2), levels=True),
)


def levels(case: StarCase | BarsCase, rng: np.random.Generator) -> dict[str, Any]:
    """The options that state the levels, where a case does."""
    if not case.levels:
        return {}
    dark, bright = (level + PATCH_STD * rng.standard_normal() for level in (DARK, BRIGHT))
    return {"dark": dark, "bright": bright, "level_std": PATCH_STD * float(np.sqrt(2))}


def random_star(
    case: StarCase, sensor: ac.Sensor, rng: np.random.Generator, number: int
) -> tuple[ac.StarMeasurement, StarTruth]:
    """Measure a star of random centre and turn; the truth is that of the image."""
    side = 2 * round(case.radius_px + 12)
    wave = ("sine", "square")[number % 2]
    image, truth = ac.simulate.star(
        sensor, cycles=case.cycles, radius_px=case.radius_px, shape=(side, side), wave=wave,
        start_deg=float(rng.uniform(0, 360)), sweep_deg=case.sweep_deg,
        centre=tuple((side / 2 + rng.uniform(-2, 2, 2)).tolist()),
        dark=DARK, bright=BRIGHT, snr=SNR, rng=rng,
    )  # fmt: skip
    options = StarOptions(wave=wave, **levels(case, rng))
    return measure_star(image, cycles=case.cycles, options=options), truth


def random_bars(
    case: BarsCase, sensor: ac.Sensor, rng: np.random.Generator, number: int
) -> ac.BarsMeasurement:
    """Measure groups of bars of random periods, tilt and size."""
    image, _ = ac.simulate.bars(
        sensor, periods_px=[p * rng.uniform(0.96, 1.04) for p in case.periods_px],
        count=int(rng.integers(3, 7)), length_px=float(rng.uniform(20, 32)),
        angle_deg=float(rng.uniform(-12, 12)), orientation=("across", "along")[number % 2],
        dark=DARK, bright=BRIGHT, snr=SNR, rng=rng,
    )  # fmt: skip
    return measure_bars(image, options=BarsOptions(**levels(case, rng)))


def star_trial(job: tuple[StarCase, str, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Errors and standard deviations of the curves of a random star, (1 or 3, n) each."""
    case, name, seed, number = job
    sensor = ac.simulate.reference_systems()[name]
    rng = np.random.default_rng([seed, number, len(name), case.cycles])
    found, truth = random_star(case, sensor, rng, number)
    truths, curves = [truth.mtf_mean(FREQ, found.directions_deg)], [found.mean_mtf]
    # A fan of less than half a turn holds no spokes for some directions.
    if case.sweep_deg >= 180:
        truths += [truth.mtf_toward(0.0, FREQ), truth.mtf_toward(90.0, FREQ)]
        curves += [found.across.mtf, found.along.mtf]
    errors = [[m(f).value for f in FREQ] - true for m, true in zip(curves, truths, strict=True)]
    return np.array(errors), np.array([[m(f).std for f in FREQ] for m in curves])


Trial = tuple[np.ndarray, np.ndarray, np.ndarray]


def bars_trial(job: tuple[BarsCase, str, int, int]) -> Trial:
    """Errors and standard deviations of a curve, (1, n), and errors of the plain readings, (k, 2).

    The readings are the sinusoids, and the MTF by Coltman's series.
    """
    case, name, seed, number = job
    sensor = ac.simulate.reference_systems()[name]
    rng = np.random.default_rng([seed, number, len(name), len(case.periods_px)])
    found = random_bars(case, sensor, rng, number)

    def truth(freq: float) -> float:
        angle = np.radians(found.directions_deg[0])
        there = np.array([freq])
        return float(np.abs(sensor.otf(there * np.cos(angle), there * np.sin(angle)))[0])

    errors = np.array([[found.normal_response.mtf(f).value - truth(f) for f in FREQ]])
    plain = [
        (one.reading.modulation - truth(one.freq_cpp), one.coltman - truth(one.freq_cpp))
        for one in found.groups
    ]
    return errors, np.array([[found.normal_response.mtf(f).std for f in FREQ]]), np.array(plain)


def family_trial(job: tuple[StarCase | BarsCase, str, int, int]) -> np.ndarray:
    """Errors and standard deviations of the numbers of a random sensor, (1 or 2, numbers, 2).

    Of a target that was refused none, (0, numbers, 2).
    """
    case, family, seed, number = job
    rng = np.random.default_rng([seed, number, *family.encode()])
    sensor = draw_sensor(family, rng)
    try:
        if isinstance(case, StarCase):
            found, _ = random_star(case, sensor, rng, number)
            pairs = [(found.across, sensor.response_along(0.0))]
            pairs += [(found.along, sensor.response_along(90.0))]
        else:
            bars = random_bars(case, sensor, rng, number)
            pairs = [(bars.normal_response, sensor.response_along(bars.directions_deg[0]))]
    except ac.TargetError:
        return np.empty((0, len(METRICS), 2))
    return np.array(
        [
            [(read(found).value - read(true).value, read(found).std) for read in METRICS.values()]
            for found, true in pairs
        ]
    )


def row_of(name: str, errors: np.ndarray, stds: np.ndarray) -> list[str]:
    """One line of a table: RMS, bias, mean std, coverage and the spread of z."""
    z = errors / stds
    return [
        name,
        f"{np.sqrt(np.mean(errors**2)):.4f}",
        f"{np.mean(errors):+.4f}",
        f"{np.sqrt(np.mean(stds**2)):.4f}",
        f"{100 * np.mean(np.abs(z) < 1.96):.1f}",
        f"{np.sqrt(np.mean(z**2)):.2f}",
    ]


HEAD = ("system", "RMS error", "bias", "std promised", "coverage %", "rms z")


def star_table(case: StarCase, draws: int, seed: int, processes: int) -> str:
    """All systems of one kind of star."""
    names = list(ac.simulate.reference_systems())
    jobs = [(case, name, seed, number) for name in names for number in range(draws)]
    results = work_through(star_trial, jobs, processes, case.name)
    rows, every = [], []
    for i, name in enumerate(names):
        own = results[i * draws : (i + 1) * draws]
        every += own
        rows.append(row_of(name, np.array([e for e, _ in own]), np.array([s for _, s in own])))
    rows.append(row_of("all", np.array([e for e, _ in every]), np.array([s for _, s in every])))
    return f"## Star: {case.name}\n\n{table(HEAD, rows)}"


def bars_table(case: BarsCase, draws: int, seed: int, processes: int) -> str:
    """All systems of one kind of bars."""
    names = list(ac.simulate.reference_systems())
    jobs = [(case, name, seed, number) for name in names for number in range(draws)]
    results: list[Trial] = work_through(bars_trial, jobs, processes, case.name)
    rows = []
    for name, own in [
        *((name, results[i * draws : (i + 1) * draws]) for i, name in enumerate(names)),
        ("all", results),
    ]:
        errors, stds = (np.concatenate([one[i] for one in own]) for i in (0, 1))
        plain = np.concatenate([one[2] for one in own])
        # Bars along the grid have no plain readings.
        rms = np.sqrt(np.nanmean(plain**2, axis=0))
        rows.append([*row_of(name, errors, stds), *(f"{one:.4f}" for one in rms)])
    head = (*HEAD, "sinusoids", "Coltman")
    return f"## Bars: {case.name}\n\n{table(head, rows)}"


def family_table(case: StarCase | BarsCase, draws: int, seed: int, processes: int) -> str:
    """All families of sensors of one kind of target."""
    jobs = [(case, name, seed, number) for name in FAMILIES for number in range(draws)]
    results = work_through(family_trial, jobs, processes, f"families: {case.name}")
    rows = []
    for name, own in [
        *((name, results[i * draws : (i + 1) * draws]) for i, name in enumerate(FAMILIES)),
        ("all", results),
    ]:
        error, std = np.moveaxis(np.concatenate(own), -1, 0)
        held = 100 * np.mean(np.abs(error) < TWO_SIDED_95 * std, axis=0)
        rms = np.sqrt(np.mean(error**2, axis=0))
        refused = sum(len(one) == 0 for one in own)
        cells = [f"{h:.0f}, {r:.4f}" for h, r in zip(held, rms, strict=True)]
        rows.append([name, *cells, str(refused)])
    kind = "Star" if isinstance(case, StarCase) else "Bars"
    head = ("family", *(f"{name}: held %, RMS" for name in METRICS), "refused")
    return f"## {kind}, families of sensors: {case.name}\n\n{table(head, rows)}"


if __name__ == "__main__":
    arguments = command(__doc__ or "", draws=60).parse_args()
    given = (arguments.draws, arguments.seed, arguments.processes)
    parts = [star_table(case, *given) for case in STARS]
    parts += [bars_table(case, *given) for case in BARS]
    parts += [family_table(case, *given) for case in (STARS[0], BARS[1])]
    publish("Bars and stars", [str(__doc__), *parts], arguments)
