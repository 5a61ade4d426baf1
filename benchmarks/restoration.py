"""Restoration: predicted against measured, against truth and other programs, robust, and fast.

scikit-image is not needed by acutance: its table is left out where it is not installed.
"""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.ndimage import convolve
from scipy.optimize import brentq
from scipy.signal import oaconvolve
from trials import TWO_SIDED_95, command, publish, table

import acutance as ac
from acutance.curves import Otf2d
from acutance.optics import Detector, Gaussian, Resampling, Smear
from acutance.optics.processing import interpolation_weight
from acutance.restoration.filtered_otf import FilteredOtf, SensorOtf
from acutance.restoration.knobs import worst_overshoot
from acutance.targets.uncertainty_budget import std_of_mean, systematic_share

SENSORS = {
    "Gaussian .5 px": ac.Sensor([Gaussian(0.5), Detector()]),
    "Gaussian .7 px": ac.Sensor([Gaussian(0.7), Detector()]),
    "smear 1.5 px": ac.Sensor([Gaussian(0.4), Detector(), Smear(1.5, "along")]),
}
IDEAL = ac.Sensor([Detector()])
BORDER = np.s_[24:-24, 24:-24]
GAINS = (1.5, 2.0, 2.5)


def measured_again(draws: int, seed: int) -> str:
    """Edges of simulated scenes before and after a filter, at two noise levels."""
    rows = []
    sensor = SENSORS["Gaussian .5 px"]
    cases = [(gain, "pixel", "spline") for gain in GAINS]
    cases += [(2.0, "pixel", "iso12233"), (2.5, "point", "spline"), (2.5, "point", "iso12233")]
    for snr in (100.0, 300.0):
        for gain, desired, method in cases:
            filter = ac.design_restoration(sensor, snr=snr, noise_gain=gain, desired=desired)
            found = [one_scene(filter, sensor, snr, (seed, i), method) for i in range(draws)]
            off, error, std, held, noise = (np.array(column) for column in zip(*found, strict=True))
            rows.append([
                desired, method, f"{snr:.0f}", f"{gain:.1f}",
                f"{filter.after.across.mtf_nyquist.value:.4f}",
                f"{off.mean():+.4f}", f"{np.sqrt(np.mean(off**2)):.4f}",
                f"{np.sqrt(np.mean(error**2)):.4f}", f"{np.median(std):.4f}",
                f"{100 * held.mean():.0f}", f"{noise.mean():.3f}",
            ])  # fmt: skip
    head = [
        "desired", "method", "SNR", "noise gain", "MTF predicted",
        "measured minus predicted, mean", "RMS",
        "measured minus true, RMS", "its stated deviation", "held / %", "noise gain measured",
    ]  # fmt: skip
    return table(head, rows, texts=2)


def one_scene(
    filter: ac.RestorationFilter, sensor: ac.Sensor, snr: float, seed: tuple[int, int], method: str
) -> tuple[float, float, float, bool, float]:
    """A scene of four edges (two across, two along), restored and measured again: weighted means.

    Off the prediction, off the truth, the deviation of that (what the edges have in common does
    not average out), whether its interval holds, and the noise after over that before.
    """
    rng = np.random.default_rng(seed)
    off, error, std, common = [], [], [], []
    for number in range(4):
        orientation = ("across", "along")[number % 2]
        image, truth = ac.simulate.edge(
            sensor, shape=(150, 150), angle_deg=float(rng.uniform(3, 15)), snr=snr,
            orientation=orientation, rng=rng,
        )  # fmt: skip
        before, after = (
            ac.measure_edge(one, (20, 20, 110, 110), method=method)
            for one in (image, ac.restore(image, filter))
        )
        normal = math.radians(before.normal_deg)
        gain = abs(complex(filter.otf(0.5 * math.cos(normal), 0.5 * math.sin(normal))))
        found = after.mtf_nyquist
        off.append(found.value - gain * before.mtf_nyquist.value)
        error.append(found.value - gain * truth.mtf_nyquist.value)
        std.append(found.std)
        common.append(systematic_share(after.budget, orientation, "mtf_nyquist"))
    shares = np.array(std) ** -2 / np.sum(np.array(std) ** -2)
    stated = std_of_mean(shares, np.array(std), np.array(common))
    miss = float(shares @ error)
    noise = rng.normal(0, 1, (300, 300))
    measured = float(np.std(ac.restore(noise, filter)[BORDER]) / np.std(noise[BORDER]))
    return float(shares @ off), miss, stated, abs(miss) < TWO_SIDED_95 * stated, measured


def deviations(draws: int, seed: int) -> str:
    """Numbers after a filter over the posterior of a measurement: stated against drawn."""
    sensor = SENSORS["Gaussian .5 px"]
    rng = np.random.default_rng(seed)
    edges = [
        ac.measure_edge(ac.simulate.edge(
            sensor, shape=(80, 80), angle_deg=6, snr=100, orientation=one, rng=rng)[0])
        for one in ("across", "along")
    ]  # fmt: skip
    both = ac.combine(edges)
    filter = ac.design_restoration(both, noise_gain=2.0)
    after = Otf2d(FilteredOtf(both.otf.model, filter.kernel)).response(0.0)
    drawn: dict[str, list[float]] = {name: [] for name in ("mtf_nyquist", "rer", "fwhm_px",
                                                           "overshoot", "undershoot")}  # fmt: skip
    for _ in range(draws):
        z = rng.normal(size=after.esf.covariance_factor.shape[1])
        moved = shifted(after, z)
        for name, values in drawn.items():
            values.append(getattr(moved, name).value)
    rows = [
        [name, f"{getattr(after, name).value:.4f}", f"{np.mean(values):.4f}",
         f"{getattr(after, name).std:.4f}", f"{np.std(values):.4f}",
         f"{getattr(after, name).std / np.std(values):.2f}"]
        for name, values in drawn.items()
    ]  # fmt: skip
    head = ["number after", "stated", "mean of draws", "stated deviation", "scatter of draws",
            "ratio"]  # fmt: skip
    return table(head, rows)


def shifted(response, z):
    """The response with its errors drawn."""
    from acutance.curves import Esf, Lsf, Mtf, Response

    def bare(curve):
        return np.zeros((curve.value.size, 0))

    return Response(
        Esf(response.esf.distance_px, response.esf.value + response.esf.covariance_factor @ z,
            bare(response.esf)),
        Lsf(response.lsf.distance_px, response.lsf.value + response.lsf.covariance_factor @ z,
            bare(response.lsf)),
        Mtf(response.mtf.freq_cpp, response.mtf.otf + response.mtf.otf_factor @ z,
            bare(response.mtf) + 0j),
    )  # fmt: skip


def quickbird() -> str:
    """From the published curve at the published noise gain."""
    published_gain = 110.4 / 57.2

    def product(sigma: float) -> ac.Sensor:
        return ac.Sensor([Gaussian(sigma), Detector(), Resampling("cubic")])

    def excess(sigma: float) -> float:
        return product(sigma).mtf()(0.5).value - 0.1511

    sigma = float(brentq(excess, 0.05, 1.0))
    phases = (np.arange(400) + 0.5) / 400
    weights = interpolation_weight("cubic", np.arange(-2, 3)[:, None] - phases)
    own_gain = float(np.mean(np.sum(weights**2, axis=0)))
    raw = ac.Sensor([Gaussian(sigma), Detector()])
    rows = [["product by cubic convolution, published", ".1511", "1.394", "", "", "110"]]
    rows.append(quickbird_row("the same, as modelled here", product(sigma).response(), None, 1.0))
    rows.append(["MTF kernel, published", ".4746", "1.035", "1.93", "", "57"])
    for words, sensor, gain in (
        ("our kernel on the product", product(sigma), published_gain),
        ("our kernel instead of cubic convolution", raw, published_gain * own_gain),
    ):
        for desired in ("pixel", "point"):
            filter = ac.design_restoration(sensor, snr=110.4, noise_gain=gain, desired=desired)
            rows.append(
                quickbird_row(
                    f"{words}, desired {desired}", filter.after.across, filter, published_gain
                )
            )
    filter = ac.design_restoration(raw, snr=110.4, mtf_nyquist=0.4746, desired="point")
    rows.append(quickbird_row("instead of it, MTF .4746 asked, desired point", filter.after.across,
                              filter, filter.noise_gain / own_gain))  # fmt: skip
    text = (
        f"Cubic convolution itself has a noise gain of {own_gain:.3f} (mean over phases, both "
        f"directions): {published_gain:.2f} between the products is "
        f"{published_gain * own_gain:.2f} against the pixels as they were taken."
    )
    head = ["QuickBird, 15 September 2003", "MTF at Nyquist", "FWHM / px", "noise, to the product",
            "overshoot", "SNR"]  # fmt: skip
    return f"{table(head, rows)}\n\n{text}"


def quickbird_row(words, response, filter, gain):
    overshoot = response.overshoot.value
    return [
        words, f"{response.mtf_nyquist.value:.4f}"[1:], f"{response.fwhm_px.value:.3f}",
        "" if filter is None else f"{gain:.2f}", f"{100 * overshoot:.1f} %",
        f"{110.4 / gain:.0f}",
    ]  # fmt: skip


@dataclass(frozen=True)
class OffOtf:
    """A sensor's OTF, off by a share from a few hundredths of a cycle on, with that deviation."""

    sensor: SensorOtf
    share: float
    std: float
    band_cpp: float = 4.0

    def reach(self, u, v):
        return 1 - np.exp(-(u**2 + v**2) / 0.15**2)

    def otf(self, u, v):
        return self.sensor.otf(u, v) * (1 + self.share * self.reach(u, v))

    def factor(self, u, v):
        return (self.otf(u, v) * self.std * self.reach(u, v))[:, None] + 0j


def wrong_mtf() -> str:
    """Designs from an MTF that is 10 % too high or low; the truth is filtered."""
    rows = []
    for name, sensor in SENSORS.items():
        true = SensorOtf(sensor)
        for desired, asked in (("pixel", 0.03), ("point", 0.05)):
            for share in (0.1, -0.1):
                known = Otf2d(OffOtf(true, share, 0.1))
                filter = ac.design_restoration(known, overshoot=asked, desired=desired)
                restored = Otf2d(FilteredOtf(true, filter.kernel))
                found = worst_overshoot(tuple(restored.response(at) for at in (0.0, 90.0)))
                stated = filter.after.overshoot
                rows.append([
                    f"{name}, desired {desired}", f"{100 * share:+.0f} %", f"{100 * asked:.0f} %",
                    f"{100 * stated.interval()[1]:.1f} %", f"{100 * found:.1f} %",
                    f"{filter.noise_gain:.2f}",
                ])  # fmt: skip
    head = ["sensor", "MTF off by", "overshoot asked", "upper end of its interval",
            "overshoot of the true sensor", "noise gain"]  # fmt: skip
    return table(head, rows)


@contextmanager
def peak_memory() -> Iterator[Callable[[], float]]:
    """Largest memory of arrays within the block, in MB."""
    tracemalloc.start()
    try:
        yield lambda: tracemalloc.get_traced_memory()[1] / 1e6
    finally:
        tracemalloc.stop()


def other_programs(seed: int, size_px: int) -> str:
    """Mean squared error against truth, beside scikit-image at its best parameters."""
    try:
        from skimage import restoration as skimage
    except ImportError:
        return "scikit-image is not installed: no comparison was made."
    rows = []
    for name, sensor in SENSORS.items():
        psf = blur_of(sensor)
        for snr in (20.0, 60.0, 200.0):
            rows.append(compared(skimage, name, sensor, psf, snr, seed, size_px))
    head = [
        "sensor", "SNR", "not restored", "acutance 15 x 15", "acutance, natural scene",
        "wiener", "unsupervised_wiener", "richardson_lucy", "best linear of them / acutance",
        "time / s: acutance, wiener, unsupervised, Richardson-Lucy", "memory / MB: the same",
    ]  # fmt: skip
    return table(head, rows, texts=2)


def compared(skimage, name, sensor, psf, snr, seed, size_px) -> list[str]:
    shape = (size_px, size_px)
    image, _ = ac.simulate.landscape(sensor, shape=shape, snr=snr, rng=np.random.default_rng(seed))
    truth, _ = ac.simulate.landscape(IDEAL, shape=shape, rng=np.random.default_rng(seed))
    image, truth = image.astype(float), truth.astype(float)
    top = image.max()

    def error(found):
        return float(np.sqrt(np.mean((found - truth)[BORDER] ** 2)))

    def ours(scene):
        return ac.restore(image, ac.design_restoration(sensor, snr=snr, scene=scene))

    def wiener(balance):
        return skimage.wiener(image, psf, balance, clip=False)

    def unsupervised():
        return skimage.unsupervised_wiener(image / top, psf, clip=False, rng=1)[0] * top

    def lucy(turns):
        positive = np.maximum(psf, 0) / np.maximum(psf, 0).sum()
        bright = np.clip(image / top, 1e-6, None)
        return skimage.richardson_lucy(bright, positive, num_iter=turns, clip=False) * top

    balance = min(np.geomspace(1e-5, 10, 31), key=lambda one: error(wiener(one)))
    turns = min((1, 2, 3, 5, 8, 12, 20, 30, 50), key=lambda one: error(lucy(one)))
    own = ac.Image.from_array(image)
    runs = (lambda: ours(own), lambda: wiener(balance), unsupervised, lambda: lucy(turns))
    errors, seconds, memory = [], [], []
    for run in runs:
        start = time.process_time()
        errors.append(error(run()))
        seconds.append(time.process_time() - start)
        with peak_memory() as peak:
            run()
            memory.append(peak())
    natural = error(ours("natural"))
    best = min(errors[1:3])
    return [
        name, f"{snr:.0f}", f"{error(image):.2f}", f"**{errors[0]:.2f}**", f"{natural:.2f}",
        f"{errors[1]:.2f}", f"{errors[2]:.2f}", f"{errors[3]:.2f}",
        f"{(best / errors[0]) ** 2:.3f}",
        ", ".join(f"{one:.2f}" for one in seconds), ", ".join(f"{one:.0f}" for one in memory),
    ]  # fmt: skip


def blur_of(sensor: ac.Sensor, size: int = 31) -> np.ndarray:
    """The kernel that turns means of pixels into the image: what other programs ask for."""
    n = 128
    u, v = np.meshgrid(np.fft.fftfreq(n), np.fft.fftfreq(n))
    ratio = sensor.otf(u, v) / IDEAL.otf(u, v)
    whole = np.fft.fftshift(np.fft.ifft2(ratio).real)
    middle, half = n // 2, size // 2
    cut = whole[middle - half : middle + half + 1, middle - half : middle + half + 1]
    return np.asarray(cut / cut.sum())


APPLY = """
import sys, time
import acutance as ac
filter = ac.RestorationFilter.read(sys.argv[2])
wall, processor = time.perf_counter(), time.process_time()
ac.restore(sys.argv[1], filter, out=sys.argv[3])
with open("/proc/self/status") as status:
    (memory,) = [line.split()[1] for line in status if line.startswith("VmHWM")]
print(time.perf_counter() - wall, time.process_time() - processor, float(memory) / 1e3)
"""


def speed(seed: int, size_px: int) -> str:
    """A large file, beside the convolutions of SciPy in memory."""
    filter = ac.design_restoration(SENSORS["Gaussian .5 px"], snr=80, noise_gain=2.0)
    tile = np.random.default_rng(seed).normal(2000, 300, (500, 500))
    image = np.tile(tile, (size_px // 500, size_px // 500)).astype(np.uint16)
    ac.restore(image[:300, :300], filter)
    rows = []
    for run in (1, 2):
        with tempfile.TemporaryDirectory() as folder:
            source, kept, out = (str(Path(folder) / name) for name in ("a.tif", "f.json", "b.tif"))
            from acutance.raster import write_geotiff
            from acutance.report import json_text

            write_geotiff(source, image)
            Path(kept).write_text(json_text(filter.to_dict()))
            done = subprocess.run(
                [sys.executable, "-c", APPLY, source, kept, out], capture_output=True, text=True,
                check=True, env=dict(os.environ),
            )  # fmt: skip
        wall, processor, memory = map(float, done.stdout.split())
        rows.append([
            f"file to file (COG, deflate, overviews), run {run}", f"{wall:.1f}",
            f"{processor:.1f}", f"{memory:.0f}", "",
        ])  # fmt: skip
    single = image.astype(np.float32)
    kernel = filter.kernel.astype(np.float32)
    from acutance.numerics.convolution import convolve_inside

    part = slice(0, size_px // 5)
    timed = {
        "the convolution of acutance, in memory": (lambda: convolve_inside(single, kernel), 1),
        "scipy.signal.oaconvolve": (lambda: oaconvolve(single, kernel, mode="valid"), 1),
        "scipy.ndimage.convolve (a fifth, times 5)": (lambda: convolve(single[part], kernel), 5),
    }
    reference = 0.0
    for words, (run, times) in timed.items():
        wall, processor = time.perf_counter(), time.process_time()
        run()
        wall, processor = time.perf_counter() - wall, time.process_time() - processor
        reference = reference or times * processor
        rows.append([
            words, f"{times * wall:.1f}", f"{times * processor:.1f}", "",
            f"{times * processor / reference:.1f}",
        ])  # fmt: skip
    head = ["15 x 15 kernel", "wall / s", "processor / s", "memory / MB", "ratio of processor time"]
    return table(head, rows)


def main() -> None:
    parser = command(__doc__.partition("\n")[0], draws=16)
    parser.add_argument("--size", type=int, default=10000, help="rows of the large image")
    arguments: argparse.Namespace = parser.parse_args()
    draws, seed = arguments.draws, arguments.seed
    parts = [
        "## Measured again",
        f"{draws} scenes a row, each of four edges of 110 x 110 px (Gaussian .5 px), filtered and "
        "measured again; the weighted mean at Nyquist. Predicted: the edge before, times the "
        "filter's transfer. The measured noise gain is that of white noise.",
        measured_again(draws, seed),
        "## Deviations of the numbers after a filter",
        "Two edges of 80 x 80 px, SNR 100, combined; noise gain 2. 2000 sensors drawn from the "
        "measurement's covariance, each with the same kernel.",
        deviations(2000, seed),
        "## QuickBird",
        quickbird(),
        "## A wrong MTF",
        "The MTF is stated 10 % too high or too low from about 0.15 c/px on, with that deviation.",
        wrong_mtf(),
        "## Against the truth, beside scikit-image",
        "Landscapes of 400 x 400 px; root mean square error of grey levels against the same "
        "landscape as an ideal pixel sees it, 24 px from the border. scikit-image has the exact "
        "blur, and the balance and number of iterations that are best against the truth; acutance "
        "has neither, its scene's spectrum is measured in the image. The last but two: ratio of "
        "mean squared errors, above 1 where acutance errs less. Processor time at these "
        "parameters, of design and filter together; memory of arrays.",
        other_programs(seed + 2, 400),
        f"## Time and memory, {arguments.size} x {arguments.size} px of 16 bits",
        speed(seed, arguments.size),
    ]
    publish("Restoration", parts, arguments)


if __name__ == "__main__":
    main()
