"""Time of one region: the method "spline" and a plain 4x-binned e-SFR, interleaved; and a pulse.

One process on one core, the images in memory. Every method measures every image five times in a
row: the shortest is what the computation takes, the first what a user waits who has just
measured something else (and whatever else the machine did meanwhile). Timed for the package:
`measure_edge` from the pixels and the numbers a user reads, each with its standard deviation. The
plain e-SFR is what comparable programs do and no more: row centroids, line, quarter-pixel bins,
difference, Hamming window, Fourier transform; it finds no edge, trims nothing and has no
uncertainty. `iso12233` is the package's method of that name without its resampled deviations.
Pulses are measured with their width fitted from a start 3 % off.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from trials import Ranges, command, publish, random_edge, table, work_through

import acutance as ac
from acutance.targets.straight.options import EdgeOptions
from acutance.targets.straight.published import Iso12233Options

WITHOUT_STD = EdgeOptions(method_options=Iso12233Options(replicates=0))


def plain_esfr(image: np.ndarray) -> float:
    """MTF at Nyquist along the normal of a nearly vertical edge, 4x binned."""
    rows, cols = image.shape
    slope = np.diff(image, axis=1)
    middle = np.arange(cols - 1) + 0.5
    centroid = slope @ middle / slope.sum(axis=1)
    for _ in range(2):
        tilt, start = np.polyfit(np.arange(rows), centroid, 1)
        place = tilt * np.arange(rows) + start
        window = np.hamming(2 * cols)[
            np.clip((middle - place[:, None] + cols).astype(int), 0, 2 * cols - 1)
        ]
        centroid = (slope * window) @ middle / (slope * window).sum(axis=1)
    distance = np.arange(cols) - (tilt * np.arange(rows) + start)[:, None]
    number = np.floor(4 * (distance + cols)).astype(int).ravel()
    count = np.bincount(number)
    esf = np.bincount(number, image.ravel())[count > 0] / count[count > 0]
    lsf = np.diff(esf)
    lsf *= np.roll(np.hamming(lsf.size), int(np.argmax(np.abs(lsf))) - lsf.size // 2)
    otf = np.abs(np.fft.rfft(lsf))
    freq = 4 * np.arange(otf.size) / lsf.size * np.hypot(1, tilt)
    return float(np.interp(0.5, freq, otf / otf[0]))


def spline(image: np.ndarray) -> float:
    found = ac.measure_edge(image)
    numbers = found.mtf_nyquist, found.rer, found.fwhm_px
    return sum(number.std for number in numbers)


def pulse(image: np.ndarray, stated_px: float) -> float:
    found = ac.measure_pulse(image, width_px=stated_px)
    numbers = found.mtf_nyquist, found.rer, found.fwhm_px, found.width_px
    return sum(number.std for number in numbers)


def iso12233(image: np.ndarray) -> float:
    found = ac.measure_edge(image, method="iso12233", options=WITHOUT_STD)
    return found.mtf_nyquist.value + found.rer.value + found.fwhm_px.value


REPEATS = 5

CONTENDERS = {
    "spline, with standard deviations": spline,
    "iso12233, without": iso12233,
    "plain 4x-binned e-SFR, without": plain_esfr,
}


@dataclass(frozen=True)
class Race:
    draws: int
    seed: int


def lap_times(race: Race) -> np.ndarray:
    """Seconds of every contender and of the pulse, (draws, contenders + 1, repeats)."""
    rng = np.random.default_rng(race.seed)
    ranges = Ranges((40, 40), (100.0, 100.0), (3.0, 12.0), 0.5)
    sensors = list(ac.simulate.reference_systems().values())
    taken = []
    for draw in range(-10, race.draws):
        image, truth = random_edge(rng, sensors[draw % len(sensors)], ranges)
        # The plain e-SFR wants its edge upright.
        image = image if truth.orientation == "across" else np.ascontiguousarray(image.T)
        stated_px, strip = random_pulse(rng, sensors[draw % len(sensors)])
        laps = [timed(measure, image) for measure in CONTENDERS.values()]
        laps.append(timed(pulse, strip, stated_px))
        if draw >= 0:
            taken.append(laps)
    return np.array(taken)


def timed(measure: Callable[..., float], *given: object) -> list[float]:
    """Seconds of every repetition."""
    own = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        measure(*given)
        own.append(time.perf_counter() - start)
    return own


def random_pulse(rng: np.random.Generator, sensor: ac.Sensor) -> tuple[float, np.ndarray]:
    """A width that is stated 3 % wide, and the image of the pulse."""
    width_px = float(rng.uniform(2.6, 3.7))
    image, _ = ac.simulate.pulse(
        sensor,
        width_px=width_px,
        angle_deg=float(rng.uniform(3, 12)),
        shape=(40, 35),
        snr=100,
        offset_px=float(rng.uniform(-0.5, 0.5)),
        rng=rng,
    )
    return 1.03 * width_px, np.asarray(image)


def main() -> None:
    arguments = command(__doc__.partition("\n")[0], draws=400).parse_args()
    race = Race(arguments.draws, arguments.seed)
    (taken,) = work_through(lap_times, [race], 1, "races")
    shortest, first = taken.min(axis=2), taken[:, :, 0]
    plain = shortest[:, len(CONTENDERS) - 1]
    rows = []
    for number, name in enumerate([*CONTENDERS, "pulse of 40 x 35 px, width fitted"]):
        own = shortest[:, number]
        low, high = np.quantile(own, [0.1, 0.9])
        rows.append(
            [
                name,
                f"{1e3 * np.median(own):.2f}",
                f"{1e3 * low:.2f} to {1e3 * high:.2f}",
                f"{1e3 * np.median(first[:, number]):.2f}",
                f"{np.median(own / plain):.2f}",
            ]
        )
    head = ["method", "median / ms", "10 to 90 % / ms", "first time / ms", "ratio to plain"]
    parts = [
        "One region of 40 x 40 px, SNR 100, the reference systems in turn, angles 3 to 12 "
        "degrees; one core. Of every image the shortest of five times counts; then the first. "
        "The ratio is the median over the images.",
        table(head, rows),
    ]
    publish("Time of one region", parts, arguments)


if __name__ == "__main__":
    main()
