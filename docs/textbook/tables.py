"""Tables made from the code."""

from __future__ import annotations

import inspect
import math
import textwrap
from collections.abc import Callable

import numpy as np

import acutance as ac
from acutance import optics, simulate
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.targets import QUESTIONS, Question
from acutance.targets.combine.checks import COMBINE_CHECKS
from acutance.targets.pair.checks import PAIR_CHECKS
from acutance.targets.periodic.bars_checks import BARS_CHECKS
from acutance.targets.periodic.star_checks import STAR_CHECKS
from acutance.targets.points.checks import POINTS_CHECKS
from acutance.targets.straight import METHODS
from acutance.targets.straight.edge_checks import EDGE_CHECKS
from acutance.targets.straight.published import PUBLISHED
from acutance.targets.straight.pulse_checks import PULSE_CHECKS
from textbook.rst import list_table

__all__ = [
    "blocks",
    "checks",
    "closed_forms",
    "methods",
    "phase_error",
    "phases",
    "questions",
    "questions_of",
    "row_distances",
    "sites",
    "slices",
    "systems",
]

# Formulas of the blocks; f is the radial frequency.
FORMULAS = {
    "Aberrations": r"P e^{2\pi i W} \star P e^{2\pi i W} \text{ (annular pupil)}",
    "Aerosol": r"e^{-t (f/f_a)^2} \ (f < f_a), \quad e^{-t} \ (f \ge f_a)",
    "Butterworth": r"\frac{1}{1 + (f/D_0)^2}",
    "ChargeDiffusion": r"\frac{\cosh(d/L)}{\cosh\left(d \sqrt{(2\pi f)^2 + 1/L^2}\right)}",
    "Defocus": r"\frac{4}{\pi (1-\epsilon^2)} \int_0^X \left(\sqrt{1-(x+\nu)^2}"
    r" - \sqrt{\epsilon^2-(x-\nu)^2}\right) \cos(8\pi W \nu x) \, dx, \quad \nu = f/f_c",
    "Detector": r"\mathrm{sinc}(w u) \, \mathrm{sinc}(h v)",
    "Diffraction": r"P \star P \text{ (annular pupil)}, \quad 0 \ (f \ge f_c)",
    "Exponential": r"\frac{1}{1 + 2\pi i f L}",
    "ExponentialHalo": r"(1 - a) + a \left(1 + (2\pi d f)^2\right)^{-3/2}",
    "Gaussian": r"e^{-2\pi^2 (\sigma_x^2 u^2 + \sigma_y^2 v^2)}",
    "Halo": r"(1 - a) + a \, e^{-2\pi^2\sigma^2 f^2}",
    "Jitter": r"e^{-2\pi^2 \sigma^2 f^2}",
    "RasterPsf": r"\sum_k p_k \, e^{-2\pi i (u x_k + v y_k)}",
    "Resampling": r"\hat k(u) \, \hat k(v)",
    "Rescaled": r"H(u/s, \, v/s)",
    "Sharpening": r"\frac{\sum k_{ij} e^{-2\pi i (v i + u j)}}{\sum k_{ij}}",
    "Shift": r"\sum_k w(k - d) \, e^{2\pi i u (k - d)} \text{, in both axes}",
    "Smear": r"\mathrm{sinc}(\ell f)",
    "Tdi": r"\frac{\sin(N x)}{N \sin(x)} \, \mathrm{sinc}(v / p), \quad x = \pi \, d \cdot (u, v)",
    "Turbulence": r"e^{-3.44 (f/f_0)^{5/3}}",
    "WavefrontError": r"e^{-(2\pi w)^2 \left(1 - e^{-(f / (l f_c))^2}\right)}",
}

CHECKS_BY_KIND = {
    "edge": EDGE_CHECKS,
    "pulse": PULSE_CHECKS,
    "points": POINTS_CHECKS,
    "biresolution": PAIR_CHECKS,
    "bars": BARS_CHECKS,
    "star": STAR_CHECKS,
    "combined": COMBINE_CHECKS,
}

_NOT_BLOCKS = ("Block", "Sensor")


def _summary(found: object) -> str:
    """The first sentence of a docstring."""
    first = (inspect.getdoc(found) or "").split("\n\n")[0].replace("\n", " ")
    return first.split(": ``")[0].rstrip(".:") + "."


def closed_forms() -> str:
    """Gaussian through a unit pixel along a grid axis; two ways of computing it agree."""
    rows = []
    worst = 0.0
    for sigma in (0.2, 0.3, 0.4, 0.5, 0.6, 0.7):
        truth = ac.Sensor([optics.Gaussian(sigma), optics.Detector()]).response()
        blur = GaussianPixel(sigma)
        ends = blur.esf(np.array([-0.5, 0.5]))
        worst = max(
            worst,
            abs(truth.rer.value - float(ends[1] - ends[0])),
            float(np.max(np.abs(truth.mtf.value - np.abs(blur.otf(truth.mtf.freq_cpp))))),
        )
        numbers = (
            truth.mtf(0.25), truth.mtf_nyquist, truth.rer, truth.fwhm_px,
            truth.edge_slope_per_px, truth.half_extent_bright_px,
        )  # fmt: skip
        rows.append([f"{sigma:g}", *(f"{number.value:.4f}" for number in numbers)])
    head = ["σ, px", "M(0.25)", "M(0.5)", "RER", "FWHM, px", "slope 40-60 %, 1/px",
            "half extent 50-95 %, px"]  # fmt: skip
    return list_table(head, rows) + (
        f"\nThe values are those of `acutance.optics`; the closed forms of MTF and RER differ from "
        f"them by {_power(worst)} at most.\n"
    )


def _power(value: float) -> str:
    """An upper bound in words: "less than 1e-7"."""
    return f"less than 1e{math.floor(math.log10(max(value, 1e-16))) + 1}"


def slices() -> str:
    """The OTF along the normal against the one along the axis, for a square pixel."""
    detector = optics.Detector()
    rows = []
    for angle in (2.0, 6.0, 10.0, 14.0, 20.0, 30.0, 45.0):
        t = math.radians(angle)
        along = float(detector.otf(np.array(0.5 * math.cos(t)), np.array(0.5 * math.sin(t))))
        straight = float(detector.otf(np.array(0.5), np.array(0.0)))
        rows.append([f"{angle:g}°", f"{along:.4f}", f"{100 * (along / straight - 1):+.2f} %"])
    return list_table(["angle", "M(0.5) along the normal", "against M(0.5) along the axis"], rows)


def phases() -> str:
    """Spacing of the samples along the normal where tan(angle) is a ratio of small integers."""
    rows = []
    for p, q in ((1, 1), (1, 2), (1, 3), (1, 4), (1, 5), (1, 8), (1, 10)):
        rows.append(
            [f"{p}/{q}", f"{math.degrees(math.atan(p / q)):.3f}°", f"{1 / math.hypot(p, q):.3f}"]
        )
    return list_table(["tan(angle)", "angle", "spacing of samples, px"], rows)


def phase_error() -> str:
    """What the message about a nearly aligned edge reads like."""
    image, _ = simulate.edge(
        simulate.reference_systems()["gaussian"], angle_deg=0.4, shape=(40, 40)
    )
    try:
        ac.measure_edge(image)
    except ac.PhaseError as error:
        return "\n".join(textwrap.wrap(str(error), 88)) + "\n"
    raise RuntimeError("an edge at 0.4 degrees over 40 rows was not refused")


def row_distances() -> str:
    """MTF at Nyquist when row distances stand for normal ones, 20 degrees."""
    cosine = math.cos(math.radians(20.0))
    kinds = {
        "row distance, no cosine": 1 / cosine,
        "row distance divided by the cosine": 1 / cosine**2,
        "normal distance multiplied by it once more": cosine,
    }
    rows = []
    for name, stretch in kinds.items():
        changes = []
        for sigma in (0.4, 0.5, 0.6):
            sensor = ac.Sensor([optics.Gaussian(sigma), optics.Detector()])
            seen, true = sensor.otf(0.5 * stretch, 0.0), sensor.otf(0.5, 0.0)
            changes.append(f"{100 * (float(seen / true) - 1):+.0f} %")
        rows.append([name, *changes])
    return list_table(
        ["distance", "σ = 0.4 px", "σ = 0.5 px", "σ = 0.6 px"], rows, (46, 18, 18, 18)
    )


def checks() -> str:
    """The checks of an edge, with what each finds on a simulated one."""
    sensor = simulate.reference_systems()["gaussian"]
    image, _ = simulate.edge(sensor, shape=(60, 40), snr=100, rng=np.random.default_rng(3))
    by_rows = {c.name: c.asked for c in ac.measure_edge(image, method="kompsat-2014").checks}
    rows = []
    for check in ac.measure_edge(image).checks:
        limit = check.asked
        if by_rows.get(check.name, limit) != limit:
            limit += f" ({by_rows[check.name]} row by row)"
        rows.append([f"``{check.name}``", limit, check.question, check.message])
    head = ["check", "limit", "question", "what it finds on a simulated edge"]
    return list_table(head, rows, (18, 12, 30, 40))


def questions_of(kind: str) -> Callable[[], str]:
    """A text: what a kind of target is asked, with the limits."""
    return lambda: list_table(
        ["check", "limit", "question"],
        [
            [f"``{name}``", _limit(QUESTIONS[name]), QUESTIONS[name].question]
            for name in CHECKS_BY_KIND[kind]
        ],
        (25, 12, 63),
    )


def questions() -> str:
    """The whole table of checks, with the kinds of target that are asked each of them."""
    rows = []
    for name, asked in QUESTIONS.items():
        kinds = ", ".join(kind for kind, names in CHECKS_BY_KIND.items() if name in names)
        source = f" Source: {asked.source}." if asked.source else ""
        advice = f"{asked.advice[0].upper()}{asked.advice[1:]}.{source}"
        rows.append([f"``{name}``", kinds, _limit(asked), asked.question, asked.severity, advice])
    head = ["check", "asked of", "limit", "question", "severity", "if it fails"]
    return list_table(head, rows, (18, 12, 9, 22, 8, 31))


def _limit(asked: Question) -> str:
    return f"{asked.sense} {asked.limit:g}"


def methods() -> str:
    """Methods by name."""
    rows = [
        [
            "``spline``",
            "The reference estimator: see `acutance.targets.straight.fit_edge.fit_edge`.",
        ]
    ]
    for name in METHODS:
        if name in PUBLISHED:
            method = PUBLISHED[name]
            link = f":py:func:`acutance.targets.straight.published.{method.__name__}`"
            rows.append([f"``{name}``", f"{_summary(method)} See {link}."])
    return list_table(["name", "what it is"], rows, (20, 80))


def blocks() -> str:
    """All OTF blocks with their formulas."""
    rows = []
    for name in optics.__all__:
        found = getattr(optics, name)
        if inspect.isclass(found) and hasattr(found, "otf") and name not in _NOT_BLOCKS:
            link = f":py:class:`~acutance.optics.{name}`"
            rows.append([link, _formula(name), _summary(found)])
    return list_table(["block", "OTF", "what it is"], rows, (18, 40, 42))


def _formula(name: str) -> str:
    """The formula of a block, where it has been typeset."""
    if name in FORMULAS:
        return f":math:`{FORMULAS[name]}`"
    return "see its page"


def systems() -> str:
    """The reference systems with their true numbers."""
    rows = []
    for name, sensor in simulate.reference_systems().items():
        truth = sensor.response()
        made_of = ", ".join(type(block).__name__ for block in sensor.blocks)
        numbers = (truth.mtf_nyquist, truth.rer, truth.fwhm_px, truth.overshoot)
        rows.append([name, made_of, *(f"{number.value:.4f}" for number in numbers)])
    head = ["name", "blocks", "MTF at Nyquist", "RER", "FWHM, px", "overshoot"]
    return list_table(head, rows, (14, 38, 12, 12, 12, 12))


def sites() -> str:
    """The catalogue."""
    rows = []
    for site in ac.sites():
        place = "not published"
        if site.latitude_deg is not None and site.longitude_deg is not None:
            place = f"{site.latitude_deg:.4f}, {site.longitude_deg:.4f}"
        size = f"{site.panel_size_m:g}" + ("" if site.size_m is None else f" of {site.size_m:g}")
        angles = ", ".join(f"{angle:g}°" for angle in site.orientation_deg) or "not given"
        rows.append([f"``{site.name}``", site.title, place, size, angles, site.notes])
    head = [
        "name",
        "place",
        "latitude, longitude",
        "panel of target, m",
        "edges from north",
        "notes",
    ]
    source = next(iter(ac.sites())).source
    return list_table(head, rows, (16, 17, 13, 11, 11, 32)) + f"\nSource: {source}\n"
