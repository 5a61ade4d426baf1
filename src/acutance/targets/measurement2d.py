"""What a 2-D method measures: an OTF over the plane, its slices, and the checks."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cached_property
from typing import Any

from acutance.curves import Estimate, Mtf, Otf2d, Response
from acutance.curves.grid import Floats
from acutance.curves.one_line import OneLine
from acutance.targets.measurement import SCHEMA, Check, ImageInfo, count_failed
from acutance.targets.slices import PlaneSlices

__all__ = ["Measurement2d"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Measurement2d(OneLine):
    """A measurement of the sensor in all directions; each method adds its evidence.

    Parameters
    ----------
    kind : str
        The target: "points", "biresolution", "star", "combined".
    method : str
        The estimator.
    otf : Otf2d
        The OTF over the plane of frequencies, with its covariance.
    snr : float
        Signal to noise ratio, as the method defines it.
    checks : sequence of Check
        What was asked of the target.
    image : ImageInfo
        Where the pixels came from.
    options : dict
        The options of the measurement.
    measured_at : datetime
        When (UTC).
    """

    kind: str
    method: str
    otf: Otf2d
    snr: float
    checks: Sequence[Check] = ()
    image: ImageInfo = field(default_factory=ImageInfo)
    options: Mapping[str, Any] = field(default_factory=dict)
    measured_at: datetime = field(default_factory=lambda: datetime.now(UTC))

    @cached_property
    def across(self) -> Response:
        """The curves and numbers across track: along the rows of pixels, if not declared else."""
        return self.otf.response(0.0 if self.image.along_track == "y" else 90.0)

    @cached_property
    def along(self) -> Response:
        """The curves and numbers along track: down the columns of pixels, if not declared else."""
        return self.otf.response(90.0 if self.image.along_track == "y" else 0.0)

    def response_at(self, angle_deg: float) -> Response:
        """The curves of any direction, from the column axis (0) towards the row axis (90)."""
        return self.otf.response(angle_deg)

    def mtf_at(self, angle_deg: float) -> Mtf:
        """The MTF in any direction, from the column axis (0) towards the row axis (90)."""
        return self.response_at(angle_deg).mtf

    def psf(self, half_width_px: float = 5.0, step_px: float = 0.1) -> tuple[Floats, Floats]:
        """Point spread function: see `Otf2d.psf`."""
        return self.otf.psf(half_width_px, step_px)

    @property
    def trusted(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)

    @property
    def failed_checks(self) -> tuple[Check, ...]:
        """The checks that did not pass."""
        return tuple(check for check in self.checks if not check.passed)

    def in_words(self) -> str:
        """Target and method, the main numbers of both directions, and how many checks failed."""
        return (
            f"{self.kind} by {self.method}, across: {self.across.in_words()}, "
            f"along: {self.along.in_words()}, {count_failed(self.checks)}"
        )

    @property
    def is_ratio(self) -> bool:
        """Whether the curves are a sensor's MTF over another's, and not its own."""
        return False

    @property
    def slices(self) -> PlaneSlices:
        """Slices of the OTF in several directions, with their common covariance."""
        return PlaneSlices.of_plane(self.otf)

    def metrics(self) -> dict[str, dict[str, Estimate]]:
        """All numbers by direction ("across", "along") and name."""
        return {"across": self.across.metrics(), "along": self.along.metrics()}

    def to_dict(self) -> dict[str, Any]:
        """The measurement as the JSON document ``acutance/measurement/1``."""
        from acutance import __version__

        return {
            "schema": SCHEMA,
            "kind": self.kind,
            "method": self.method,
            "image": {**self.image.to_dict(), "pixel_gsd_m": _sides(self.otf.gsd_m)},
            "snr": self.snr if math.isfinite(self.snr) else None,
            **self.evidence(),
            "across": _direction(self.across),
            "along": _direction(self.along),
            "plane": self.slices.to_dict(),
            "checks": [check.to_dict() for check in self.checks],
            "options": dict(self.options),
            "software": {"acutance": __version__},
            "measured_at": self.measured_at.isoformat(timespec="seconds"),
        }

    def evidence(self) -> dict[str, Any]:
        """What the method adds to the JSON document; nothing unless it says so."""
        return {}


def _sides(gsd_m: tuple[float, float] | None) -> list[float] | None:
    return None if gsd_m is None else list(gsd_m)


def _direction(response: Response) -> dict[str, Any]:
    return {
        **{name: number.to_dict() for name, number in response.metrics().items()},
        "rer_centre": response.rer_centre,
        "mtf": response.mtf.to_dict(),
        "lsf": response.lsf.to_dict(),
        "esf": response.esf.to_dict(),
    }
