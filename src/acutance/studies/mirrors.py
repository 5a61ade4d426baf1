"""Plan an array of convex mirrors: their places, their radius, and the errors to expect.

A convex mirror of radius of curvature R sends the sun's beam evenly into all directions: its
radiant intensity is ``rho E R^2 / 4`` under the irradiance E (normal to the beam) and the
reflectance rho. Level Lambertian ground of reflectance r and area A has ``r E A cos(sun) cos(view)
/ pi`` towards the satellite, by both zenith angles: seen from aside it is smaller, and a mirror is
not. So a mirror is as bright as ground of reflectance ``pi rho R^2 / (4 A cos(sun) cos(view))``
that fills one pixel, which covers the area A of it; the air takes as much from both, and skylight
is left out. The satellite sees the sun in the mirror where the mirror's normal halves the angle
between both, so a cap that lies level must reach to half of the sum of both zenith angles. (Own
derivation: the reports give no formula.)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from acutance.arguments import require_kind, require_optional, require_types
from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.errors import OptionError, TargetError
from acutance.optics import Sensor
from acutance.simulate import points
from acutance.studies.mirror_layout import (
    MIN_SPACING_PX,
    Arrangement,
    MirrorLayout,
    lay_out_mirrors,
)
from acutance.studies.plan_options import require_accuracy, require_several_draws
from acutance.studies.trials import Execution, Record, run_trials
from acutance.targets.points import measure_points

__all__ = ["MirrorPlan", "MirrorPlanOptions", "place_errors_px", "plan_mirrors"]

_MARGIN_PX = 14.0
"""Background around the mirrors of a simulated image."""

_GSD_CHANGES = (-0.05, -0.02, 0.0, 0.02, 0.05)
"""Shares by which the GSD of the day may differ from the planned one."""

POSITION_BOUND = 0.80
"""Standard deviation of a place times the peak's SNR, in pixels: a well sampled Gaussian's."""

_MAX_DIAMETER_M = 3.0
"""A bound of ours for the cap of a mirror that somebody carries to a field."""


@dataclass(frozen=True)
class MirrorPlanOptions:
    """The purpose of an array of mirrors.

    Parameters
    ----------
    sensor : Sensor
        With its GSD.
    count : int
        Number of mirrors.
    arrangement : {"columns", "square"}
        Slanted columns, or a square.
    columns : int, optional
        Number of columns; 2 if not given, of a single mirror 1.
    spacing_px : float
        Least distance of neighbours in a column, or in a row of the square.
    snr : float
        Peak over the noise of the background.
    level : float
        Wanted brightest pixel, as a reflectance of ground that would look as bright.
    ground : float
        Reflectance of the ground.
    mirror : float
        Reflectance of the mirrors.
    sun_zenith_deg, view_zenith_deg : float
        Zenith angles of the sun and of the satellite.
    draws : int
        Simulated images; 0 for the layout alone.
    accuracy : float, optional
        Wanted error of the MTF at Nyquist, across and along: answered by a number of images.

    Raises
    ------
    OptionError
        If a number makes no sense.
    """

    sensor: Sensor
    count: int = 20
    arrangement: Arrangement = "columns"
    columns: int | None = None
    spacing_px: float | None = None
    snr: float = 80.0
    level: float = 0.5
    ground: float = 0.1
    mirror: float = 0.85
    sun_zenith_deg: float = 40.0
    view_zenith_deg: float = 10.0
    draws: int = 20
    accuracy: float | None = None

    def __post_init__(self) -> None:
        require_types(self)
        if self.sensor.gsd_m is None:
            raise OptionError(
                "mirrors need a ground sampling distance: give the sensor's GSD (gsd_m, --gsd)"
            )
        bounds = {
            "count": (self.count, 1, 400),
            "columns": (self.column_count, 1, self.count),
            "spacing_px": (self.min_spacing_px, MIN_SPACING_PX, 100.0),
            "snr": (self.snr, 1.0, 1e6),
            "ground": (self.ground, 0.0, 0.95),
            "level": (self.level, self.ground + 0.01, 100.0),
            "mirror": (self.mirror, 0.05, 1.0),
            "sun_zenith_deg": (self.sun_zenith_deg, 0.0, 80.0),
            "view_zenith_deg": (self.view_zenith_deg, 0.0, 60.0),
            "draws": (self.draws, 0, 10_000),
        }
        for name, (value, low, high) in bounds.items():
            if not low <= value <= high:
                raise OptionError(f"{name} is {value:g}: it has to be {low:g} to {high:g}")
        require_accuracy(self.accuracy)
        require_several_draws(self.draws, "layout")
        if self.accuracy is not None and self.draws == 0:
            raise OptionError(
                "accuracy (--accuracy) is answered by simulated images, and draws (--draws) is 0: "
                "give 2 or more"
            )
        self._require_columns()

    def _require_columns(self) -> None:
        """Refuse columns of a square, and more of them than so many mirrors fill."""
        if self.columns is None:
            return
        if self.arrangement == "square":
            raise OptionError(
                f"columns is {self.columns}, and the arrangement is a square, whose sides are "
                "equal: leave one of them out"
            )
        rows = math.ceil(self.count / self.columns)
        filled = math.ceil(self.count / rows)
        if filled < self.columns:
            raise OptionError(
                f"columns is {self.columns}: {self.count} mirrors in equal columns of {rows} fill "
                f"{filled} of them; give {filled} columns, or more mirrors"
            )

    @property
    def column_count(self) -> int:
        """The columns requested, or 2, or one for each of fewer mirrors."""
        return min(2, self.count) if self.columns is None else self.columns

    @property
    def min_spacing_px(self) -> float:
        """The spacing requested, or 10 px in columns and 5 px in a square."""
        if self.spacing_px is not None:
            return self.spacing_px
        return 10.0 if self.arrangement == "columns" else MIN_SPACING_PX


@dataclass(frozen=True, eq=False)
class MirrorPlan:
    """A layout with its mirrors, and what to expect of it.

    Parameters
    ----------
    options : MirrorPlanOptions
    layout : MirrorLayout
    radius_m : float
        Radius of curvature that gives the wanted signal.
    diameter_m : float
        Least diameter of a mirror's cap that lies level.
    peak_share : float
        What the brightest pixel holds of a mirror's light, averaged over the phases.
    std : dict of float
        Standard deviations that measurements of simulated images state, by name and direction
        ("mtf_nyquist across"); empty without draws.
    scatter : dict of float
        Root mean square errors of the same measurements against the truth: what to expect.
    bias : dict of float
        Mean errors of the same measurements, which no further image averages out; places have
        none, since they are compared about their common shift.
    refused : int
        Simulated images that could not be measured.
    """

    options: MirrorPlanOptions
    layout: MirrorLayout
    radius_m: float
    diameter_m: float
    peak_share: float
    std: dict[str, float]
    scatter: dict[str, float]
    bias: dict[str, float]
    refused: int

    @property
    def position_std_px(self) -> float:
        """Standard deviation of a place that no method beats, by the peak's SNR."""
        return POSITION_BOUND / self.options.snr

    @property
    def images_needed(self) -> float | None:
        """How many images of these mirrors give the wanted accuracy of the MTF at Nyquist.

        Of the direction that needs more. Infinite where the bias alone, as far as the draws show
        one, is larger; ``None`` where no accuracy is wanted, or no image could be measured.
        """
        wanted, measured = self.options.accuracy, self.options.draws - self.refused
        if wanted is None or measured < 2:
            return None
        needed = 1.0
        for direction in ("across", "along"):
            name = f"mtf_nyquist {direction}"
            variance = (self.scatter[name] ** 2 - self.bias[name] ** 2) * measured / (measured - 1)
            # By chance the square of the mean of the draws is as large as that of nothing.
            bias = max(self.bias[name] ** 2 - variance / measured, 0.0)
            left = wanted**2 - bias
            needed = max(needed, math.ceil(variance / left) if left > 0 else math.inf)
        return needed

    @property
    def notes(self) -> tuple[str, ...]:
        """What has to be said of the mirrors: that they are too large."""
        if self.diameter_m <= _MAX_DIAMETER_M:
            return ()
        return (
            f"caps {self.diameter_m:.3g} m across are no mirrors for a field (at most "
            f"{_MAX_DIAMETER_M:g} m): they grow with the pixel, {self.layout.pixel_m[1]:g} m here; "
            "check the GSD (gsd_m, --gsd), choose a lower level (level, --level), or tilt smaller "
            "caps towards the middle between sun and satellite",
        )

    def to_dict(self) -> dict[str, Any]:
        """The plan for JSON."""
        layout, options, images = self.layout, self.options, self.images_needed
        return {
            "schema": "acutance/mirror-plan/1",
            "arrangement": options.arrangement,
            "count": options.count,
            "pixel_m": list(layout.pixel_m),
            "step_px": list(layout.step_px),
            "step_m": [s * m for s, m in zip(layout.step_px, layout.pixel_m, strict=True)],
            "apart_px": layout.apart_px,
            "apart_m": layout.apart_px * layout.pixel_m[1],
            "angle_deg": layout.angle_deg,
            "spacing_px": layout.spacing_px if math.isfinite(layout.spacing_px) else None,
            "phase_gap_px": {f"{change:+.2f}": layout.gap_px(change) for change in _GSD_CHANGES},
            "mirrors": [
                {"along_m": m[0], "across_m": m[1], "along_phase": p[0], "across_phase": p[1]}
                for m, p in zip(layout.places_m.tolist(), layout.phases.tolist(), strict=True)
            ],
            "radius_m": self.radius_m,
            "diameter_m": self.diameter_m,
            "peak_share": self.peak_share,
            "snr": options.snr,
            "position_std_px": self.position_std_px,
            "draws": options.draws,
            "refused": self.refused,
            "std": dict(self.std),
            "scatter": dict(self.scatter),
            "bias": dict(self.bias),
            "accuracy": options.accuracy,
            "images_needed": images if images is not None and math.isfinite(images) else None,
            "notes": list(self.notes),
        }

    def to_csv(self) -> str:
        """The mirrors' places as CSV, metres and pixels from the first one."""
        lines = ["mirror,along_m,across_m,row,col,row_phase,col_phase"]
        rows = zip(
            self.layout.places_m.tolist(),
            self.layout.places_px.tolist(),
            self.layout.phases.tolist(),
            strict=True,
        )
        for number, (metres, pixels, phases) in enumerate(rows, start=1):
            cells = [*(f"{m:.3f}" for m in metres), *(f"{p:.4f}" for p in (*pixels, *phases))]
            lines.append(",".join([str(number), *cells]))
        return "\n".join(lines) + "\n"


def plan_mirrors(options: MirrorPlanOptions, execution: Execution | None = None) -> MirrorPlan:
    """Lay out mirrors and predict the accuracy of measuring them.

    Parameters
    ----------
    options : MirrorPlanOptions
    execution : Execution, optional
        How the simulated images are measured.

    Raises
    ------
    OptionError
        If one of them is something else.
    """
    require_kind(MirrorPlanOptions, options=options)
    require_optional(Execution, execution=execution)
    gsd_m = options.sensor.gsd_m or 1.0
    along_m = options.sensor.gsd_along_m or gsd_m
    layout = lay_out_mirrors(
        options.count, pixel_m=(along_m, gsd_m), arrangement=options.arrangement,
        columns=options.column_count, spacing_px=options.min_spacing_px,
    )  # fmt: skip
    share = _peak_share(options.sensor, layout)
    light = (options.level - options.ground) / share
    slant = math.cos(math.radians(options.sun_zenith_deg))
    slant *= math.cos(math.radians(options.view_zenith_deg))
    radius = 2 * math.sqrt(light * gsd_m * along_m * slant / (math.pi * options.mirror))
    half = math.radians(0.5 * (options.sun_zenith_deg + options.view_zenith_deg))
    records = _simulated(options, execution or Execution(workers=1))
    means = _by_name(records, np.mean)
    bias = {name: mean for name, mean in means.items() if not name.startswith("position_px")}
    return MirrorPlan(
        options, layout, radius, 2 * radius * math.sin(half), share,
        std=_by_name(records, np.mean, stated=True), scatter=_by_name(records, _rms), bias=bias,
        refused=options.draws - len(records),
    )  # fmt: skip


def _images_places(layout: MirrorLayout, rng: np.random.Generator | None) -> Floats:
    """The mirrors in an image with a margin, at a random phase of the first one."""
    first = np.full(2, _MARGIN_PX) - layout.places_px.min(axis=0)
    return np.asarray(layout.places_px + first + (0.0 if rng is None else rng.uniform(0, 1, 2)))


def _peak_share(sensor: Sensor, layout: MirrorLayout) -> float:
    """Mean share of a source's light in its brightest pixel."""
    places = _images_places(layout, None)
    image, _ = points(sensor, positions=places, fluxes=1.0, background=0.0)
    near = np.rint(places).astype(int)
    return float(np.mean([image[r - 1 : r + 2, c - 1 : c + 2].max() for r, c in near.tolist()]))


def _draw(options: MirrorPlanOptions, _: int, rng: np.random.Generator) -> Record:
    """Errors and stated deviations of one simulated image; nan where it is refused."""
    layout = lay_out_mirrors(
        options.count, pixel_m=(1.0, 1.0), arrangement=options.arrangement,
        columns=options.column_count, spacing_px=options.min_spacing_px,
    )  # fmt: skip
    places = _images_places(layout, rng)
    image, truth = points(options.sensor, positions=places, snr=options.snr, rng=rng)
    found: Record = {}
    try:
        measured = measure_points(image, positions=places)
    except TargetError:
        return {"refused": 1.0}
    for direction, response in (("across", measured.across), ("along", measured.along)):
        true = truth.response("across" if direction == "across" else "along")
        for name in ("mtf_nyquist", "rer", "fwhm_px"):
            estimate: Estimate = getattr(response, name)
            found[f"{name} {direction}"] = estimate.value - getattr(true, name).value
            found[f"{name} {direction} std"] = estimate.std
    error = place_errors_px(measured.positions, places)
    found["position_px across"], found["position_px along"] = np.sqrt(
        np.mean(error[:, ::-1] ** 2, axis=0)
    ).tolist()
    found["position_px across std"] = float(np.mean([one.col.std for one in measured.sources]))
    found["position_px along std"] = float(np.mean([one.row.std for one in measured.sources]))
    return found


def place_errors_px(found: Floats, places: Floats) -> Floats:
    """Errors (k, 2) of places against the nearest true ones, minus their shift; of one NaN.

    Parameters
    ----------
    found : (k, 2) array
        Measured (row, col); a mirror that was left out of the fit is missing.
    places : (n, 2) array
    """
    away = np.linalg.norm(found[:, None] - places, axis=2)
    error = found - places[np.argmin(away, axis=1)]
    return np.asarray(error - (error.mean(axis=0) if len(error) > 1 else math.nan))


def _simulated(options: MirrorPlanOptions, execution: Execution) -> list[Record]:
    """Errors and stated deviations of the simulated images that could be measured."""
    if options.draws == 0:
        return []
    records = run_trials("mirrors", options, list(range(options.draws)), _draw, execution)
    return [one for one in records if "refused" not in one]


def _by_name(
    records: Sequence[Record], of_draws: Callable[[Floats], float], stated: bool = False
) -> dict[str, float]:
    """One number of the errors, or of the stated deviations, of all draws, by name."""
    names = [name for name in (records[0] if records else {}) if not name.endswith(" std")]
    end = " std" if stated else ""
    return {name: float(of_draws(np.array([one[name + end] for one in records]))) for name in names}


def _rms(errors: Floats) -> float:
    return float(np.sqrt(np.mean(errors**2)))
