"""A measurement made from closed forms: Gaussian blur of 0.4 px seen through a unit pixel."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from datetime import UTC, datetime

import numpy as np
import pytest
from scipy.special import erf

from acutance import optics
from acutance.curves import Esf, Estimate, Lsf, Mtf, Otf2d, Response
from acutance.geometry.line import Line
from acutance.targets import Check, ImageInfo, Measurement, Rejected, TargetResult
from acutance.targets.check import answer
from acutance.targets.straight import StraightMeasurement
from acutance.targets.straight.many_edges import combine_edges
from acutance.targets.straight.straight_measurement import StraightDetails

DISTANCE_PX = np.linspace(-8.0, 8.0, 641)
FREQ_CPP = np.linspace(0.0, 1.0, 101)

CHECKS = (
    answer("contrast_snr", 104.2, "bright minus dark is 104 times the noise", {}),
    answer("angle_deg", 6.02, "inclined by 6.02 degrees", {}),
    answer("rows", 40.0, "40 rows", {}),
    answer("sample_phases", 9.0, "9 different sub-pixel positions", {}),
    answer("blur_uniformity", 0.08, "from part to part the blur changes by 8 %", {}),
    answer("straightness_px", 0.04, "scatters by 0.04 px about the line", {}),
)
MEASURED_AT = datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC)


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
) -> StraightMeasurement:
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
    return StraightMeasurement(
        kind="edge",
        method=method,
        transfer=response,
        snr=104.2,
        checks=checks,
        image=ImageInfo(path, 1, roi, pixel_gsd_m=None if gsd_m is None else (gsd_m, gsd_m)),
        options={"rer_centre": "half", "robust": False, "limits": {"contrast_snr": 50.0}},
        line=line,
        dark=dark,
        bright=bright,
        details=StraightDetails(
            image, used, distance[used], (truth + residual)[used], residual[used]
        ),
        measured_at=MEASURED_AT,
    )


def pulse_measurement(
    width_px: float = 3.153, width_std: float = 0.005, method: str = "spline", checks: int = 18
) -> StraightMeasurement:
    """A pulse: the edge of `edge_measurement` minus another one `width_px` behind it."""
    edge = edge_measurement(method=method)
    details, esf = edge.details, edge.esf
    fitted = np.interp(details.distance_px, DISTANCE_PX, esf.value) - np.interp(
        details.distance_px - width_px, DISTANCE_PX, esf.value
    )
    return replace(
        edge,
        kind="pulse",
        details=replace(details, value=fitted + details.residual),
        checks=tuple(Check(f"check_{i:02d}", 1.0, ">=", 1.0, True, "fine") for i in range(checks)),
        width_px=Estimate(width_px, width_std),
    )


SENSOR = optics.Sensor([optics.Gaussian(0.4, 0.5), optics.Detector(), optics.Smear(0.7, "along")])


@dataclass(frozen=True)
class Blurred:
    """A sensor whose blur is uncertain by one latent variable."""

    band_cpp: float = 4.0

    def otf(self, u_cpp, v_cpp):
        return np.asarray(SENSOR.otf(u_cpp, v_cpp), complex)

    def factor(self, u_cpp, v_cpp):
        return (-0.02 * (u_cpp**2 + v_cpp**2) * self.otf(u_cpp, v_cpp))[:, None]


@pytest.fixture(scope="session")
def both() -> Measurement:
    """A measurement in two directions, of a kind that no table knows."""
    return Measurement(
        kind="lamps",
        method="psf-fit",
        transfer=Otf2d(Blurred(), (0.72, 0.7)),
        snr=80.0,
        checks=(
            answer("sources", 20.0, "20 sources", {}),
            answer("spacing_px", 3.2, "sources stand 3.2 px apart", {}),
        ),
        image=ImageInfo("lamps.tif", 2, (10, 20, 30, 40), pixel_gsd_m=(0.72, 0.7)),
        measured_at=MEASURED_AT,
    )


@pytest.fixture(scope="session")
def make_pulse():
    """The builder of pulses, for another width."""
    return pulse_measurement


@pytest.fixture(scope="session")
def pulse() -> StraightMeasurement:
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
def compared() -> list[StraightMeasurement]:
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
def measurement() -> StraightMeasurement:
    return edge_measurement()


@pytest.fixture(scope="session")
def vague_measurement() -> StraightMeasurement:
    """So sharp that the MTF never falls to 0.3, without GSD, path or checks, plateaus unknown."""
    sharp = edge_measurement(gsd_m=None, path=None, checks=())
    freq = FREQ_CPP
    mtf = Mtf(freq, (0.6 + 0.4 * (1 - freq)).astype(complex), sharp.mtf.factor)
    return replace(sharp, transfer=replace(sharp.response, mtf=mtf), snr=math.nan)
