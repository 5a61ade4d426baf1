"""The softness that all objects of a scene have: what is stated of it, and what its parts tell.

Objects that are softer than the sharpest are found by their edges (`acutance.scan.population`).
What even the sharpest have, every edge has: the sensor behind it is the measured one over the
transfer function of such a border, as of a single edge (`targets.straight.stated_target`). Where
it differs from part to part of the scene (`acutance.scan.parts`), or the edges do not tell it from
the sensor's blur (`acutance.scan.shared_blur`), it is uncertain by as much.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.otf2d import OtfModel, PackableOtf
from acutance.curves.short_repr import ShortRepr
from acutance.raster import Box, Gsd, Image
from acutance.scan.blur_modes import ALL_AROUND, COMMON_MODES, blur_modes
from acutance.scan.options import ScanOptions
from acutance.targets.straight.stated_target import StatedTarget, border_gain, stated_softness

__all__ = ["OtfBehindObjects", "as_in_image", "behind_objects", "gsd_of_part", "require_statement"]

Complexes = NDArray[np.complex128]

_STATED = "target_softness"
"""Name of the error of what was stated."""


def gsd_of_part(image: Image, box: Box, stated: Gsd | None) -> Gsd | None:
    """The ground sampling distance in the middle of a part: the stated one, or the image's own."""
    return stated or image.gsd(box.row + box.height / 2, box.col + box.width / 2)


def require_statement(options: ScanOptions, gsd: Gsd | None) -> None:
    """Refuse a statement that will mean nothing, before a scene is scanned.

    Raises
    ------
    OptionError
        If metres are stated without a GSD, or so soft a border that it hides the sensor.
    """
    _borders(options, gsd)


def behind_objects(
    sensor: OtfModel, options: ScanOptions, gsd: Gsd | None, errors_px2: Mapping[str, Floats]
) -> OtfModel:
    """The sensor behind the softness that all objects have; the same one if nothing is known of it.

    Parameters
    ----------
    sensor : OtfModel
        Under the sharpest objects of the scene.
    options : ScanOptions
        That may state it.
    gsd : Gsd or None
        By which metres become pixels.
    errors_px2 : mapping of str to (r, 3) array
        Independent errors of its variance that the edges tell, by the name of their cause, as of
        `OtfBehindObjects`; those of 0 are none.
    """
    across, down = _borders(options, gsd)
    errors = {name: rows for name, rows in errors_px2.items() if rows.any()}
    if across.softness_px is None and not errors:
        return sensor
    return OtfBehindObjects(sensor, (across.variance_px2, down.variance_px2), errors)


def as_in_image(sensor: OtfModel) -> OtfModel:
    """What edges show: a sensor, and before it the borders that were stated of all objects."""
    return sensor.base if isinstance(sensor, OtfBehindObjects) else sensor


def _borders(options: ScanOptions, gsd: Gsd | None) -> tuple[StatedTarget, StatedTarget]:
    """The borders of the sharpest objects along columns and rows, in pixels."""
    col_m, row_m = (None, None) if gsd is None else (gsd.col_m, gsd.row_m)
    return stated_softness(options, col_m), stated_softness(options, row_m)


@dataclass(frozen=True, eq=False)
class OtfBehindObjects(ShortRepr):
    """The OTF of a sensor behind borders that all objects have, an `acutance.curves.OtfModel`.

    Parameters
    ----------
    base : OtfModel
        Sensor and borders together.
    variance_px2 : (Estimate, Estimate)
        Of the borders' Gaussian profile along columns (u) and rows (v) as it was stated; one
        statement, whose errors are the same.
    errors_px2 : mapping of str to (r, 3) array, optional
        Further errors of their variance, independent of one another, by the name of their cause: a
        row each of a part all around, one across more than along, and an oblique one
        (`acutance.scan.blur_modes`).
    """

    base: OtfModel
    variance_px2: tuple[Estimate, Estimate]
    errors_px2: Mapping[str, Floats] = field(default_factory=dict)

    @property
    def band_cpp(self) -> float:
        """Highest frequency that is transferred."""
        return self.base.band_cpp

    @property
    def is_stated(self) -> bool:
        """Whether a softness was stated."""
        return any(one.value > 0 or one.std > 0 for one in self.variance_px2)

    @property
    def causes(self) -> tuple[str, ...]:
        """Names of the errors it has beside those of the measurement."""
        return (*([_STATED] if self.is_stated else []), *self.errors_px2)

    def with_errors(self, causes: Collection[str]) -> OtfBehindObjects:
        """The same with the errors of some causes only, beside those of the measurement."""
        across, down = self.variance_px2
        certain = (Estimate(across.value), Estimate(down.value))
        return OtfBehindObjects(
            self.base,
            self.variance_px2 if _STATED in causes else certain,
            {name: rows for name, rows in self.errors_px2.items() if name in causes},
        )

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,), exactly 1 at zero frequency."""
        return np.asarray(self.base.otf(u_cpp, v_cpp) * self._gain(u_cpp, v_cpp)[0])

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k): of the measurement, the statement and other errors."""
        gain, by_variance = self._gain(u_cpp, v_cpp)
        change = self.base.otf(u_cpp, v_cpp) * by_variance
        stated = self._along(u_cpp, v_cpp) @ [one.std for one in self.variance_px2]
        measured = self.base.factor(u_cpp, v_cpp) * gain[:, None]
        by_blur = self._by_blur(u_cpp, v_cpp)
        others = [change[:, None] * (by_blur @ rows.T) for rows in self.errors_px2.values()]
        return np.column_stack([measured, change * stated, *others])

    def packed(self) -> OtfBehindObjects:
        """The same in fewer bytes, where the measured one has a lighter form."""
        base = self.base.packed() if isinstance(self.base, PackableOtf) else self.base
        return replace(self, base=base)

    def _gain(self, u_cpp: Floats, v_cpp: Floats) -> tuple[Floats, Floats]:
        """By how much the sensor exceeds what is measured, and its derivative by the variance."""
        variance = self._along(u_cpp, v_cpp) @ [one.value for one in self.variance_px2]
        return border_gain(np.hypot(u_cpp, v_cpp), variance)

    def _by_blur(self, u_cpp: Floats, v_cpp: Floats) -> Floats:
        """Variance along a direction by units of the blurs of `errors_px2`, (n, 3)."""
        modes = blur_modes(u_cpp, v_cpp)[..., :COMMON_MODES]
        # Zero frequency has no direction, and needs none.
        return np.asarray(modes / np.minimum(modes[..., [ALL_AROUND]], -np.finfo(float).tiny))

    def _along(self, u_cpp: Floats, v_cpp: Floats) -> Floats:
        """Shares of the variances along columns and rows in that along a direction, (n, 2)."""
        squares = np.stack([u_cpp, v_cpp], axis=-1) ** 2
        # Zero frequency has no direction, and needs none.
        return np.asarray(squares / np.maximum(squares.sum(-1), np.finfo(float).tiny)[..., None])
