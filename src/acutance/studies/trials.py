"""Trials of a study: each with random numbers of its own, finished ones kept on disk."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from acutance.errors import OptionError
from acutance.execution import run_tasks
from acutance.studies.journal import Journal, journal_key

__all__ = ["Execution", "Measure", "Record", "run_trials", "trial_rng"]

Options = TypeVar("Options")
Trial = TypeVar("Trial")

Record = dict[str, Any]
Measure = Callable[[Options, Trial, np.random.Generator], Record]


@dataclass(frozen=True)
class Execution:
    """How a study is run; nothing here changes its results but the seed.

    Parameters
    ----------
    seed : int, optional
        Every trial draws from its own stream of this seed.
    workers : int, optional
        Processes; 1 stays in this process. All cores unless given. With more than one, a script
        has to guard its own start by ``if __name__ == "__main__"``.
    folder : Path, optional
        Where finished trials are kept, so that an interrupted study goes on.
    progress : function of (done, total), optional
        Called whenever trials have finished.

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    seed: int = 2005
    workers: int | None = None
    folder: Path | None = None
    progress: Callable[[int, int], None] | None = None

    def __post_init__(self) -> None:
        if self.seed < 0 or (self.workers is not None and self.workers < 1):
            raise OptionError(
                f"seed is {self.seed} and workers is {self.workers}: the seed has to be 0 or "
                "more, and there has to be a worker"
            )


def trial_rng(seed: int, index: int) -> np.random.Generator:
    """The stream of random numbers of one trial, whatever process it runs in."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index,)))


def run_trials(
    study: str,
    options: Options,
    trials: Sequence[Trial],
    measure: Measure[Options, Trial],
    execution: Execution,
) -> list[Record]:
    """Results of `measure` for all trials, in their order.

    Parameters
    ----------
    study : str
        Names the journal.
    options : frozen dataclass
        Handed to `measure`, and part of the journal's key.
    trials : sequence
        What differs between trials.
    measure : function of (options, trial, rng)
        At the top of a module, so that other processes find it; gives numbers by name.
    execution : Execution

    Notes
    -----
    After Ctrl-C the message of the KeyboardInterrupt names the journal with the finished trials.
    """
    from acutance import __version__

    journal: Any = nullcontext()
    if execution.folder is not None:
        key = journal_key(study, options, execution.seed, __version__)
        journal = Journal(execution.folder, study, key)
    with journal as kept:
        earlier: dict[int, Record] = {} if kept is None else kept.done
        done = {i: earlier[i] for i in range(len(trials)) if i in earlier}
        todo = [(i, trials[i]) for i in range(len(trials)) if i not in done]
        _report(execution, len(done), len(trials))

        def keep(place: int, record: Record) -> None:
            index = todo[place][0]
            if index in done:
                return
            if kept is not None:
                kept.append(index, record)
            done[index] = record
            _report(execution, len(done), len(trials))

        try:
            run_tasks(partial(_measured, options, measure, execution.seed), todo, keep,
                      workers=execution.workers)  # fmt: skip
        except KeyboardInterrupt:
            path = None if kept is None else kept.path
            raise KeyboardInterrupt(_interruption(len(done), len(trials), path)) from None
    return [done[i] for i in range(len(trials))]


def _measured(
    options: Options, measure: Measure[Options, Trial], seed: int, numbered: tuple[int, Trial]
) -> Record:
    index, trial = numbered
    return measure(options, trial, trial_rng(seed, index))


def _report(execution: Execution, done: int, total: int) -> None:
    if execution.progress is not None:
        execution.progress(done, total)


def _interruption(done: int, total: int, path: Path | None) -> str:
    if path is None:
        return "interrupted"
    return (
        f"interrupted: {done} of {total} trials are kept in {path}; run the same command again to "
        "go on"
    )
