"""Trials of a study over all cores: the only module that starts processes."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from acutance.errors import OptionError
from acutance.studies.journal import Journal, journal_key

__all__ = ["Execution", "Measure", "Record", "run_trials", "trial_rng"]

Options = TypeVar("Options")
Trial = TypeVar("Trial")

Record = dict[str, Any]
Measure = Callable[[Options, Trial, np.random.Generator], Record]
Chunk = list[tuple[int, Record]]

_LIBRARIES = ("OPENBLAS", "OMP", "MKL")
_CHUNKS_PER_WORKER = 8
_MOST_IN_A_CHUNK = 16


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
    After Ctrl-C the message of the KeyboardInterrupt says what is kept.
    """
    from acutance import __version__

    journal: Any = nullcontext()
    if execution.folder is not None:
        key = journal_key(study, options, execution.seed, __version__)
        journal = Journal(execution.folder, study, key)
    with journal as kept:
        earlier: dict[int, Record] = {} if kept is None else kept.done
        done = {i: earlier[i] for i in range(len(trials)) if i in earlier}
        todo = [i for i in range(len(trials)) if i not in done]
        _tell(execution, len(trials) - len(todo), len(trials))

        def keep(chunk: Chunk) -> None:
            for index, record in chunk:
                if index not in done:
                    if kept is not None:
                        kept.append(index, record)
                    done[index] = record
            _tell(execution, len(done), len(trials))

        try:
            _run(options, trials, measure, execution, todo, keep)
        except KeyboardInterrupt:
            path = None if kept is None else kept.path
            raise KeyboardInterrupt(_interruption(len(done), len(trials), path)) from None
    return [done[i] for i in range(len(trials))]


def _tell(execution: Execution, done: int, total: int) -> None:
    if execution.progress is not None:
        execution.progress(done, total)


def _interruption(done: int, total: int, path: Path | None) -> str:
    if path is None:
        return "interrupted"
    return (
        f"interrupted: {done} of {total} trials are kept in {path}; run the same command again to "
        "go on"
    )


def _run(
    options: Options,
    trials: Sequence[Trial],
    measure: Measure[Options, Trial],
    execution: Execution,
    todo: Sequence[int],
    keep: Callable[[Chunk], None],
) -> None:
    """Hand finished trials to `keep`, chunk by chunk, as they come."""
    workers = execution.workers or os.cpu_count() or 1
    workers = min(workers, len(todo))
    seed = execution.seed
    if workers <= 1:
        for i in todo:
            keep(_work(options, measure, seed, [(i, trials[i])]))
        return
    size = max(1, min(_MOST_IN_A_CHUNK, len(todo) // (_CHUNKS_PER_WORKER * workers)))
    chunks = [todo[k : k + size] for k in range(0, len(todo), size)]
    # Fresh processes read the number of threads when they load the libraries.
    context = get_context("spawn")
    stop = context.Event()
    with (
        _one_thread_each(),
        ProcessPoolExecutor(
            workers, mp_context=context, initializer=_obey_parent, initargs=(stop,)
        ) as pool,
    ):
        futures: list[Future[Chunk]] = []
        try:
            with _interrupts_held_back():
                futures += (
                    pool.submit(_work, options, measure, seed, [(i, trials[i]) for i in chunk])
                    for chunk in chunks
                )
            for future in as_completed(futures):
                keep(future.result())
        except BaseException:
            stop.set()
            pool.shutdown(cancel_futures=True)
            # What the processes had finished when they were stopped is not to be done again.
            for future in futures:
                if not future.cancelled() and future.exception() is None:
                    keep(future.result())
            raise


@contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """Let Ctrl-C wait; processes started meanwhile never hear of it, not even while they load."""
    if sys.platform == "win32":
        yield
        return
    earlier = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    # Another thread may catch it for this one: then it is only noted here.
    heard: list[int] = []
    is_main = threading.current_thread() is threading.main_thread()
    handler = signal.getsignal(signal.SIGINT) if is_main else None
    if handler is not None:
        signal.signal(signal.SIGINT, lambda number, _: heard.append(number))
    try:
        yield
    finally:
        if handler is not None:
            signal.signal(signal.SIGINT, handler)
        signal.pthread_sigmask(signal.SIG_SETMASK, earlier)
    if heard:
        signal.raise_signal(signal.SIGINT)


_stop: Event | None = None
"""In a worker process: set when no further trial is wanted."""


def _obey_parent(stop: Event) -> None:
    """Leave interrupts to the parent process, and end when it has ended, however it did."""
    global _stop
    _stop = stop
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _work(
    options: Options,
    measure: Measure[Options, Trial],
    seed: int,
    chunk: Sequence[tuple[int, Trial]],
) -> Chunk:
    """Finished trials of the chunk: all of them, unless the parent process wants no more."""
    finished: Chunk = []
    for i, trial in chunk:
        if _stop is not None and _stop.is_set():
            break
        finished.append((i, measure(options, trial, trial_rng(seed, i))))
    return finished


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """The environment in which processes keep to one core each; afterwards as it was."""
    names = [f"{library}_NUM_THREADS" for library in _LIBRARIES]
    earlier = {name: os.environ.get(name) for name in names}
    os.environ.update(dict.fromkeys(names, "1"))
    try:
        yield
    finally:
        for name, value in earlier.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
