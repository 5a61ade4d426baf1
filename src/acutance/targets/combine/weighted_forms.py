"""The OTF of a combination: a mean over forms of sensors, each with its weight."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.rounded_rows import RoundedRows
from acutance.curves.short_repr import ShortRepr
from acutance.geometry.angles import wrap_axis
from acutance.targets.combine.correction import Correction
from acutance.targets.combine.forms_on_plane import FormsOnPlane
from acutance.targets.combine.plane import Plane
from acutance.targets.combine.sensor_forms import SensorForm

__all__ = ["CombinedOtf", "RoundedForm", "WeightedForm"]

Complexes = NDArray[np.complex128]

_MAX_STD_DEG = 30.0
_AT_ONCE = 1024
"""Places of the plane at which all forms are worked out together."""


@dataclass(frozen=True, eq=False)
class WeightedForm(ShortRepr):
    """One form of sensor with its parameters, a correction of a given size, and its weight.

    Parameters
    ----------
    form : SensorForm
    share : float
        Standard deviation of the correction of the form, a share of the logarithm of the optical
        transfer function (OTF).
    correction : Correction
        The directions of the correction.
    parameters : (p,) array
    weights : (m,) array
        Of the correction's directions.
    root : (p + m, p + m) array
        Triangular factor of the covariance of both, before it is widened.
    weight : float
        Share in the mean over forms, ``exp(-score / 2)`` normalised.
    """

    form: SensorForm
    share: float
    correction: Correction
    parameters: Floats
    weights: Floats
    root: Floats
    weight: float

    def otf_on(self, plane: Plane) -> Complexes:
        """OTF, (n,), at places of the plane; exactly 1 at zero frequency."""
        return np.asarray(FormsOnPlane([self], plane).otfs[0])

    def slopes_on(self, plane: Plane) -> Complexes:
        """Derivatives of the OTF by parameters and weights, (n, p + m)."""
        return FormsOnPlane([self], plane).slopes[0]

    def numbers(self, widened: float = 1.0) -> dict[str, Estimate]:
        """Parameters by name; the direction of a round or short shape has no value (NaN)."""
        centre = self.form.numbers(self.parameters)
        step = 1e-5
        rows = {name: np.zeros(self.parameters.size) for name in centre}
        for i, move in enumerate(step * np.eye(self.parameters.size)):
            above = self.form.numbers(self.parameters + move)
            below = self.form.numbers(self.parameters - move)
            for name, row in rows.items():
                change = above[name] - below[name]
                if name.endswith("_deg"):
                    change = wrap_axis(change)
                row[i] = change / (2 * step)
        root = self.root[: self.parameters.size]
        found = {
            name: Estimate(value, widened * float(np.linalg.norm(rows[name] @ root)))
            for name, value in centre.items()
        }
        for name, number in found.items():
            if name.endswith("_deg") and not number.std < _MAX_STD_DEG:
                found[name] = Estimate(math.nan, math.nan)
        return found

    def packed(self) -> RoundedForm:
        """The same form in fewer bytes: correlations of its correction are rounded."""
        return RoundedForm.of(self, RoundedRows.of(self.root[self.parameters.size :]))

    def __getstate__(self) -> dict[str, Any]:
        return {**super().__getstate__(), "root": _packed_triangle(self.root)}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        vars(self).update({**state, "root": _triangle(state["root"])})


@dataclass(frozen=True, eq=False)
class RoundedForm(WeightedForm):
    """A form whose correction's correlations were rounded: pickled in an eighth of the bytes.

    Parameters
    ----------
    rows : RoundedRows
        The rows of `root` that belong to the weights; those of the parameters are exact.
    """

    rows: RoundedRows

    @classmethod
    def of(cls, form: WeightedForm, rows: RoundedRows) -> RoundedForm:
        """A form, the rows of its weights replaced by rounded ones."""
        values = {field.name: getattr(form, field.name) for field in fields(WeightedForm)}
        p = form.parameters.size
        values["root"] = np.concatenate([form.root[:p], rows.factor()])
        return cls(**values, rows=rows)

    def packed(self) -> RoundedForm:
        """Itself."""
        return self

    def __getstate__(self) -> dict[str, Any]:
        p = self.parameters.size
        return {**super().__getstate__(), "root": _packed_triangle(self.root[:p, :p])}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        own, rows = _triangle(state["root"]), state["rows"].factor()
        width = ((0, 0), (0, rows.shape[1] - own.shape[1]))
        root = np.concatenate([np.pad(own, width), rows])
        vars(self).update({**state, "root": root})


def _packed_triangle(root: Floats) -> Floats:
    """The entries of a lower triangle, (n (n + 1) / 2,)."""
    return np.asarray(root[np.tril_indices(root.shape[0])])


def _triangle(packed: Floats) -> Floats:
    """The lower triangular matrix (n, n) of its entries."""
    size = math.isqrt(2 * packed.size)
    root = np.zeros((size, size))
    root[np.tril_indices(size)] = packed
    return root


@dataclass(frozen=True, eq=False)
class CombinedOtf(ShortRepr):
    """The 2-D OTF of all curves, an `acutance.curves.OtfModel`: a mean over forms.

    Parameters
    ----------
    forms : tuple of WeightedForm
        The one of largest weight first.
    birge_ratio : float
        Factor by which every standard deviation was widened: 1 where the measurements agree.
    """

    forms: tuple[WeightedForm, ...]
    birge_ratio: float

    def packed(self) -> CombinedOtf:
        """The same OTF in fewer bytes, its correlations rounded."""
        return replace(self, forms=tuple(one.packed() for one in self.forms))

    @property
    def best(self) -> WeightedForm:
        """The form with the largest weight."""
        return self.forms[0]

    @property
    def correction_share(self) -> float:
        """Mean standard deviation of the correction, a share of the logarithm of the OTF."""
        return sum(one.weight * one.share for one in self.forms)

    @property
    def numbers(self) -> dict[str, Estimate]:
        """Parameters of the best form."""
        return self.best.numbers(self.birge_ratio)

    @property
    def band_cpp(self) -> float:
        """Highest frequency that is transferred."""
        sigma = min(one.form.min_sigma_px(one.parameters) for one in self.forms)
        return float(np.clip(0.8 / max(sigma, 1e-3), 3.0, 6.0))

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Mean OTF over the forms, (n,), exactly 1 at zero frequency."""
        return np.concatenate([some.mean for some in self._on_parts(u_cpp, v_cpp)])

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k): that of each form, and their differences."""
        found = np.concatenate([self._factor_on(one) for one in self._on_parts(u_cpp, v_cpp)])
        found[(u_cpp == 0) & (v_cpp == 0)] = 0.0
        return found

    def _factor_on(self, forms: FormsOnPlane) -> Complexes:
        parts = []
        for one, otf, slopes in zip(self.forms, forms.otfs, forms.slopes, strict=True):
            own = np.concatenate([slopes @ one.root, (otf - forms.mean)[:, None]], axis=1)
            parts.append(math.sqrt(one.weight) * own)
        return np.asarray(self.birge_ratio * np.concatenate(parts, axis=1))

    def _on_parts(self, u_cpp: Floats, v_cpp: Floats) -> Iterator[FormsOnPlane]:
        """The forms at some of the places after others: of a whole plane they fill memory."""
        for first in range(0, max(u_cpp.size, 1), _AT_ONCE):
            some = slice(first, first + _AT_ONCE)
            yield FormsOnPlane(self.forms, Plane(u_cpp[some], v_cpp[some]))
