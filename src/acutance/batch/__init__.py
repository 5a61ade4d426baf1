"""Many images, many targets: each measured or rejected with its reason, kept in an archive, once.

In the order the data take: `plan` (what is wanted, of a TOML file or of arguments; `plan_options`,
the options of the kinds), `image_list` (files and their contents, by `remembered_images`),
`row_key` (what is done is not done again), then in the workers `measure_image` (one image, all its
targets), with `place_target` (where the survey says it is, or why not here), `find_line` and
`find_points` (the target near that place) and `measure_target` (by kind); `entries` (rows for the
archive), `whole_batch` (all of it, by `spread_images`) and `summary` (what came out,
by `reason_words`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.names_on_use import names_on_use

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

__getattr__ = names_on_use(__name__, _HOMES)
