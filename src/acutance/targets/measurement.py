"""A measurement: numbers and curves of one direction or two, checks, provenance, details."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cached_property, partial
from typing import Any, Self

import numpy as np

from acutance.curves import Esf, Estimate, HasResponse, Lsf, Mtf, Otf2d, Response
from acutance.curves.grid import Floats
from acutance.geometry.angles import is_nearer_columns
from acutance.geometry.line import Orientation
from acutance.targets.check import Check, HasChecks, count_failed
from acutance.targets.directions import HasDirections
from acutance.targets.document_fields import DocumentFields, WrittenLater
from acutance.targets.record import (
    SCHEMA,
    ImageInfo,
    Record,
    rounded,
)
from acutance.targets.slices import OtfSlices
from acutance.targets.uncertainty_budget import BudgetTerm, budget_rows, main_stds

__all__ = ["Measurement", "direction_document"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Measurement(HasResponse, HasDirections[Response], HasChecks):
    """The result of a measurement of a target of any kind.

    A straight target shows one direction: `m.mtf_nyquist`, `m.rer`, `m.mtf(0.25)` and all other
    numbers are those of its normal. Other targets show two: `m.across` and `m.along` have the same
    numbers and curves, and `m.mtf_at` those of any direction. The classes of the kinds add the
    results of their own (a line, sources, groups of bars).

    Parameters
    ----------
    kind : str
        The target: "edge", "pulse", "points", "biresolution", "bars", "star", "combined".
    method : str
        The estimator.
    transfer : Response or Otf2d
        The curves of one direction, or the OTF over the plane of frequencies.
    snr : float
        Signal to noise ratio, as the kind defines it.
    checks : sequence of Check
        Whether the target was good enough.
    image : ImageInfo
        Where the pixels came from.
    options : mapping
        The options of the measurement.
    details : object, optional
        The heavy half: pixels, fits, residuals. ``None`` after `without_details`.
    measured_at : datetime
        When (UTC).
    """

    kind: str
    method: str
    transfer: Response | Otf2d
    snr: float
    checks: Sequence[Check] = ()
    image: ImageInfo = field(default_factory=ImageInfo)
    options: Mapping[str, Any] = field(default_factory=dict)
    details: Any = None
    measured_at: datetime = field(default_factory=lambda: datetime.now(UTC))

    @property
    def normal_deg(self) -> float | None:
        """Direction of the one slice that was measured; ``None`` where all were."""
        return None

    @property
    def is_ratio(self) -> bool:
        """Whether the curves are a sensor's MTF over another's, and not its own."""
        return False

    @cached_property
    def orientation(self) -> Orientation:
        """Which direction the numbers belong to, across or along track."""
        if self.normal_deg is None:
            raise AttributeError(f"{self.kind} shows two directions: use .across and .along")
        nearer_columns = is_nearer_columns(self.normal_deg)
        return "across" if nearer_columns == (self.image.along_track == "y") else "along"

    @property
    def response(self) -> Response:
        """The curves and numbers of the one direction that was measured."""
        if isinstance(self.transfer, Otf2d):
            raise AttributeError(
                f"{self.kind} shows two directions: use .across, .along or .response_at(angle_deg)"
            )
        return self.directions[self.orientation]

    @property
    def otf(self) -> Otf2d:
        """The OTF over the plane of frequencies."""
        if isinstance(self.transfer, Response):
            raise AttributeError(
                f"{self.kind} shows one direction: its OTF is .mtf.otf; combine() makes a plane of "
                "several"
            )
        return self.transfer

    @cached_property
    def directions(self) -> dict[Orientation, Response]:
        """The curves by direction: "across", "along", or both."""
        if isinstance(self.transfer, Response):
            found = {self.orientation: self.transfer}
        else:
            found = {name: self.response_at(angle) for name, angle in self.axes_deg.items()}
        if "record" not in vars(self):
            return found
        # The record is older than the rounding of a light half: its numbers stand.
        stated = self.record.directions
        return {name: one.with_numbers(stated[name].numbers) for name, one in found.items()}

    @property
    def axes_deg(self) -> dict[Orientation, float]:
        """Where across and along track point, from the column axis (0) to the row axis (90)."""
        across_deg = 0.0 if self.image.along_track == "y" else 90.0
        return {"across": across_deg, "along": 90.0 - across_deg}

    @property
    def measured_directions(self) -> tuple[Orientation, ...]:
        """The directions that the target shows; others follow from the prior."""
        return tuple(self.directions)

    def response_at(self, angle_deg: float) -> Response:
        """The curves of any direction, from the column axis (0) towards the row axis (90).

        Raises
        ------
        OptionError
            If the direction is no finite number.
        """
        return self.otf.response(angle_deg)

    def mtf_at(self, angle_deg: float) -> Mtf:
        """The MTF in any direction, from the column axis (0) towards the row axis (90).

        Raises
        ------
        OptionError
            If the direction is no finite number.
        """
        return self.otf.mtf(angle_deg)

    def psf(self, half_width_px: float = 5.0, step_px: float = 0.1) -> tuple[Floats, Floats]:
        """Point spread function around its origin, pixel area included.

        Parameters
        ----------
        half_width_px, step_px : float, optional
            Half the width of the returned square and the spacing of its grid.

        Returns
        -------
        distance_px : (n,) array
            Places along either axis.
        psf : (n, n) array
            Light per square pixel at (row, column) distances; its integral over the plane is 1.
        """
        return self.otf.psf(half_width_px, step_px)

    @cached_property
    def slices(self) -> OtfSlices:
        """The OTF along the measured directions, with their common covariance."""
        if self.normal_deg is not None:
            return OtfSlices.of_curve(self.mtf, self.normal_deg)
        return OtfSlices.of_otf2d(self.otf)

    def numbers(self) -> dict[str, dict[str, Estimate]]:
        """All numbers by direction ("across", "along") and name."""
        return {name: response.metrics() for name, response in self.directions.items()}

    def metrics(self) -> dict[str, Estimate]:
        """All numbers of the one direction that was measured, by name."""
        return self.response.metrics()

    @cached_property
    def budget(self) -> tuple[BudgetTerm, ...]:
        """The uncertainty budget: causes, their standard deviations and shares, by direction."""
        if self._is_light:
            return self.record.budget
        return self._budget()

    def _budget(self) -> tuple[BudgetTerm, ...]:
        """One row a direction, unless the kind separates the causes."""
        rows = (
            budget_rows(name, {"fit": main_stds(self.directions[name])})
            for name in self.measured_directions
        )
        return tuple(row for some in rows for row in some)

    @property
    def _is_light(self) -> bool:
        """Whether it is one `without_details`: what these told is in its record."""
        return self.details is None and "record" in vars(self)

    def without_details(self) -> Self:
        """The same measurement without pixels and fits: light enough to be sent and kept.

        Its record, and so its document and its numbers, are those of the whole measurement.
        The curves of one direction keep all standard deviations, but their correlations may be
        rounded. So may a covariance over the plane of frequencies: deviations of its curves
        differ by some thousandths, of points by up to a sixth.
        """
        transfer = self.transfer.packed()
        light = replace(self, details=None, checks=tuple(self.checks), transfer=transfer)
        vars(light)["record"] = self.record
        return light

    def __getstate__(self) -> dict[str, Any]:
        # The record of a copy, or of its light half, is that of the original to the last digit.
        return {**super().__getstate__(), "record": self.record.to_bytes()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state, record=Record.from_bytes(state["record"]))

    @cached_property
    def record(self) -> Record:
        """The light half: what is written, archived and combined."""
        return Record(DocumentFields(self._document()))

    def to_dict(self) -> dict[str, Any]:
        """The measurement as the JSON document ``acutance/measurement/1``."""
        return self.record.to_dict()

    @staticmethod
    def from_dict(document: Mapping[str, Any]) -> Record:
        """What `to_dict` wrote, read again: the `Record`, since a document has no pixels and fits.

        Its numbers, curves, covariance and checks are those of the measurement, it compares equal
        to its ``record``, and whatever takes measurements takes it.

        Raises
        ------
        OptionError
            If it is no document of a measurement, or damaged.
        """
        return Record.from_dict(document)

    def target_document(self) -> dict[str, Any]:
        """Fields that the kind of target adds to the document; none unless overridden."""
        return {}

    def plane_document(self) -> dict[str, Any] | WrittenLater:
        """The slices of the OTF, for JSON."""
        return self.slices.to_dict()

    def budget_document(self) -> WrittenLater:
        """The rows of the uncertainty budget, for JSON."""
        return WrittenLater(partial(_documents, self.budget))

    def _document(self) -> dict[str, Any]:
        from acutance import __version__

        verdict = self.verdict
        one_direction = self.normal_deg is not None
        if one_direction:
            curves = _direction_fields(self.response)
        else:
            curves = {name: direction_document(one) for name, one in self.directions.items()}
        return {
            "schema": SCHEMA,
            "kind": self.kind,
            "method": self.method,
            **({"orientation": self.orientation} if one_direction else {}),
            "measured_directions": list(self.measured_directions),
            "image": self.image.to_dict(),
            "snr": self.snr if math.isfinite(self.snr) else None,
            **self.target_document(),
            **curves,
            "plane": self.plane_document(),
            "checks": WrittenLater(partial(_documents, tuple(self.checks))),
            "verdict": verdict.to_dict(),
            "budget": self.budget_document(),
            "options": dict(self.options),
            "software": {"acutance": __version__},
            "measured_at": self.measured_at.isoformat(timespec="seconds"),
        }

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Measurement):
            return NotImplemented
        return self.record == other.record

    __hash__ = None  # type: ignore[assignment]

    def summary(self) -> str:
        """Target and method, the main numbers by measured direction, how many checks failed."""
        named = (f"{name}: {self.directions[name].summary()}" for name in self.measured_directions)
        snr = f", snr {self.snr:.3g}" if math.isfinite(self.snr) else ""
        failed = count_failed(self.checks)
        return f"{self.kind} by {self.method}, {', '.join(named)}{snr}, {failed}"


def _documents(parts: Sequence[Check] | Sequence[BudgetTerm]) -> list[dict[str, Any]]:
    return [part.to_dict() for part in parts]


def direction_document(response: Response) -> dict[str, Any]:
    """Numbers and curves of one direction, for JSON.

    Parameters
    ----------
    response : Response
    """
    return dict(DocumentFields(_direction_fields(response)))


def _direction_fields(response: Response) -> dict[str, Any]:
    """The same, curves to be written later."""
    return {
        **{name: number.to_dict() for name, number in response.metrics().items()},
        "rer_centre": response.rer_centre,
        "gsd_m": response.gsd_m,
        "mtf": _curve_field(response.mtf),
        "lsf": _curve_field(response.lsf.thinned),
        "esf": _curve_field(response.esf.thinned),
    }


def _curve_field(curve: Mtf | Esf | Lsf) -> WrittenLater:
    """A curve, of which no more is held than is written: not its covariance."""
    return WrittenLater(partial(_curve_document, curve.arrays()))


def _curve_document(columns: Mapping[str, Floats]) -> dict[str, list[float]]:
    """The columns of a curve, with the digits its deviation deserves."""
    return {
        name: rounded(column, 3) if name == "std" else np.round(column, 5).tolist()
        for name, column in columns.items()
    }
