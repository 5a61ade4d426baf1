"""A measurement made from closed forms: Gaussian blur of 0.4 px seen through a unit pixel."""

from __future__ import annotations

import math
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest
from scipy.special import erf

from acutance.curves import Esf, Estimate, Lsf, Mtf, Response
from acutance.geometry.line import Line
from acutance.targets.measurement import Check, ImageInfo, Measurement, Samples
from acutance.targets.straight import Rejected, TargetResult
from acutance.targets.straight.many_edges import combine_edges

DISTANCE_PX = np.linspace(-8.0, 8.0, 641)
FREQ_CPP = np.linspace(0.0, 1.0, 101)

CHECKS = (
    Check("contrast_snr", 104.2, ">= 50", True, "Contrast over noise (KOMPSAT-3 draft, step 2)."),
    Check("angle_deg", 6.02, "1 .. 30", True, "Inclination to the grid (KOMPSAT-3 draft, step 3)."),
    Check("edge_rows", 40.0, ">= 20", True, "Rows the edge crosses (KOMPSAT-3 draft, step 4)."),
    Check("phases", 9.0, ">= 4", True, "Different sub-pixel positions of the samples."),
    Check(
        "plateau_px",
        2.0,
        ">= 3",
        False,
        "The bright plateau is 2.0 px wide, at least 3 px are needed: use a wider region.",
    ),
    Check("straightness_px", 0.04, "<= 0.1", True, "Scatter of the row positions about the line."),
)


def closed_form(sigma_px: float, columns: int = 4, scatter: float = 0.0, gsd_m=None) -> Response:
    """Gaussian of `sigma_px` times a unit pixel, with a smooth random covariance factor."""

    def primitive(x):
        z = x / (sigma_px * math.sqrt(2))
        return x * 0.5 * (1 + erf(z)) + sigma_px / math.sqrt(2 * math.pi) * np.exp(-(z**2))

    def ramp(x):
        return 0.5 * (1 + erf(x / (sigma_px * math.sqrt(2))))

    esf = primitive(DISTANCE_PX + 0.5) - primitive(DISTANCE_PX - 0.5)
    lsf = ramp(DISTANCE_PX + 0.5) - ramp(DISTANCE_PX - 0.5)
    otf = np.exp(-2 * (np.pi * sigma_px * FREQ_CPP) ** 2) * np.sinc(FREQ_CPP)
    rng = np.random.default_rng(7)
    step = DISTANCE_PX[1] - DISTANCE_PX[0]
    phase = rng.uniform(0, np.pi, columns)
    waves = np.cos(np.outer(DISTANCE_PX, np.arange(columns)) + phase)
    modes = np.exp(-((DISTANCE_PX / 1.2) ** 2))[:, None] * waves
    modes = modes - modes.mean(axis=0)
    lsf_factor = scatter * modes
    kernel = np.exp(-2j * np.pi * np.outer(FREQ_CPP, DISTANCE_PX)) * step
    transfer = kernel @ lsf_factor
    return Response(
        Esf(DISTANCE_PX, esf, np.cumsum(lsf_factor, axis=0) * step),
        Lsf(DISTANCE_PX, lsf, lsf_factor),
        Mtf(FREQ_CPP, otf.astype(complex), transfer - transfer[0]),
        gsd_m=gsd_m,
    )


def edge_measurement(
    *,
    sigma_px: float = 0.4,
    scatter: float = 0.004,
    normal_deg: float = 6.02,
    method: str = "spline",
    gsd_m: float | None = 0.7,
    checks: tuple[Check, ...] = CHECKS,
    path: str | None = "scene.tif",
    roi: tuple[int, int, int, int] = (100, 260, 40, 36),
) -> Measurement:
    """An edge as a measurement would return it, its pixels drawn from the same closed form."""
    rng = np.random.default_rng(11)
    top, left, height, width = roi
    response = closed_form(sigma_px, scatter=scatter, gsd_m=gsd_m)
    middle_row, middle_col = top + (height - 1) / 2, left + (width - 1) / 2 + 0.3
    line = Line(middle_row, middle_col, normal_deg, 0.006, 0.004, float(height))
    rows, cols = np.mgrid[top : top + height, left : left + width]
    distance = line.normal_distance(rows, cols)
    truth = np.interp(distance, DISTANCE_PX, response.esf.value)
    residual = rng.normal(0.0, 0.0096, distance.shape)
    dark, bright = 203.0, 1208.0
    image = dark + (bright - dark) * (truth + residual)
    used = np.abs(distance) < 10.0
    image[0, 0] = np.nan
    used[0, 0] = False
    return Measurement(
        kind="edge",
        method=method,
        line=line,
        response=response,
        samples=Samples(
            image,
            used,
            distance[used],
            (truth + residual)[used],
            residual[used],
            dark,
            bright,
        ),
        snr=104.2,
        checks=checks,
        image=ImageInfo(path, 1, gsd_m, roi, None),
        options={"rer_centre": "half", "robust": False, "limits": {"contrast_snr": 50.0}},
        measured_at=datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC),
    )


def pulse_measurement(
    width_px: float = 3.153, width_std: float = 0.005, method: str = "spline", checks: int = 18
) -> Measurement:
    """A pulse: the edge of `edge_measurement` less another one `width_px` behind it."""
    edge = edge_measurement(method=method)
    samples, esf = edge.samples, edge.esf
    fitted = np.interp(samples.distance_px, DISTANCE_PX, esf.value) - np.interp(
        samples.distance_px - width_px, DISTANCE_PX, esf.value
    )
    return replace(
        edge,
        kind="pulse",
        samples=replace(samples, value=fitted + samples.residual),
        checks=tuple(Check(f"check_{i:02d}", 1.0, ">= 1", True, "fine") for i in range(checks)),
        width_px=Estimate(width_px, width_std),
    )


@pytest.fixture(scope="session")
def make_pulse():
    """The builder of pulses, for another width."""
    return pulse_measurement


@pytest.fixture(scope="session")
def pulse() -> Measurement:
    return pulse_measurement()


@pytest.fixture(scope="session")
def target() -> TargetResult:
    """Two edges across and two along, as the search for all edges of a target returns them."""
    edges = (
        edge_measurement(roi=(0, 0, 40, 36)),
        edge_measurement(roi=(0, 50, 40, 36), sigma_px=0.41, normal_deg=-174.0),
        edge_measurement(roi=(50, 0, 36, 40), normal_deg=96.0),
        edge_measurement(roi=(50, 50, 36, 36), normal_deg=-84.0, sigma_px=0.45),
    )
    rejected = (Rejected("phases", "<aligned> with the grid", {"row": 3.0}),)
    return TargetResult(edges, rejected, combine_edges(edges))


@pytest.fixture(scope="session")
def compared() -> list[Measurement]:
    return [
        edge_measurement(),
        edge_measurement(sigma_px=0.42, method="sdsu-2005"),
        edge_measurement(sigma_px=0.38, method="iso12233"),
    ]


@pytest.fixture(scope="session")
def truth() -> Response:
    return closed_form(0.4, columns=0)


@pytest.fixture(scope="session")
def make_edge():
    """The builder itself, for edges of another shape."""
    return edge_measurement


@pytest.fixture(scope="session")
def measurement() -> Measurement:
    return edge_measurement()


@pytest.fixture(scope="session")
def vague_measurement() -> Measurement:
    """So sharp that the MTF never falls to 0.3, without GSD, path or checks, plateaus unknown."""
    sharp = edge_measurement(gsd_m=None, path=None, checks=())
    freq = FREQ_CPP
    mtf = Mtf(freq, (0.6 + 0.4 * (1 - freq)).astype(complex), sharp.mtf.factor)
    return replace(sharp, response=replace(sharp.response, mtf=mtf), snr=math.nan)
