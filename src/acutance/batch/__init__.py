"""Many images, many targets: each measured or rejected with its reason, kept in an archive, once.

In the order the data take: `plan` (what is wanted, of a TOML file or of arguments; `plan_options`,
the options of the kinds), `image_list` (files and their contents, by `remembered_images`),
`row_key` (what is done is not done again), then in the workers `measure_image` (one image, all its
targets), with `place_target` (where the survey says it is, or why not here), `find_line` and
`find_points` (the target near that place) and `measure_target` (by kind); `entries` (rows for the
archive), `whole_batch` (all of it, by `spread_images`) and `summary` (what came out).
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from acutance.batch.plan import BatchPlan, read_plan
    from acutance.batch.summary import BatchSummary
    from acutance.batch.whole_batch import run_batch

__all__ = ["BatchPlan", "BatchSummary", "read_plan", "run_batch"]

_HOMES = {
    "BatchPlan": "plan",
    "BatchSummary": "summary",
    "read_plan": "plan",
    "run_batch": "whole_batch",
}


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(f"acutance.batch.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'acutance.batch' has no attribute {name!r}")
