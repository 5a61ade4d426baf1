"""What the edges of a scene say of slices of its sensor, the prior of the sensor's form apart.

A scene is one more measurement of a combination. Its own numbers have the prior of the forms of
sensors (`acutance.targets.combine.sensor_forms`) already, which a combination brings, too: so what
the edges alone say is kept beside the slices (`acutance.targets.otf_likelihood`).

Edges show the transfer function along the mean directions of their bins, and as their objects and
the field blur it. A change of the slices is carried there by the smoothest waves over the
directions; about the sensor that was found nothing is. So the likelihood is largest there: what the
forms do not follow of the edges is in none of its values (`acutance.scan.form_agreement` asks it).
"""

from __future__ import annotations

from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.otf2d import OtfModel
from acutance.numerics.direction_waves import between_directions
from acutance.numerics.pivoted_root import least_squares, pivoted_root
from acutance.numerics.stacked import stacked, unstacked
from acutance.scan.sensor_fit import SensorFit
from acutance.targets.otf_likelihood import OtfLikelihood
from acutance.targets.slices import OtfSlices

__all__ = ["likelihood_of_slices"]

_UNSEEN: Final = 1.0
"""Information of combinations that edges do not show: the OTF is between 0 and 1."""
_DARK: Final = 1e-6
"""MTF below which an object's blur is no more told from the sensor's."""


def likelihood_of_slices(fit: SensorFit, model: OtfModel, slices: OtfSlices) -> OtfLikelihood:
    """The likelihood of the optical transfer function (OTF) along slices.

    Parameters
    ----------
    fit : SensorFit
    model : OtfModel
        The sensor that the scene states. The first columns of its factor are those of `fit`, the
        others errors that all edges have in common.
    slices : OtfSlices
        Of that sensor, at the frequencies of the edges.
    """
    (edges,) = fit.combined.data.curves
    assert edges.likelihood is not None
    places, bins = slices.places, fit.normal_deg.size
    behind = fit.otf.otf(*places)
    size = np.abs(slices.otf)
    # Real and positive: objects and field blur, and move nothing.
    blur = np.where(size > _DARK, np.abs(behind) / np.maximum(size, _DARK), 1.0)
    even, odd = (
        between_directions(slices.normal_deg, fit.normal_deg, odd=one) for one in (False, True)
    )
    along = behind.reshape(slices.normal_deg.size, -1)
    carried = (even @ along.real + 1j * (odd @ along.imag)).ravel()
    seen = edges.likelihood.root.reshape(bins, along.shape[1], -1)
    root = np.einsum("bm,bkr->mkr", even, seen.real) + 1j * np.einsum("bm,bkr->mkr", odd, seen.imag)
    root = blur[:, None] * root.reshape(slices.otf.size, -1)
    found = fit.otf.otf(edges.u_cpp, edges.v_cpp)
    rest = edges.likelihood.whitened(carried) - edges.likelihood.residual(found)
    errors = model.factor(*places)[:, fit.otf.factor(*places).shape[1] :]
    return _of_few_values(stacked(root), rest).with_errors(errors).of_known_light()


def _of_few_values(root: Floats, values: Floats) -> OtfLikelihood:
    """The likelihood of ``root.T @ f - values``, (2 n, k) and (k,), in the fewest values."""
    few = pivoted_root(root @ root.T, _UNSEEN)
    return OtfLikelihood(unstacked(few), np.zeros(few.shape[1]), least_squares(few, root @ values))
