"""The points method against known truth: errors without noise, coverage, positions, speed.

Example: python benchmarks/points.py --draws 500 --processes 2
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from trials import METRICS, command, publish, table, work_through

import acutance as ac

SNR = 80.0
POSITION_SNR = 50.0
GAUSSIANS = (0.35, 0.45, 0.6)
FAMILY_SNRS = (80.0, 200.0)
BAR = tuple(f"gaussian {sigma:g}" for sigma in GAUSSIANS)
METHODS = ("psf-fit", "gaussian-2003")


@dataclass(frozen=True)
class Job:
    """One image of 20 mirrors: a system, a method, an SNR and a seed (or a noise-free case).

    The system is one of `systems`, or one of `families`: then the sensor is drawn by the seed.
    """

    system: str
    snr: float | None = None
    seed: tuple[int, ...] = ()
    method: str = "psf-fit"


def systems() -> dict[str, ac.Sensor]:
    """The Gaussian systems the bar names, then the reference systems."""
    pixel = ac.optics.Detector()
    named = {f"gaussian {s:g}": ac.Sensor([ac.optics.Gaussian(s), pixel]) for s in GAUSSIANS}
    return named | ac.simulate.reference_systems()


def _halo_of_five_percent(rng: np.random.Generator) -> ac.Sensor:
    optics = ac.optics.Gaussian(rng.uniform(0.3, 0.5))
    return ac.Sensor([optics, ac.optics.Halo(0.05, rng.uniform(1.5, 4.0)), ac.optics.Detector()])


def _mtfc_product(rng: np.random.Generator) -> ac.Sensor:
    optics = ac.optics.Gaussian(rng.uniform(0.4, 0.6))
    kernel = ac.optics.Sharpening.both_axes(rng.uniform(0.1, 0.5))
    return ac.Sensor([optics, ac.optics.Detector(), kernel])


def families() -> dict[str, Callable[[np.random.Generator], ac.Sensor]]:
    """The families of sensors, a halo of 5 % and products sharpened by 3 taps: how to draw one."""
    drawn = {name: partial(ac.optics.draw_sensor, name) for name in ac.optics.FAMILIES}
    return drawn | {"halo of 5 %": _halo_of_five_percent, "MTFC product": _mtfc_product}


def exact_error(job: Job) -> tuple[float, float, float]:
    """Largest error of either slice up to Nyquist, of RER, and of FWHM, without noise.

    NaN where the method finds no source of its kind.
    """
    sensor = systems()[job.system]
    image, truth = ac.simulate.points(sensor)
    try:
        found = ac.measure_points(image, positions=truth.positions, method=job.method)
    except ac.TargetError:
        return np.nan, np.nan, np.nan
    errors = []
    for name, response in (("across", found.across), ("along", found.along)):
        true = truth.response(name)
        inside = true.mtf.freq_cpp <= 0.5
        error = np.abs(response.mtf.value[: inside.size] - true.mtf.value)[inside].max()
        errors.append((error, abs(response.rer.value - true.rer.value),
                       abs(response.fwhm_px.value - true.fwhm_px.value)))  # fmt: skip
    return tuple(np.max(errors, axis=0).tolist())


def noisy_errors(
    job: Job,
) -> tuple[list[tuple[float, float]], np.ndarray, np.ndarray, str] | None:
    """Error and stated deviation of every metric in both directions and of the places; verdict."""
    rng = np.random.default_rng(job.seed)
    drawn = families().get(job.system)
    sensor = systems()[job.system] if drawn is None else drawn(rng)
    layout = ac.simulate.mirror_columns((12.0, 12.0)) + rng.uniform(0, 1, (1, 2))
    image, truth = ac.simulate.points(sensor, positions=layout, snr=job.snr, rng=rng)
    try:
        found = ac.measure_points(image, positions=layout, method=job.method)
    except ac.TargetError:
        return None
    pairs = []
    for name, response in (("across", found.across), ("along", found.along)):
        true = truth.response(name)
        for read in METRICS.values():
            estimate = read(response)
            pairs.append((estimate.value - read(true).value, estimate.std))
    nearest = np.argmin(np.hypot(*(found.positions[:, None] - layout).T), axis=0)
    places = found.positions - layout[nearest]
    std = np.array([(one.row.std, one.col.std) for one in found.sources])
    return pairs, places - places.mean(axis=0), std, found.verdict.word


def main() -> None:
    """Run all parts and print their tables."""
    arguments = command(__doc__.splitlines()[0], 500).parse_args()
    names = list(systems())
    parts = [
        "20 mirrors in two columns (steps of 1.25 by 10.2 px), positions given to a pixel.",
        _exact(names, arguments.processes),
        *_coverage(names, arguments),
        _families(arguments),
        _published(names, arguments),
        _speed(),
    ]
    publish("Accuracy of the points method", parts, arguments)


def _exact(names: list[str], processes: int) -> str:
    jobs = [Job(name, method=method) for method in METHODS for name in names]
    errors = work_through(exact_error, jobs, processes, "without noise")
    rows = []
    for i, name in enumerate(names):
        ours, published = errors[i], errors[i + len(names)]
        rows.append((name, *(f"{e:.4f}" for e in ours), *(f"{e:.3f}" for e in published)))
    head = ("system", "max dM", "dRER", "dFWHM / px", "2003: max dM", "dRER", "dFWHM / px")
    return "## Without noise: largest error of both slices, up to Nyquist\n\n" + table(head, rows)


def _coverage(names: list[str], arguments) -> list[str]:
    jobs = [
        Job(name, SNR, (arguments.seed, i, j))
        for i, name in enumerate(names)
        for j in range(arguments.draws if name in BAR else max(arguments.draws // 4, 2))
    ]
    found = work_through(noisy_errors, jobs, arguments.processes, "coverage")
    rows, places, pooled = [], [], []
    for name in names:
        own = [e for job, e in zip(jobs, found, strict=True) if job.system == name]
        kept = [e for e in own if e is not None]
        pairs = np.array([e[0] for e in kept]).reshape(len(kept), 2, len(METRICS), 2)
        z = (pairs[..., 0] / pairs[..., 1]).reshape(-1, len(METRICS))
        error, std = pairs[..., 0], pairs[..., 1]
        # Every system counts the same, however many images of it there are.
        pooled.append(np.mean(np.abs(z) < 1.96, axis=0))
        rows.append(
            (
                name,
                str(len(kept)),
                *(f"{100 * held:.1f}" for held in np.mean(np.abs(z) < 1.96, axis=0)),
                f"{error[:, :, 0].mean():+.4f}",
                f"{np.sqrt(np.mean(error[:, :, 0] ** 2)):.4f}",
                f"{std[:, :, 0].mean():.4f}",
                f"{error[:, :, 1].mean():+.4f}",
            )
        )
        away = np.vstack([e[1] for e in kept])
        stated = np.vstack([e[2] for e in kept])
        places.append(
            (
                name,
                f"{np.sqrt(np.mean(away**2)) * SNR:.2f}",
                f"{100 * np.mean(np.abs(away) < 1.96 * stated):.1f}",
                f"{100 * (1 - len(away) / (20 * len(own))):.2f}",
            )
        )
    held = (f"{100 * h:.1f}" for h in np.mean(pooled, axis=0))
    rows.append(("**mean of all systems**", "", *held, "", "", "", ""))
    head = ("system", "draws", *METRICS, "bias M(.5)", "RMS M(.5)", "std M(.5)", "bias M(.25)")
    return [
        f"## Coverage of the 95 % intervals in per cent, peak SNR {SNR:g}, both directions\n\n"
        + table(head, rows),
        f"## Places at SNR {SNR:g}: RMS error times SNR, px (bound of a well sampled Gaussian: "
        "0.80; of 0.35 px seen through a pixel: 1.00), and coverage\n\n"
        + table(("system", "RMS x SNR", "coverage", "rejected / %"), places),
        _positions(arguments),
    ]


def _families(arguments) -> str:
    draws = max(arguments.draws // 4, 2)
    jobs = [
        Job(name, snr, (arguments.seed, 55, i, j))
        for i, name in enumerate(families())
        for snr in FAMILY_SNRS
        for j in range(draws)
    ]
    found = work_through(noisy_errors, jobs, arguments.processes, "families")
    rows, pooled = [], []
    for name in families():
        for snr in FAMILY_SNRS:
            own = [
                e
                for job, e in zip(jobs, found, strict=True)
                if (job.system, job.snr) == (name, snr)
            ]
            kept = [e for e in own if e is not None]
            pairs = np.array([e[0] for e in kept]).reshape(-1, len(METRICS), 2)
            held = np.mean(np.abs(pairs[..., 0]) < 1.96 * pairs[..., 1], axis=0)
            pooled.append(held)
            good = np.mean([e[3] == "good" for e in kept])
            rows.append(
                (
                    name,
                    f"{snr:g}",
                    str(len(kept)),
                    *(f"{100 * h:.1f}" for h in held),
                    *(f"{np.sqrt(np.mean(pairs[:, k, 0] ** 2)):.4f}" for k in range(len(METRICS))),
                    f"{100 * good:.0f}",
                )
            )
    held = (f"{100 * h:.1f}" for h in np.mean(pooled, axis=0))
    rows.append(("**mean of all rows**", "", "", *held, *[""] * (len(METRICS) + 1)))
    head = (
        "sensors drawn from",
        "SNR",
        "draws",
        *METRICS,
        *(f"RMS {m}" for m in METRICS),
        "good / %",
    )
    return (
        "## Families of sensors: coverage of the 95 % intervals in per cent, both directions\n\n"
        + table(head, rows)
    )


def _positions(arguments) -> str:
    jobs = [
        Job(name, POSITION_SNR, (arguments.seed, 77, i, j))
        for i, name in enumerate(("gaussian 0.45", "gaussian 0.6"))
        for j in range(max(arguments.draws // 5, 10))
    ]
    found = work_through(noisy_errors, jobs, arguments.processes, "places")
    away = np.vstack([e[1] for e in found if e is not None])
    rms = float(np.sqrt(np.mean(away**2)))
    return (
        f"Places at SNR {POSITION_SNR:g}, Gaussians of 0.45 and 0.6 px: RMS error {rms:.4f} px, "
        f"{rms * POSITION_SNR / 0.80:.2f} times the bound 0.80 / SNR; {len(away)} places."
    )


def _published(names: list[str], arguments) -> str:
    draws = max(arguments.draws // 50, 5)
    jobs = [
        Job(name, SNR, (arguments.seed, i, j), "gaussian-2003")
        for i, name in enumerate(names)
        for j in range(draws)
    ]
    found = work_through(noisy_errors, jobs, arguments.processes, "published")
    rows = []
    for name in names:
        own = [e for job, e in zip(jobs, found, strict=True) if job.system == name]
        pairs = np.array([e[0] for e in own if e is not None])
        pairs = pairs.reshape(len(pairs), 2, len(METRICS), 2)
        rows.append((name, *(f"{b:+.3f}" for b in pairs[..., 0].mean(axis=(0, 1)))))
    return f"## The published Gaussian at SNR {SNR:g}: bias, {draws} draws\n\n" + table(
        ("system", *METRICS), rows
    )


def _speed() -> str:
    rng = np.random.default_rng(1)
    image, truth = ac.simulate.points(systems()["gaussian"], snr=SNR, rng=rng)
    times = []
    for _ in range(8):
        begin = time.process_time()
        found = ac.measure_points(image, positions=truth.positions)
        _ = found.across.mtf_nyquist, found.along.mtf_nyquist
        times.append(time.process_time() - begin)
    return (
        f"20 sources with both slices and their intervals: {1000 * np.median(times):.0f} ms, "
        f"fastest {1000 * min(times):.0f} ms of processor time, one thread."
    )


if __name__ == "__main__":
    main()
