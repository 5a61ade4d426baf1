"""What a measurement is: the curves, the evidence they rest on, and the checks."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Estimate, HasResponse, Response
from acutance.curves.grid import Floats
from acutance.curves.one_line import OneLine
from acutance.geometry.line import Line, Orientation
from acutance.raster.image import AlongTrack
from acutance.targets.slices import PlaneSlices

__all__ = ["Check", "ImageInfo", "Measurement", "Samples", "count_failed"]

SCHEMA = "acutance/measurement/1"


@dataclass(frozen=True)
class Check:
    """One question asked of the target, with what was found and what is asked.

    Parameters
    ----------
    name : str
    value : float
        What was found.
    limit : str
        What is asked, as text: ``">= 50"``.
    passed : bool
    message : str
        What it means and what to do; with where the limit comes from.
    """

    name: str
    value: float
    limit: str
    passed: bool
    message: str

    def to_dict(self) -> dict[str, Any]:
        value = self.value if math.isfinite(self.value) else None
        return {
            "name": self.name,
            "value": value,
            "limit": self.limit,
            "passed": self.passed,
            "message": self.message,
        }


def count_failed(checks: Sequence[Check]) -> str:
    """ "2 of 17 checks failed (rows, profile)"."""
    failed = [check.name for check in checks if not check.passed]
    names = f" ({', '.join(failed)})" if failed else ""
    return f"{len(failed)} of {len(checks)} checks failed{names}"


@dataclass(frozen=True)
class ImageInfo:
    """Where the pixels came from.

    `roi` is (row, col, height, width) of the cut, in pixels of the whole image; `along_track` the
    axis the satellite flew along. `gsd_m` is the GSD along the normal of a straight target, along
    the rows of any other; `pixel_gsd_m` that between rows and that between columns.
    """

    path: str | None = None
    band: int = 1
    gsd_m: float | None = None
    roi: tuple[int, int, int, int] = (0, 0, 0, 0)
    crs: str | None = None
    along_track: AlongTrack = "y"
    pixel_gsd_m: tuple[float, float] | None = None

    def to_dict(self) -> dict[str, Any]:
        return {
            "path": self.path,
            "band": self.band,
            "gsd_m": self.gsd_m,
            "pixel_gsd_m": None if self.pixel_gsd_m is None else list(self.pixel_gsd_m),
            "roi": list(self.roi),
            "crs": self.crs,
            "along_track": self.along_track,
        }


@dataclass(frozen=True, eq=False)
class Samples(OneLine):
    """The pixels a measurement used, seen along the normal: evidence for figures.

    Parameters
    ----------
    image : (rows, cols) array
        The cut; unusable pixels are NaN.
    used : (rows, cols) bool array
        Which pixels entered the fit.
    distance_px : (n,) array
        Normal distance of the used pixels, in row-major order; 0 at the 50 % point.
    value : (n,) array
        Their edge response, normalised to 0 (dark plateau) .. 1 (bright plateau).
    residual : (n,) array
        Value less the fitted ESF, same scale.
    dark, bright : float
        Plateau levels in the image's units.
    """

    image: Floats
    used: NDArray[np.bool_]
    distance_px: Floats
    value: Floats
    residual: Floats
    dark: float
    bright: float


@dataclass(frozen=True, eq=False)
class Measurement(HasResponse):
    """A measurement of one straight target: numbers, curves, evidence and checks.

    The numbers (`mtf_nyquist`, `rer`, `fwhm_px` ...) are those of `response`.

    Parameters
    ----------
    kind : str
        The target: "edge" or "pulse".
    method : str
        The estimator.
    line : Line
        The edge, or the rising side of a pulse, in pixels of the whole image.
    response : Response
        The curves and their metrics.
    samples : Samples
        The pixels used, as evidence.
    snr : float
        Contrast over the mean standard deviation of the plateaus.
    checks : sequence of Check
        What was asked of the target.
    image : ImageInfo
        Where the pixels came from.
    options : dict
        The options of the measurement.
    width_px : Estimate, optional
        Width of a pulse along the normal.
    prf_fwhm_px : Estimate, optional
        Width of the pulse response function at half of its maximum, along the normal.
    stated_width_px : float, optional
        Width of a pulse as it was stated; ``None`` where it was guessed from the image.
    measured_at : datetime
        When (UTC).
    """

    kind: str
    method: str
    line: Line
    response: Response
    samples: Samples
    snr: float
    checks: Sequence[Check] = ()
    image: ImageInfo = ImageInfo()
    options: Mapping[str, Any] = field(default_factory=dict)
    width_px: Estimate | None = None
    prf_fwhm_px: Estimate | None = None
    stated_width_px: float | None = None
    measured_at: datetime = field(default_factory=lambda: datetime.now(UTC))

    @property
    def orientation(self) -> Orientation:
        """Which direction the MTF belongs to: across or along track."""
        if self.image.along_track == "y":
            return self.line.orientation
        return "along" if self.line.orientation == "across" else "across"

    @property
    def fwhm_m(self) -> Estimate | None:
        """The same in metres; ``None`` without a GSD."""
        return self.response.fwhm_m

    @property
    def angle_deg(self) -> Estimate:
        """Acute angle between the edge and the nearer image axis."""
        return Estimate(self.line.angle_deg, self.line.angle_std_deg)

    @property
    def trusted(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)

    @property
    def failed_checks(self) -> tuple[Check, ...]:
        """The checks that did not pass."""
        return tuple(check for check in self.checks if not check.passed)

    def in_words(self) -> str:
        """Target, method and direction, the main numbers, and how many checks failed."""
        width = "" if self.width_px is None else f"width_px {self.width_px}, "
        return (
            f"{self.kind} by {self.method}, {self.orientation}, {width}"
            f"{self.response.in_words()}, snr {self.snr:.3g}, {count_failed(self.checks)}"
        )

    @property
    def slices(self) -> PlaneSlices:
        """The slice of the 2-D OTF along the normal, with its covariance."""
        return PlaneSlices.of_curve(self.mtf, self.line.normal_deg)

    def metrics(self) -> dict[str, Estimate]:
        """All numbers by name."""
        return self.response.metrics()

    def pulse_numbers(self) -> dict[str, Estimate]:
        """What only a pulse has, by name: its width and that of its response; metres by a GSD."""
        gsd_m = self.response.gsd_m
        found: dict[str, Estimate] = {}
        for name, number in (("width", self.width_px), ("prf_fwhm", self.prf_fwhm_px)):
            if number is not None:
                found[f"{name}_px"] = number
                if gsd_m is not None:
                    found[f"{name}_m"] = number.scaled(gsd_m)
        return found

    def to_dict(self) -> dict[str, Any]:
        """The measurement as the JSON document ``acutance/measurement/1``."""
        from acutance import __version__

        numbers = {name: number.to_dict() for name, number in self.metrics().items()}
        stated: dict[str, float | None] = {}
        if self.width_px is not None:
            numbers |= {name: one.to_dict() for name, one in self.pulse_numbers().items()}
            stated = {"stated_width_px": self.stated_width_px}
        return {
            "schema": SCHEMA,
            "kind": self.kind,
            "method": self.method,
            "orientation": self.orientation,
            "image": self.image.to_dict(),
            "line": {**self.line.to_dict(), "orientation": self.orientation},
            "angle_deg": self.angle_deg.to_dict(),
            "snr": self.snr if math.isfinite(self.snr) else None,
            "dark": self.samples.dark,
            "bright": self.samples.bright,
            **numbers,
            **stated,
            "rer_centre": self.response.rer_centre,
            "mtf": self.mtf.to_dict(),
            "lsf": self.lsf.to_dict(),
            "esf": self.esf.to_dict(),
            "plane": self.slices.to_dict(),
            "checks": [check.to_dict() for check in self.checks],
            "options": dict(self.options),
            "software": {"acutance": __version__},
            "measured_at": self.measured_at.isoformat(timespec="seconds"),
        }
