"""Edges behind a population of real telescopes: errors over the Bayesian bound, and coverage.

Telescopes are drawn at random: apertures of .9 to 1.6 c/px, obscured by .2 to .4, up to .3 waves
out of focus, jitter, smear, diffusion of charge. Each is measured from squares of 20 and 40 px at
SNR 50 and 100, at 5 to 20 degrees. The bound is the root mean square error of the posterior mean
of who knows the population, the direction of the edge and the noise; the bound of the families that
of who knows instead that it is one of the families of `acutance.optics` (`telescope_bound`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from telescope_bound import ANGLE_DEG, Population, Posterior, draw_aperture, draw_blur
from trials import (
    METRICS,
    Compared,
    Ranges,
    command,
    compare,
    coverage,
    publish,
    random_edge,
    rms,
    root_mean_square,
    table,
    work_through,
)

import acutance as ac

CONDITIONS = [(20, 50), (20, 100), (40, 50), (40, 100)]
_MIN_EFFECTIVE = 30
"""Effective number of telescopes below which a posterior is counted as known too poorly."""


@dataclass(frozen=True)
class Draw:
    """One telescope, and the telescopes that its posterior is made from."""

    seed: tuple[int, int]
    apertures: int
    blurs: int


@dataclass(frozen=True)
class Found:
    """One edge: its measurement (none if it was refused), the posterior, errors of two of these."""

    compared: Compared | None
    posterior: Posterior
    posterior_error: float
    families_error: float


@cache
def population(apertures: int, blurs: int) -> Population:
    """The telescopes of the bound; drawn once a process."""
    return Population.drawn(apertures, blurs, np.random.default_rng(2024))


@cache
def families(count: int) -> Population:
    """As many sensors of all families; drawn once a process."""
    return Population.of_families(count, np.random.default_rng(2025))


def measure(job: Draw) -> list[Found]:
    """The edges of one telescope under all conditions."""
    rng = np.random.default_rng(job.seed)
    sensor = ac.Sensor([draw_aperture(rng), *draw_blur(rng)])
    state = rng.bit_generator.state
    known, wide = population(job.apertures, job.blurs), families(job.apertures * job.blurs)
    found = []
    for size_px, snr in CONDITIONS:
        # The same direction and offset under all conditions: a sensor's profile is made once.
        rng.bit_generator.state = state
        ranges = Ranges((size_px, size_px), (snr, snr), ANGLE_DEG, 0.5)
        image, truth = random_edge(rng, sensor, ranges)
        noise = (truth.bright - truth.dark) / snr
        both = [one.posterior(image, truth, noise) for one in (known, wide)]
        missed = [one.mean - truth.mtf_nyquist.value for one in both]
        found.append(Found(compare(image, truth.response), both[0], *missed))
    return found


def row(size_px: int, snr: int, edges: list[Found]) -> list[str]:
    """Errors over the bound, and coverage."""
    measured = [edge.compared for edge in edges if edge.compared is not None]
    found = float(root_mean_square(measured)[0])
    bound = rms([edge.posterior_error for edge in edges])
    stated = rms([edge.posterior.std for edge in edges])
    general = rms([edge.families_error for edge in edges])
    effective = np.array([edge.posterior.effective for edge in edges])
    return [
        f"{size_px}", f"{snr}", f"{found:.4f}", f"{bound:.4f}", f"{stated:.4f}",
        f"{found / bound:.2f}", f"{general:.4f}", f"{found / general:.2f}",
        *(f"{share:.1f}" for share in coverage(measured)),
        f"{np.median(effective):.0f}", f"{100 * np.mean(effective < _MIN_EFFECTIVE):.0f}",
        f"{len(edges) - len(measured)}",
    ]  # fmt: skip


def pooled_coverage(edges: list[Found]) -> str:
    """Coverage over all conditions, in words."""
    inside = coverage([edge.compared for edge in edges if edge.compared is not None])
    shares = ", ".join(f"{name} {share:.1f}" for name, share in zip(METRICS, inside, strict=True))
    return f"Pooled, per cent of the intervals that hold the truth: {shares}."


def main() -> None:
    parser = command(__doc__.partition("\n")[0], draws=200)
    parser.add_argument("--apertures", type=int, default=2000, help="drawn for the bound")
    parser.add_argument("--blurs", type=int, default=20, help="drawn for every such aperture")
    arguments = parser.parse_args()
    jobs = [
        Draw((arguments.seed, number), arguments.apertures, arguments.blurs)
        for number in range(arguments.draws)
    ]
    results = work_through(measure, jobs, arguments.processes, "telescopes")
    rows = [
        row(size, snr, [edges[k] for edges in results]) for k, (size, snr) in enumerate(CONDITIONS)
    ]
    drawn = arguments.apertures * arguments.blurs
    head = [
        "size / px", "SNR", "RMS", "bound", "bound, stated", "RMS / bound", "bound of the families",
        "RMS / this",
        *(f"{name} / %" for name in METRICS), "effective", "few / %", "refused",
    ]  # fmt: skip
    parts = [
        f"{arguments.draws} telescopes. RMS: of the error of the MTF at Nyquist. Bound: the same "
        "of the posterior mean under the population as prior, with known direction and noise and "
        f"unknown levels and place, by importance sampling over {drawn} other telescopes; stated: "
        "the root mean square of the posterior's own standard deviation. Bound of the families: "
        "the same of who knows, instead of this population, all families of sensors that have no "
        "trail, telescopes thrice and restored ones twice as often as any other. Effective: median "
        "of the effective number of these telescopes; few: images where it is below "
        f"{_MIN_EFFECTIVE}. "
        "Under the metrics: per cent of the 95 % intervals that hold the truth. Counting alone "
        f"scatters these by ± {100 * np.sqrt(0.95 * 0.05 / arguments.draws):.1f} points, and the "
        f"ratio by about ± {0.7 / np.sqrt(arguments.draws):.2f}.",
        table(head, rows, texts=0),
        pooled_coverage([edge for edges in results for edge in edges]),
    ]
    publish("Telescopes drawn at random, against the Bayesian bound", parts, arguments)


if __name__ == "__main__":
    main()
