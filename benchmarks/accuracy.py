"""Errors of every edge method against the truth: without noise, then with it.

Every measurement starts from the pixels alone. Without noise: all reference systems, nine angles
(samples repeat at tan = 1/8, 1/5, 1/4, 1/3, 1/2), all orientations and polarities, 60 x 60 px;
the largest error of the MTF from 0 to Nyquist, of RER and of FWHM. With noise: bias and root
mean square error of the MTF at Nyquist for a Gaussian of 0.4 px and a square pixel, angles
5 to 20 degrees.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
from trials import COMBINATIONS, Ranges, command, publish, random_edge, table, work_through

import acutance as ac
from acutance.targets.straight import METHODS

ANGLES_DEG = (2.0, 6.0, 7.125, 11.31, 14.036, 18.435, 26.565, 33.0, 43.0)
NOISY = [(20, 100.0), (20, 50.0), (40, 100.0), (40, 50.0), (100, 100.0), (100, 50.0)]
PUBLISHED_AT = (40, 100.0)


@dataclass(frozen=True)
class Exact:
    """One noise-free edge for one method."""

    method: str
    system: str
    angle_deg: float
    orientation: str
    polarity: str


@dataclass(frozen=True)
class Noisy:
    """One noisy edge for one method."""

    method: str
    size_px: int
    snr: float
    seed: tuple[int, ...]


def exact_errors(job: Exact) -> tuple[float, float, float] | str:
    """Errors of MTF (the largest), RER and FWHM; or the name of the refusal."""
    image, truth = ac.simulate.edge(
        ac.simulate.reference_systems()[job.system],
        angle_deg=job.angle_deg,
        orientation=job.orientation,
        polarity=job.polarity,
        shape=(60, 60),
    )
    try:
        found = ac.measure_edge(image, method=job.method)
    except ac.AcutanceError as error:
        return type(error).__name__
    freq = truth.mtf.freq_cpp[truth.mtf.freq_cpp <= 0.5]
    mtf = np.interp(freq, found.mtf.freq_cpp, found.mtf.value)
    return (
        float(np.max(np.abs(mtf - truth.mtf.value[: freq.size]))),
        abs(found.rer.value - truth.rer.value),
        abs(found.fwhm_px.value - truth.fwhm_px.value),
    )


def noisy_error(job: Noisy) -> float | str:
    """Error of the MTF at Nyquist; or the name of the refusal."""
    rng = np.random.default_rng(job.seed)
    ranges = Ranges((job.size_px, job.size_px), (job.snr, job.snr), (5.0, 20.0), 0.5)
    image, truth = random_edge(rng, ac.simulate.reference_systems()["gaussian"], ranges)
    try:
        found = ac.measure_edge(image, method=job.method)
    except ac.AcutanceError as error:
        return type(error).__name__
    return found.mtf_nyquist.value - truth.mtf_nyquist.value


def refusals(results: list) -> str:
    """How many were refused, by error class."""
    names = [result for result in results if isinstance(result, str)]
    return ", ".join(f"{names.count(name)} {name}" for name in sorted(set(names))) or "0"


def exact_tables(processes: int) -> list[str]:
    """Largest errors of every method on every system, and at every angle."""
    jobs = [
        Exact(method, system, angle, orientation, polarity)
        for method in METHODS
        for system in ac.simulate.reference_systems()
        for angle in ANGLES_DEG
        for orientation, polarity in COMBINATIONS
    ]
    results = work_through(exact_errors, jobs, processes, "without noise")
    by_system, by_angle = [], []
    for method in METHODS:
        for system in ac.simulate.reference_systems():
            own = [
                result
                for job, result in zip(jobs, results, strict=True)
                if (job.method, job.system) == (method, system)
            ]
            by_system.append([method, system, *largest(own), refusals(own)])
        for angle in ANGLES_DEG:
            own = [
                result
                for job, result in zip(jobs, results, strict=True)
                if (job.method, job.angle_deg) == (method, angle)
            ]
            by_angle.append([method, f"{angle:g}", *largest(own), refusals(own)])
    errors = ["max dM", "dRER", "dFWHM / px", "refused"]
    shapes = len(ANGLES_DEG) * len(COMBINATIONS)
    return [
        "## Without noise, 60 x 60 px: largest absolute error",
        f"Over {len(ANGLES_DEG)} angles, both orientations, both polarities ({shapes} images a "
        "row); dM over 0 to Nyquist.",
        table(["method", "system", *errors], by_system, texts=2),
        "The same by angle, over all systems:",
        table(["method", "angle / deg", *errors], by_angle),
    ]


def largest(results: list) -> list[str]:
    """The largest error of each kind, as text."""
    measured = np.array([result for result in results if not isinstance(result, str)])
    if measured.size == 0:
        return ["refused"] * 3
    return [f"{value:.5f}" if np.isfinite(value) else "undefined" for value in measured.max(axis=0)]


def noisy_tables(arguments: argparse.Namespace) -> list[str]:
    """Bias and RMS error of the MTF at Nyquist."""
    settings = [("spline", *setting, arguments.draws) for setting in NOISY]
    others = [method for method in METHODS if method != "spline"]
    settings += [(method, *PUBLISHED_AT, arguments.published_draws) for method in others]
    jobs = [
        # The same images for every method.
        Noisy(method, size, snr, (arguments.seed, size, int(snr), draw))
        for method, size, snr, draws in settings
        for draw in range(draws)
    ]
    results = work_through(noisy_error, jobs, arguments.processes, "with noise")
    rows = []
    for method, size, snr, draws in settings:
        own = [
            result
            for job, result in zip(jobs, results, strict=True)
            if (job.method, job.size_px, job.snr) == (method, size, snr)
        ]
        error = np.array([result for result in own if not isinstance(result, str)])
        numbers = ["refused", "refused"]
        if error.size:
            numbers = [f"{error.mean():+.4f}", f"{np.sqrt(np.mean(error**2)):.4f}"]
        rows.append([method, f"{size}", f"{snr:g}", f"{draws}", *numbers, refusals(own)])
    return [
        "## With noise: error of the MTF at Nyquist",
        "Gaussian of 0.4 px and a square pixel (truth 0.289), angles 5 to 20 degrees, SNR = "
        "contrast / noise.",
        table(["method", "size / px", "SNR", "draws", "bias", "RMS", "refused"], rows),
    ]


def main() -> None:
    parser = command(__doc__.partition("\n")[0], draws=500)
    parser.add_argument("--published-draws", type=int, default=100)
    arguments = parser.parse_args()
    parts = exact_tables(arguments.processes) + noisy_tables(arguments)
    publish("Accuracy of the edge methods", parts, arguments)


if __name__ == "__main__":
    main()
