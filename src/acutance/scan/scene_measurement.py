"""The result of a scan: the sensor under all edges of a scene, the objects, every edge."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.arguments import require_floats
from acutance.curves import Estimate, Mtf, Otf2d, OtfModel, Response
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError, RegionError
from acutance.geometry.line import Orientation
from acutance.scan.field import Field, FieldOtf
from acutance.scan.scene_edges import SceneEdges
from acutance.scan.scene_likelihood import likelihood_of_slices
from acutance.scan.sensor_fit import IdealShare
from acutance.scan.stated_objects import OtfBehindObjects, as_in_image
from acutance.targets.measurement import Measurement
from acutance.targets.slices import OtfSlices
from acutance.targets.uncertainty_budget import BudgetTerm, budget_rows, main_stds

__all__ = ["SceneMeasurement", "ScenePlace"]

_NUMBERS = ("mtf_nyquist", "rer", "fwhm_px")


@dataclass(frozen=True, eq=False)
class ScenePlace(ShortRepr):
    """The sensor at a place of the field.

    Parameters
    ----------
    row, col : float
        In pixels of the image; integers are pixel centres.
    otf : Otf2d
    axes_deg : mapping of "across" and "along" to directions
    """

    row: float
    col: float
    otf: Otf2d
    axes_deg: Mapping[Orientation, float]

    @cached_property
    def across(self) -> Response:
        """Curves and numbers across track."""
        return self.otf.response(self.axes_deg["across"])

    @cached_property
    def along(self) -> Response:
        """Curves and numbers along track."""
        return self.otf.response(self.axes_deg["along"])

    def mtf_at(self, angle_deg: float) -> Mtf:
        """The MTF in any direction, from the column axis (0) towards the row axis (90)."""
        return self.otf.mtf(angle_deg)

    def summary(self) -> str:
        """The place and the main numbers."""
        numbers = f"across: {self.across.summary()}, along: {self.along.summary()}"
        return f"row {self.row:g}, column {self.col:g}, {numbers}"

    def to_dict(self) -> dict[str, Any]:
        """The place and the main numbers, for JSON."""
        directions: dict[str, Response] = {"across": self.across, "along": self.along}
        return {
            "row": round(self.row, 2),
            "col": round(self.col, 2),
            **{
                name: {key: getattr(one, key).to_dict() for key in _NUMBERS}
                for name, one in directions.items()
            },
        }


@dataclass(frozen=True, eq=False, kw_only=True)
class SceneMeasurement(Measurement):
    """A sensor measured from the edges of a whole scene; `details` is the `SensorFit`.

    Its numbers are the mean over the field, `at` has those of a place.

    Parameters
    ----------
    edges : SceneEdges
        Every edge that was found, one array a column.
    field : Field
        How sharpness changes over the scene.
    objects : mapping of str to Estimate
        Shares of the objects: "ideal", "soft", and "strange" for edges that are neither.
    ideal_by_direction : tuple of IdealShare
        Shares of ideal objects among those of about one direction: normal_deg, edges, share.
    forms : mapping of str to float
        Weights of the forms of sensor that the mean is of, the largest first.
    normal_deg_bins : tuple of float
        Mean directions of the edges, -90 to 90 degrees.
    """

    edges: SceneEdges
    field: Field
    objects: Mapping[str, Estimate]
    ideal_by_direction: tuple[IdealShare, ...]
    forms: Mapping[str, float]
    normal_deg_bins: tuple[float, ...]

    @cached_property
    def slices(self) -> OtfSlices:
        """Slices of the OTF, their covariance, and what the edges alone say of them."""
        if self._is_light:
            return self.record.slices
        slices = OtfSlices.of_otf2d(self.otf)
        if self.details is None:
            return slices
        found = likelihood_of_slices(self.details, self.otf.model, slices)
        return replace(slices, likelihood=found)

    def at(self, row: float, col: float) -> ScenePlace:
        """The sensor at a place of the scene.

        Parameters
        ----------
        row, col : float
            In pixels of the image; integers are pixel centres.

        Raises
        ------
        RegionError
            If the place lies outside of what was scanned, or is none.
        """
        for name, value in (("row", row), ("col", col)):
            if isinstance(value, bool) or not isinstance(value, Real | np.number):
                raise RegionError(f"{name} is {value!r:.80}: give a number of pixels")
        if not self.field.holds(np.array(row), np.array(col)):
            raise self._outside(row, col)
        model = self.field.at(self._mean.base, row, col)
        return ScenePlace(row, col, Otf2d(model, self.otf.gsd_m), self.axes_deg)

    def over_field(self, rows: int = 3, cols: int = 3) -> tuple[ScenePlace, ...]:
        """The sensor in the middle of so many equal parts of the scene, row by row.

        Raises
        ------
        OptionError
            If a number of parts is not a whole one from 1.
        """
        for name, value in (("rows", rows), ("cols", cols)):
            if not isinstance(value, int | np.integer) or value < 1:
                raise OptionError(f"{name} is {value!r:.80}: give a whole number of parts, from 1")
        row, col = self.field.grid(rows, cols)
        return tuple(self.at(float(i), float(j)) for i in row for j in col)

    def mtf_nyquist_at(self, row: ArrayLike, col: ArrayLike, normal_deg: ArrayLike) -> Floats:
        """MTF at Nyquist at places along normals: that of `at`, of many at once.

        Parameters
        ----------
        row, col : array_like
            In pixels of the image; integers are pixel centres.
        normal_deg : array_like
            From the column axis (0: across) towards the row axis (90: along); one number serves
            all places.

        Raises
        ------
        RegionError
            If a place lies outside of what was scanned.
        OptionError
            If these are no numbers, or as many as do not fit together.
        """
        return self._at_nyquist(self._mean.base, row, col, normal_deg)

    def mtf_nyquist_seen(self, row: ArrayLike, col: ArrayLike, normal_deg: ArrayLike) -> Floats:
        """The same as edges show it: behind the softness that is stated of all objects."""
        return self._at_nyquist(as_in_image(self._mean.base), row, col, normal_deg)

    def _at_nyquist(
        self, base: OtfModel, row: ArrayLike, col: ArrayLike, normal_deg: ArrayLike
    ) -> Floats:
        given = {"row": row, "col": col, "normal_deg": normal_deg}
        numbers = [require_floats(name, values) for name, values in given.items()]
        try:
            rows, cols, normals = np.broadcast_arrays(*numbers)
        except ValueError:
            pairs = zip(given, numbers, strict=True)
            sizes = ", ".join(f"{name} {values.shape}" for name, values in pairs)
            raise OptionError(f"shapes differ, {sizes}: give each place a direction") from None
        outside = np.flatnonzero(~self.field.holds(rows, cols))
        if outside.size:
            raise self._outside(rows.flat[outside[0]], cols.flat[outside[0]])
        if not np.all(np.isfinite(normals)):
            raise OptionError("normal_deg holds NaN or infinity: give finite numbers of degrees")
        found = self.field.mtf_nyquist(base, rows.ravel(), cols.ravel(), normals.ravel())
        return found.reshape(rows.shape)

    def _outside(self, row: float, col: float) -> RegionError:
        top, left, height, width = self.field.roi
        return RegionError(
            f"row {row:g}, column {col:g} lies outside of what was scanned, rows {top} to "
            f"{top + height - 1} and columns {left} to {left + width - 1}: give a place in it"
        )

    @property
    def _mean(self) -> FieldOtf:
        mean = self.otf.model
        assert isinstance(mean, FieldOtf)
        return mean

    def _budget(self) -> tuple[BudgetTerm, ...]:
        """Rows for the fit, and for the softness that all objects may have."""
        mean = self._mean
        if not isinstance(mean.base, OtfBehindObjects):
            return super()._budget()
        rows: tuple[BudgetTerm, ...] = ()
        for name, angle_deg in self.axes_deg.items():
            stds: dict[str, dict[str, float]] = {}
            for term in ("fit", *mean.base.causes):
                model = replace(mean, base=mean.base.with_errors([term]))
                found = main_stds(Otf2d(model, self.otf.gsd_m).response(angle_deg))
                stds[term] = found if term == "fit" else _beyond(found, stds["fit"])
            rows += budget_rows(name, stds)
        return rows

    def target_document(self) -> dict[str, Any]:
        """How many edges, their directions, the shares of the objects, and the field."""
        places = self.over_field(*self.options["places"])
        return {
            "edges": {"found": self.edges.size, "used": int(self.edges.used.sum())},
            "directions_deg": [round(one, 3) for one in self.normal_deg_bins],
            "objects": {name: share.to_dict() for name, share in self.objects.items()},
            "ideal_by_direction": [
                {"normal_deg": one.normal_deg, "edges": one.edges, "share": one.share.to_dict()}
                for one in self.ideal_by_direction
            ],
            "forms": {name: round(weight, 6) for name, weight in self.forms.items()},
            "field": {**self.field.to_dict(), "places": [place.to_dict() for place in places]},
        }


def _beyond(whole: Mapping[str, float], part: Mapping[str, float]) -> dict[str, float]:
    """Standard deviations of what a whole has beside an independent part."""
    return {name: math.sqrt(max(std**2 - part[name] ** 2, 0.0)) for name, std in whole.items()}
