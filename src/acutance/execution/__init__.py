"""Independent tasks: the only room that starts processes, or hands work to those of others.

`processes` (the cores of this machine), `cluster` (a dask scheduler that is running somewhere; only
here: dask), `interrupts`; `partial_folder` (files that are whole or not there, whatever ends the
process that writes them).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.names_on_use import names_on_use

if TYPE_CHECKING:
    from acutance.execution.cluster import run_on_cluster
    from acutance.execution.interrupts import interruptible, was_interrupted
    from acutance.execution.processes import (
        is_ending,
        require_workers,
        results_in_turn,
        run_tasks,
    )

__all__ = [
    "interruptible",
    "is_ending",
    "require_workers",
    "results_in_turn",
    "run_on_cluster",
    "run_tasks",
    "was_interrupted",
]

# The modules are loaded when a name is first used: who writes a file starts no processes.
_HOMES = {
    "interruptible": "interrupts",
    "is_ending": "processes",
    "require_workers": "processes",
    "results_in_turn": "processes",
    "run_on_cluster": "cluster",
    "run_tasks": "processes",
    "was_interrupted": "interrupts",
}

__getattr__ = names_on_use(__name__, _HOMES)
