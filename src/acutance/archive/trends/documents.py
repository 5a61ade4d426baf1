"""The posterior of a trend as a document, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from acutance.archive.trends.design import Design
from acutance.archive.trends.posterior import TrendPosterior
from acutance.archive.trends.series import Event
from acutance.curves.grid import Floats
from acutance.targets.record import strict_json

__all__ = ["posterior_document", "read_posterior"]

_COLUMNS = ("share", "mode", "scatter", "degrees", "step_low", "step_high", "hypothesis")


def posterior_document(posterior: TrendPosterior) -> dict[str, Any]:
    """All densities as strict JSON types; of the covariances the lower triangles."""
    rows, cols = np.tril_indices(posterior.mode.shape[1])
    document: dict[str, Any] = strict_json({
        "unit": posterior.unit,
        "target_std": posterior.target_std,
        "targets": posterior.targets,
        "centre": posterior.design.centre,
        "events": [
            {"when": str(event.when), "name": event.name, "changes_drift": event.changes_drift}
            for event in posterior.design.events
        ],
        "drifts": posterior.drifts.tolist(),
        "has_season": posterior.has_season.tolist(),
        **{name: getattr(posterior, name).tolist() for name in _COLUMNS},
        "covariance": posterior.covariance[:, rows, cols].tolist(),
    })  # fmt: skip
    return document


def read_posterior(document: Mapping[str, Any]) -> TrendPosterior:
    """The posterior that `posterior_document` wrote."""
    columns: dict[str, Floats] = {
        name: np.array(document[name], dtype=object).astype(float) for name in _COLUMNS
    }
    size = columns["mode"].shape[1]
    rows, cols = np.tril_indices(size)
    covariance = np.zeros((columns["share"].size, size, size))
    covariance[:, rows, cols] = document["covariance"]
    covariance[:, cols, rows] = document["covariance"]
    return TrendPosterior(
        design=Design(document["centre"], tuple(Event(**event) for event in document["events"])),
        unit=document["unit"],
        drifts=np.array(document["drifts"], bool),
        has_season=np.array(document["has_season"], bool),
        covariance=covariance,
        # Documents of earlier versions know of no targets.
        target_std=document.get("target_std", 0.0),
        targets=document.get("targets", 1.0),
        **columns,
    )
