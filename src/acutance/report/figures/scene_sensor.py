"""The sensor of a scene beside its edges, at Nyquist: along their normals, at their places."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.report.labels import word_softness

if TYPE_CHECKING:
    from acutance.scan import SceneMeasurement

__all__ = ["EdgesSeen", "behind_words", "edges_seen", "sensor_along"]


class EdgesSeen(NamedTuple):
    """Used edges beside the sensor, (n,) arrays; those without an MTF are left out.

    Attributes
    ----------
    row, col, normal_deg, length_px : arrays
    mtf, std : arrays
        At Nyquist, of sensor and object together.
    ideal : array
        Probability that the object is.
    sensor : array
        MTF at Nyquist of the sensor at the place of the edge, along its normal; softness that is
        stated of all objects is part of it, as it is of the edges.
    """

    row: Floats
    col: Floats
    normal_deg: Floats
    length_px: Floats
    mtf: Floats
    std: Floats
    ideal: Floats
    sensor: Floats

    @property
    def off(self) -> Floats:
        """Edge minus sensor."""
        return np.asarray(self.mtf - self.sensor)


def edges_seen(measurement: SceneMeasurement) -> EdgesSeen:
    """The used edges of a scene, and the sensor where each of them lies."""
    edges = measurement.edges
    own = edges.used & np.isfinite(edges.mtf_nyquist) & (edges.mtf_nyquist_std > 0)
    row, col, normal_deg = edges.row[own], edges.col[own], edges.normal_deg[own]
    return EdgesSeen(
        row, col, normal_deg, edges.length_px[own], edges.mtf_nyquist[own],
        edges.mtf_nyquist_std[own], edges.ideal[own],
        measurement.mtf_nyquist_seen(row, col, normal_deg),
    )  # fmt: skip


def behind_words(measurement: SceneMeasurement) -> str:
    """Of captions that compare edges with the sensor: what was stated lies before both."""
    softness = word_softness(measurement.options)
    if not softness:
        return ""
    return f" The sensor is seen behind the {softness} of softness stated of all objects, too."


def sensor_along(measurement: SceneMeasurement, normal_deg: Floats) -> tuple[Floats, Floats]:
    """MTF at Nyquist along normals (n,), the mean over the field, and its standard deviation."""
    angle, model = np.radians(normal_deg), measurement.otf.model
    u, v = NYQUIST_CPP * np.cos(angle), NYQUIST_CPP * np.sin(angle)
    otf, factor = model.otf(u, v), model.factor(u, v)
    modulus = np.abs(otf)
    along = (np.conj(otf) / np.maximum(modulus, 1e-12))[:, None] * factor
    return modulus, np.sqrt(np.sum(along.real**2, axis=1))
