"""How exact MTF curves from Siemens stars and from bars are, and whether their intervals hold.

Random stars (centre, turn, sine and square waves in turn) and random bar groups (phase of every
group, tilt) at SNR 100, seen by the reference systems. RMS is that of the error of the MTF over
0.1..0.5 c/px; coverage the share of 95 % intervals that hold the truth, over those frequencies.
Stars: curves across, along and the mean over directions. Bars: the curve along their normal.
Levels stated: dark and bright are known from patches of 100 pixels each, and as uncertain.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from trials import command, publish, table, work_through

import acutance as ac
from acutance.measure.star import measure_star
from acutance.measure.star_options import StarOptions

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
    StarCase("36 cycles, 52 px, levels unknown", 36, 52.0, levels=False),
    StarCase("14 cycles, 60 px, levels unknown", 14, 60.0, levels=False),
)


def star_trial(job: tuple[StarCase, str, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Errors and standard deviations of the three curves of a random star, (3, n) each."""
    case, name, seed, number = job
    sensor = ac.simulate.reference_systems()[name]
    rng = np.random.default_rng([seed, number, len(name), case.cycles])
    side = 2 * round(case.radius_px + 12)
    wave = ("sine", "square")[number % 2]
    image, truth = ac.simulate.star(
        sensor, cycles=case.cycles, radius_px=case.radius_px, shape=(side, side), wave=wave,
        start_deg=float(rng.uniform(0, 360)), sweep_deg=case.sweep_deg,
        centre=tuple((side / 2 + rng.uniform(-2, 2, 2)).tolist()),
        dark=DARK, bright=BRIGHT, snr=SNR, rng=rng,
    )  # fmt: skip
    options = StarOptions(wave=wave)
    if case.levels:
        dark, bright = (level + PATCH_STD * rng.standard_normal() for level in (DARK, BRIGHT))
        options = StarOptions(
            wave=wave, dark=dark, bright=bright, level_std=PATCH_STD * float(np.sqrt(2))
        )
    found = measure_star(image, cycles=case.cycles, options=options)
    truths = [truth.mtf_toward(0.0, FREQ), truth.mtf_toward(90.0, FREQ), truth.mtf_mean(FREQ)]
    curves = [found.across.mtf, found.along.mtf, found.mtf]
    errors = [[m(f).value for f in FREQ] - true for m, true in zip(curves, truths, strict=True)]
    return np.array(errors), np.array([[m(f).std for f in FREQ] for m in curves])


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


if __name__ == "__main__":
    arguments = command(__doc__ or "", draws=60).parse_args()
    parts = [
        star_table(case, arguments.draws, arguments.seed, arguments.processes) for case in STARS
    ]
    publish("Bars and stars", [str(__doc__), *parts], arguments)
