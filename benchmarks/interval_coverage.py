"""How often the 95 % intervals of the method "spline" hold the truth.

Random edges: squares of 20 to 100 px, SNR 30 to 500, angles 2 to 43 degrees of either sign, all
orientations and polarities, random offsets; white noise, signal-dependent noise, and images
resampled by cubic convolution (truth: the resampled system's). The reference systems are those
the prior's scales were chosen over; the held-out systems were not looked at for that. Of a family
every edge has a sensor of its own, drawn at random. Obscured telescopes with little other blur are
the hardest found: their rings lie beyond the fine structure the prior allows for. Telescopes of
that family are compensated by kernels (-k, 1 + 2 k, -k) of both axes, too: where they are light
the LSF is much like one with a halo.
z is the error over its standard deviation: mean 0 and deviation 1 when all is right.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from trials import METRICS, Ranges, command, publish, random_edge, table, work_through

import acutance as ac
from acutance import optics

RANGES = Ranges(size_px=(20, 100), snr=(30.0, 500.0))
SCENES = {
    "white": "white noise",
    "signal-dependent": "signal-dependent noise",
    "resampled": "resampled by cubic convolution",
}


def held_out_systems() -> dict[str, ac.Sensor]:
    """Systems that had no part in choosing the prior."""
    pixel = optics.Detector()
    return {
        "sharp gaussian .25": ac.Sensor([optics.Gaussian(0.25), pixel]),
        "soft gaussian 1.0": ac.Sensor([optics.Gaussian(1.0), pixel]),
        "halo 6 % of 4 px": ac.Sensor([optics.Gaussian(0.4), optics.Halo(0.06, 4.0), pixel]),
        "smear 2 px": ac.Sensor(
            [optics.Gaussian(0.3), optics.Smear(2.0, "across"), optics.Smear(2.0, "along"), pixel]
        ),
        "strongly sharpened": ac.Sensor(
            [optics.Gaussian(0.7), pixel, optics.Sharpening.both_axes(0.8)]
        ),
        "diffraction .9": ac.Sensor([optics.Diffraction(0.9), pixel]),
        "generic sensor": ac.Sensor(
            [optics.Gaussian(0.39), pixel, optics.Smear(0.25, "along"), optics.Butterworth(1.4)]
        ),
        "jitter and TDI": ac.Sensor(
            [optics.Diffraction(1.4, 0.35), optics.Jitter(0.2), optics.Tdi(32, 0.02), pixel]
        ),
        "wavefront error": ac.Sensor(
            [optics.Diffraction(1.3, 0.3), optics.WavefrontError(0.1, 0.15, 1.3), pixel]
        ),
        "QuickBird-like": ac.Sensor(
            [
                optics.Diffraction(1.1, 0.25), optics.Gaussian(0.42), pixel,
                optics.ChargeDiffusion(0.5, 1.0), optics.Smear(0.5, "along"),
            ]
        ),
    }  # fmt: skip


def obscured_systems() -> dict[str, ac.Sensor]:
    """Annular apertures whose cutoff lies near one cycle per pixel, with little other blur."""
    shapes = [
        (1.0, 0.5, 0.0),
        (1.2, 0.4, 0.0),
        (0.8, 0.35, 0.3),
        (1.1, 0.3, 0.3),
        (1.5, 0.35, 0.35),
    ]
    found = {}
    for cutoff_cpp, obscuration, sigma_px in shapes:
        blur = [optics.Gaussian(sigma_px)] if sigma_px else []
        name = f"cutoff {cutoff_cpp:g}, obscuration {obscuration:g}, sigma {sigma_px:g}"
        aperture = optics.Diffraction(cutoff_cpp, obscuration)
        found[name] = ac.Sensor([aperture, *blur, optics.Detector()])
    return found


SYSTEMS = {
    "reference": ac.simulate.reference_systems(),
    "held-out": held_out_systems(),
    "obscured": obscured_systems(),
}
STRENGTHS = {
    f"k = {low:g} to {high:g}": (low, high)
    for low, high in ((0.05, 0.1), (0.1, 0.2), (0.2, 0.4), (0.4, 0.8))
}
NAMES = {group: list(systems) for group, systems in SYSTEMS.items()}
NAMES["families"] = list(optics.FAMILIES)
NAMES["compensated"] = list(STRENGTHS)
TITLES = {
    "reference": "Reference systems", "held-out": "Held-out systems",
    "obscured": "Obscured systems", "families": "Families of sensors",
    "compensated": "Telescopes compensated by kernels of one strength",
}  # fmt: skip


@dataclass(frozen=True)
class Draw:
    """One random edge, of a system or of a sensor that is drawn as well."""

    group: str
    system: str
    scene: str
    seed: tuple[int, ...]

    def sensor(self, rng: np.random.Generator) -> ac.Sensor:
        """The system of that name, or one of such sensors."""
        if self.group == "families":
            return optics.draw_sensor(self.system, rng)
        if self.group == "compensated":
            kernel = optics.Sharpening.both_axes(rng.uniform(*STRENGTHS[self.system]))
            return ac.Sensor([*optics.draw_sensor("telescope", rng).blocks, kernel])
        return SYSTEMS[self.group][self.system]


def standard_errors(job: Draw) -> tuple[list[float], bool] | str:
    """z of every metric and whether all checks passed; or the name of the refusal."""
    rng = np.random.default_rng(job.seed)
    image, truth = random_edge(rng, job.sensor(rng), RANGES, job.scene)
    try:
        found = ac.measure_edge(image)
    except ac.AcutanceError as error:
        return type(error).__name__
    z = []
    for metric in METRICS.values():
        estimate = metric(found.response)
        z.append((estimate.value - metric(truth.response).value) / estimate.std)
    return z, all(check.passed for check in found.checks)


def row(name: str, results: list) -> list[str]:
    """Coverage, mean and deviation of z for every metric."""
    measured = [result for result in results if not isinstance(result, str)]
    z = np.array([numbers for numbers, _ in measured]).reshape(-1, len(METRICS))
    cells = []
    for column in z.T:
        inside = 100 * np.mean(np.abs(column) < 1.959964)
        cells.append(f"{inside:.1f} ({column.mean():+.2f} ± {column.std():.2f})")
    far = np.mean(np.abs(z).max(axis=1) > 3)
    trusted = np.mean([passed for _, passed in measured])
    refused = len(results) - len(measured)
    share = f"{100 * far:.1f}", f"{100 * trusted:.0f}", f"{refused}"
    return [name, f"{len(results)}", *cells, *share]


def main() -> None:
    arguments = command(__doc__.partition("\n")[0], draws=300).parse_args()
    parts = [
        "Cells: per cent of the intervals that hold the truth (mean z ± deviation of z). "
        "Far off: images where any of the four metrics has |z| > 3. Checks: images where all "
        "target checks passed, per cent. Counting alone scatters a row by "
        f"± {100 * np.sqrt(0.95 * 0.05 / arguments.draws):.1f} points a row."
    ]
    groups = [("reference", scene) for scene in SCENES] + [
        ("held-out", "white"),
        ("families", "white"),
        ("obscured", "white"),
        ("compensated", "white"),
    ]
    for group_number, (group, scene) in enumerate(groups):
        names = NAMES[group]
        jobs = [
            Draw(group, name, scene, (arguments.seed, group_number, number, draw))
            for number, name in enumerate(names)
            for draw in range(arguments.draws)
        ]
        results = work_through(standard_errors, jobs, arguments.processes, f"{group}, {scene}")
        rows = [
            row(name, [r for job, r in zip(jobs, results, strict=True) if job.system == name])
            for name in names
        ]
        rows.append(row("**pooled**", results))
        head = ["system", "draws", *METRICS, "far off / %", "checks / %", "refused"]
        parts += [f"## {TITLES[group]}, {SCENES[scene]}", table(head, rows)]
    publish("Coverage of the 95 % intervals", parts, arguments)


if __name__ == "__main__":
    main()
