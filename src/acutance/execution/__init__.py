"""Independent tasks: the only room that starts processes, or hands work to those of others.

`processes` (the cores of this machine), `cluster` (a dask scheduler that is running somewhere; only
here: dask), `interrupts`.
"""

from acutance.execution.cluster import run_on_cluster
from acutance.execution.interrupts import interruptible, was_interrupted
from acutance.execution.processes import is_ending, require_workers, results_in_turn, run_tasks

__all__ = [
    "interruptible",
    "is_ending",
    "require_workers",
    "results_in_turn",
    "run_on_cluster",
    "run_tasks",
    "was_interrupted",
]
