"""Is a scene rich enough to tell the sensor from its objects, and do its edges agree?"""

from __future__ import annotations

from itertools import product

import numpy as np

from acutance.curves.metrics import NYQUIST_CPP
from acutance.scan.field import Field
from acutance.scan.scene_edges import SceneEdges
from acutance.scan.sensor_fit import SensorFit
from acutance.targets.check import Check, Limits, answer

__all__ = ["SCENE_CHECKS", "check_scene"]

SCENE_CHECKS = (
    "edges_used", "scene_directions", "ideal_share", "strange_share", "scene_settled",
    "field_change",
)  # fmt: skip
"""Names of all checks of a scene."""

_DIRECTION_DEG = 15.0


def check_scene(
    edges: SceneEdges, fit: SensorFit, field: Field, limits: Limits
) -> tuple[Check, ...]:
    """All checks of a scene.

    Parameters
    ----------
    edges : SceneEdges
    fit : SensorFit
    field : Field
    limits : mapping of str to float
        Limits the caller changed.
    """
    used = int(edges.used.sum())
    directions = np.unique(np.floor(fit.normal_deg / _DIRECTION_DEG)).size
    (ideal, ideal_std), (strange, _) = fit.kinds["ideal"], fit.kinds["strange"]
    change = _largest_change(fit, field)
    return (
        answer(
            "edges_used", used,
            f"{used} of the {edges.size} edges that were found are used: {_verdicts(edges)}",
            limits,
        ),
        answer(
            "scene_directions", directions,
            f"their normals lie in {directions} of 12 directions of 15 degrees each", limits,
        ),
        answer(
            "ideal_share", ideal,
            f"{100 * ideal:.0f} ± {100 * ideal_std:.0f} % of the objects are as "
            "sharp as the sensor can show", limits,
        ),
        answer(
            "strange_share", strange,
            f"{100 * strange:.1f} % of the edges are neither ideal nor soft ones of this sensor",
            limits,
        ),
        answer(
            "scene_settled", 0.0 if fit.settled else 1.0,
            f"sensor and objects were fitted in {fit.turns} turns"
            + ("" if fit.settled else ", and did not settle"), limits,
        ),
        answer(
            "field_change", change,
            f"the MTF at Nyquist differs by up to {100 * change:.0f} % of its mean over the field; "
            f"the chance that it is the same everywhere is {field.chance_constant:.2g}", limits,
        ),
    )  # fmt: skip


def _largest_change(fit: SensorFit, field: Field) -> float:
    """Largest difference of the MTF at Nyquist in the corners from its mean, a share of it."""
    u, v = NYQUIST_CPP * np.array([1.0, 0.0]), NYQUIST_CPP * np.array([0.0, 1.0])
    mean = np.abs(field.mean_of(fit.otf).otf(u, v))
    row, col, height, width = field.roi
    corners = product((row, row + height - 1), (col, col + width - 1))
    found = [np.abs(field.at(fit.otf, *corner).otf(u, v)) / mean - 1 for corner in corners]
    return float(np.abs(found).max())


def _verdicts(edges: SceneEdges) -> str:
    """How many edges have which verdict."""
    words, counts = np.unique(edges.verdict, return_counts=True)
    order = ("good", "usable", "doubtful", "invalid", "rejected")
    known = dict(zip(words.tolist(), counts.tolist(), strict=True))
    return ", ".join(f"{known[word]} {word}" for word in order if word in known)
