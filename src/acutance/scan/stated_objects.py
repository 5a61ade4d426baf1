"""What is stated of a scene because no edge shows it: a softness that all its objects have.

Objects that are softer than the sharpest are found by their edges (`acutance.scan.population`).
What even the sharpest have, every edge has: the sensor behind it is the measured one over the
transfer function of such a border, as of a single edge (`targets.straight.stated_target`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.otf2d import OtfModel, PackableOtf
from acutance.curves.short_repr import ShortRepr
from acutance.raster import Box, Gsd, Image
from acutance.scan.options import ScanOptions
from acutance.targets.straight.stated_target import StatedTarget, border_gain, stated_softness

__all__ = ["OtfBehindObjects", "as_in_image", "behind_objects", "gsd_of_part", "require_statement"]

Complexes = NDArray[np.complex128]


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


def behind_objects(sensor: OtfModel, options: ScanOptions, gsd: Gsd | None) -> OtfModel:
    """The sensor under objects of which a softness is stated; the same one if none is.

    Parameters
    ----------
    sensor : OtfModel
        Under the sharpest objects of the scene.
    options : ScanOptions
    gsd : Gsd or None
        By which metres become pixels.
    """
    across, down = _borders(options, gsd)
    if across.softness_px is None:
        return sensor
    return OtfBehindObjects(sensor, (across.variance_px2, down.variance_px2))


def as_in_image(sensor: OtfModel) -> OtfModel:
    """What edges show: a sensor, and before it the borders that were stated of all objects."""
    return sensor.base if isinstance(sensor, OtfBehindObjects) else sensor


def _borders(options: ScanOptions, gsd: Gsd | None) -> tuple[StatedTarget, StatedTarget]:
    """The borders of the sharpest objects along columns and rows, in pixels."""
    col_m, row_m = (None, None) if gsd is None else (gsd.col_m, gsd.row_m)
    return stated_softness(options, col_m), stated_softness(options, row_m)


@dataclass(frozen=True, eq=False)
class OtfBehindObjects(ShortRepr):
    """The OTF of a sensor behind borders of a stated softness, an `acutance.curves.OtfModel`.

    Parameters
    ----------
    base : OtfModel
        Sensor and borders together.
    variance_px2 : (Estimate, Estimate)
        Of the borders' Gaussian profile along columns (u) and rows (v); one statement, whose
        errors are the same.
    """

    base: OtfModel
    variance_px2: tuple[Estimate, Estimate]

    @property
    def band_cpp(self) -> float:
        """Highest frequency that is transferred."""
        return self.base.band_cpp

    @property
    def if_certain(self) -> OtfBehindObjects:
        """The same one if the statement had no error."""
        across, down = self.variance_px2
        return replace(self, variance_px2=(Estimate(across.value), Estimate(down.value)))

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,), exactly 1 at zero frequency."""
        return np.asarray(self.base.otf(u_cpp, v_cpp) * self._gain(u_cpp, v_cpp)[0])

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k): of the measurement, and of the statement."""
        gain, error = self._gain(u_cpp, v_cpp)
        stated = self.base.otf(u_cpp, v_cpp) * error
        return np.column_stack([self.base.factor(u_cpp, v_cpp) * gain[:, None], stated])

    def packed(self) -> OtfBehindObjects:
        """The same in fewer bytes, where the measured one has a lighter form."""
        base = self.base.packed() if isinstance(self.base, PackableOtf) else self.base
        return replace(self, base=base)

    def _gain(self, u_cpp: Floats, v_cpp: Floats) -> tuple[Floats, Floats]:
        """By how much the sensor exceeds what is measured, and the deviation of that, (n,) each."""
        squares = np.stack([u_cpp, v_cpp], axis=-1) ** 2
        square = squares.sum(axis=-1)
        # Zero frequency has no direction, and needs none.
        share = squares / np.maximum(square, np.finfo(float).tiny)[..., None]
        variance = share @ [one.value for one in self.variance_px2]
        gain, by_variance = border_gain(np.sqrt(square), variance)
        return gain, by_variance * (share @ [one.std for one in self.variance_px2])
