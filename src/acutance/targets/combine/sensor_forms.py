"""Parametric sensors: products of terms (`sensor_terms`) with diffusion and a detector.

The forms are those of `acutance.optics.FAMILIES`: what a telescope, its detector and the processing
on the ground do.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.targets.combine.detector_terms import detector_terms
from acutance.targets.combine.form_products import FormProducts
from acutance.targets.combine.plane import Plane
from acutance.targets.combine.sensor_terms import TERMS
from acutance.targets.combine.term import Term

__all__ = ["FORMS", "SCENE_FORMS", "SensorForm"]

Complexes = NDArray[np.complex128]

_OBLIQUE = {
    "upright gaussian": "gaussian", "round gaussian": "gaussian", "upright smear": "smear",
}  # fmt: skip
_GAUSSIAN_WIDTHS = ("sigma_across_px", "sigma_along_px", "sigma_minor_px")


@dataclass(frozen=True)
class SensorForm:
    """A product of terms with a rectangular detector.

    Parameters
    ----------
    terms : tuple of str
        Names in `TERMS`.
    detector_px : (float, float)
        Width of the detector across and along, in pixels.

    Examples
    --------
    >>> print(SensorForm(("gaussian", "smear"), (1.0, 1.0)).name)
    gaussian x detector x smear
    """

    terms: tuple[str, ...]
    detector_px: tuple[float, float] = (1.0, 1.0)

    def __post_init__(self) -> None:
        unknown = [name for name in self.terms if name not in TERMS]
        if unknown or not self.terms:
            raise ModelError(
                f"a sensor form was made of {', '.join(self.terms) or 'nothing'}: its terms are "
                f"{', '.join(TERMS)}"
            )

    @property
    def name(self) -> str:
        """What it is made of."""
        return " x ".join([self.terms[0], "detector", *self.terms[1:]])

    @property
    def mean(self) -> Floats:
        """Prior mean of all parameters, (p,): of terms, of diffusion, of the detector's fill."""
        return np.asarray(_alone(self).mean[0])

    @property
    def std(self) -> Floats:
        """Prior standard deviation of all parameters, (p,)."""
        return np.asarray(_alone(self).std[0])

    def otf(self, p: Floats, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF (n,), exactly 1 at zero frequency."""
        return self.otf_on(p, Plane(u_cpp, v_cpp))

    def otf_on(self, p: Floats, plane: Plane) -> Complexes:
        """OTF (n,) at places of the plane."""
        return np.asarray(self.factors_on(p, plane).prod(axis=0))

    def factors_on(self, p: Floats, plane: Plane) -> Complexes:
        """OTFs of all factors, (k, n): of terms, diffusion, and the detector at the end."""
        return np.asarray(_alone(self).factors(p[None], plane)[:, 0])

    def slopes_on(self, p: Floats, plane: Plane) -> Complexes:
        """Derivatives of the OTF by the parameters, (n, p)."""
        factors = _alone(self).factors(p[None], plane)
        return np.asarray(_alone(self).slopes(p[None], plane, factors)[0].T)

    def numbers(self, p: Floats) -> dict[str, float]:
        """The reported numbers, by name."""
        found: dict[str, float] = {}
        for term, own in self._split(p):
            found |= term.numbers(own)
        return found

    def min_sigma_px(self, p: Floats) -> float:
        """Smallest standard deviation of the Gaussian: it limits the band."""
        widths = (one for name, one in self.numbers(p).items() if name in _GAUSSIAN_WIDTHS)
        return min(widths, default=0.0)

    @property
    def begins(self) -> dict[str, int]:
        """Place of the first parameter of every term."""
        sizes = [len(TERMS[name].mean) for name in self.terms]
        return dict(zip(self.terms, accumulate(sizes, initial=0), strict=False))

    @property
    def signed(self) -> tuple[NDArray[np.intp], ...]:
        """Of terms that have such the places of parameters whose signs may all be changed."""
        return tuple(
            begin + np.array(TERMS[name].signed, np.intp)
            for name, begin in self.begins.items()
            if TERMS[name].signed
        )

    @property
    def oblique_terms(self) -> tuple[str, ...]:
        """Terms of the form in any direction that this one is a case of."""
        return tuple(_OBLIQUE.get(name, name) for name in self.terms)

    def aligned(self, p: Floats) -> tuple[tuple[SensorForm, Floats | None], ...]:
        """The same along the axes of the image, its Gaussian elliptical or round.

        Each with the parameters that are nearest to some of this form; a smear has none, since
        both of its lengths may have either sign.
        """
        first, *others = self.terms
        if first != "gaussian":
            return ()
        upright = ["upright smear" if one == "smear" else one for one in others]
        across, along, correlation = p[:3]
        widths = {
            "upright": [across, along],
            "round": [0.5 * (across + along), 0.5 * (across - along), correlation],
        }
        return tuple(
            (
                replace(self, terms=(f"{kind} gaussian", *upright)),
                None if "smear" in others else np.array([*own, *p[3:]]),
            )
            for kind, own in widths.items()
        )

    def _split(self, p: Floats) -> list[tuple[Term, Floats]]:
        found, start = [], 0
        last = detector_terms(self.detector_px).values()
        for term in (*(TERMS[name] for name in self.terms), *last):
            stop = start + len(term.mean)
            found.append((term, p[start:stop]))
            start = stop
        return found


@cache
def _alone(form: SensorForm) -> FormProducts:
    """A form beside no other."""
    return FormProducts((form.terms,), form.detector_px)


SCENE_FORMS: tuple[tuple[str, ...], ...] = (
    ("gaussian",),
    ("gaussian", "smear"),
    ("gaussian", "halo"),
    ("gaussian", "trail"),
    ("gaussian", "diffraction"),
    ("gaussian", "defocus"),
    ("gaussian", "sharpening"),
    ("gaussian", "unsharp"),
    ("gaussian", "square kernel"),
    ("gaussian", "kernel"),
    ("gaussian", "interpolation"),
    ("gaussian", "smear", "halo"),
    ("gaussian", "smear", "trail"),
    ("gaussian", "halo", "trail"),
    ("gaussian", "smear", "sharpening"),
    ("gaussian", "diffraction", "smear"),
    ("gaussian", "diffraction", "halo"),
    ("gaussian", "diffraction", "sharpening"),
    ("gaussian", "diffraction", "unsharp"),
    ("gaussian", "diffraction", "square kernel"),
    ("gaussian", "diffraction", "kernel"),
    ("gaussian", "smear", "kernel"),
    ("gaussian", "defocus", "kernel"),
    ("gaussian", "diffraction", "smear", "kernel"),
    ("gaussian", "diffraction", "interpolation"),
    ("gaussian", "defocus", "interpolation"),
    ("gaussian", "resampling"),
    ("gaussian", "smear", "resampling"),
    ("gaussian", "halo", "resampling"),
    ("gaussian", "diffraction", "resampling"),
    ("gaussian", "defocus", "resampling"),
    ("gaussian", "phase"),
    ("gaussian", "diffraction", "phase"),
    ("gaussian", "halo", "phase"),
    ("gaussian", "defocus", "phase"),
    ("gaussian", "kernel", "phase"),
    ("gaussian", "diffraction", "kernel", "phase"),
)
"""Forms that are tried under the edges of a scene, turn by turn, the simplest first."""

FORMS: tuple[tuple[str, ...], ...] = (
    *SCENE_FORMS,
    ("gaussian", "close halo"),
    ("gaussian", "astigmatism"),
    ("gaussian", "aberrated"),
    ("gaussian", "smear", "aberrated"),
    ("gaussian", "short kernel"),
    ("gaussian", "diffraction", "short kernel"),
    ("gaussian", "smear", "short kernel"),
    ("gaussian", "defocus", "sharpening"),
    ("gaussian", "defocus", "short kernel"),
    ("gaussian", "diffraction", "smear", "sharpening"),
    ("gaussian", "diffraction", "smear", "short kernel"),
    ("gaussian", "sharpening", "interpolation"),
    ("gaussian", "short kernel", "interpolation"),
    ("gaussian", "diffraction", "sharpening", "interpolation"),
    ("gaussian", "diffraction", "short kernel", "interpolation"),
    ("gaussian", "defocus", "sharpening", "interpolation"),
    ("gaussian", "sharpening", "phase"),
    ("gaussian", "short kernel", "phase"),
    ("gaussian", "diffraction", "sharpening", "phase"),
    ("gaussian", "diffraction", "short kernel", "phase"),
    ("gaussian", "defocus", "sharpening", "phase"),
    ("gaussian", "defocus", "short kernel", "phase"),
)
"""Forms that are tried of targets. Those of light kernels, and of two kinds of processing, make
the fit of a scene half as long again and its intervals hold no more often (39 small scenes)."""
