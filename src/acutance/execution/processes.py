"""Independent tasks over all cores of this machine."""

from __future__ import annotations

import atexit
import gc
import os
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import Future, InvalidStateError, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from itertools import islice
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection
from typing import Generic, TypeVar

from acutance.errors import OptionError, WorkerError
from acutance.execution.interrupts import interruptible

__all__ = ["is_ending", "require_workers", "results_in_turn", "run_tasks"]

Task = TypeVar("Task")
Result = TypeVar("Result")

_LIBRARIES = ("OPENBLAS", "OMP", "MKL")
_LEAKS = "ignore:resource_tracker:UserWarning"
_CHUNKS_PER_WORKER = 8
_MAX_CHUNK = 8
_GRACE_S = 2.0
"""For the tasks in work when a run is ended."""
_KILLED = (
    "a worker process was killed, most likely for want of memory: use fewer (--workers, workers=). "
    "Where results are kept as they come (--keep, --out FOLDER, the archive of a batch) the same "
    "command goes on where it was. A script of your own has to guard its start by "
    'if __name__ == "__main__"'
)
_WAITING_PER_WORKER = 16
"""Tasks that are handed out before the first of them is waited for."""


def require_workers(workers: int) -> None:
    """Refuse a number of processes that means nothing.

    Raises
    ------
    OptionError
        If it is no number of processes.
    """
    if isinstance(workers, bool) or not isinstance(workers, int) or workers < 1:
        raise OptionError(f"workers is {workers!r}: give the number of processes, 1 or more")


def run_tasks(
    work: Callable[[Task], Result],
    tasks: Sequence[Task],
    keep: Callable[[int, Result], None],
    *,
    workers: int | None = None,
    chunk: int | None = None,
) -> None:
    """Hand the result of every task to `keep` as soon as it is there, in any order.

    An exception of a task, or Ctrl-C, ends the run; results that were finished by then, or within
    two seconds, have been handed to `keep`. The one at which `keep` itself was interrupted is
    handed to it again.

    Parameters
    ----------
    work : function of a task
        At the top of a module (or a ``functools.partial`` of one), so that other processes find
        it.
    tasks : sequence
    keep : function of (place of the task, result)
        Runs in this process.
    workers : int, optional
        Processes, each on one core; 1 stays in this process. All cores unless given. With more
        than one, a script has to guard its own start by ``if __name__ == "__main__"``.
    chunk : int, optional
        Tasks that a process is handed at once: 1 of long tasks, so that few occupy all processes.
        Without it their number decides.

    Raises
    ------
    WorkerError
        If one of the processes was killed.
    OptionError
        If it is no number of processes.
    """
    if workers is not None:
        require_workers(workers)
    used = min(workers or os.cpu_count() or 1, len(tasks))
    if used > 1:
        _run_in_processes(work, tasks, keep, used, chunk)
        return
    for place, task in enumerate(tasks):
        with interruptible():
            result = work(task)
        keep(place, result)


def _run_in_processes(
    work: Callable[[Task], Result],
    tasks: Sequence[Task],
    keep: Callable[[int, Result], None],
    workers: int,
    chunk: int | None,
) -> None:
    size = chunk or max(1, min(_MAX_CHUNK, len(tasks) // (_CHUNKS_PER_WORKER * workers)))
    starts = range(0, len(tasks), size)
    started: dict[Future[list[Result]], int] = {}
    kept: set[int] = set()

    def keep_all(future: Future[list[Result]]) -> None:
        for place, result in enumerate(future.result(), start=started[future]):
            if place not in kept:
                keep(place, result)
                kept.add(place)

    try:
        with _processes(workers) as pool:
            with _interrupts_held_back():
                for first in starts:
                    some = tasks[first : first + size]
                    started[_submitted(pool, work, some)] = first
            for future in as_completed(started):
                keep_all(future)
                # What was kept is not to fill the memory of a long run.
                del started[future]
    except BaseException:
        # What the processes had finished when they were stopped is not to be done again.
        for future in list(started):
            if not future.cancelled() and future.exception() is None:
                keep_all(future)
        raise


class _Cancellable(Future[Result]):
    """Results that may be cancelled while the pool breaks."""

    def set_exception(self, exception: BaseException | None) -> None:
        # Before Python 3.12.1 the pool's own thread ends with a traceback.
        with suppress(InvalidStateError):
            super().set_exception(exception)


def _submitted(
    pool: ProcessPoolExecutor, work: Callable[[Task], Result], tasks: Sequence[Task]
) -> Future[list[Result]]:
    future = pool.submit(_work_through, work, list(tasks))
    future.__class__ = _Cancellable
    return future


@contextmanager
def _processes(workers: int) -> Iterator[ProcessPoolExecutor]:
    """A pool of processes on one core each, which begin no further task once a run has failed.

    Raises
    ------
    WorkerError
        If one of them was killed.
    """
    # Fresh processes read the number of threads when they load the libraries.
    context = get_context("spawn")
    with ExitStack() as stack:
        # What a pool is made of is loaded only now: an interrupt in an import may be lost.
        with _interrupts_held_back():
            # Its end is the sign to stop: nothing that a killed process could hold locked.
            heard, held = map(stack.enter_context, context.Pipe(duplex=False))
            stack.enter_context(_environment_of_processes())
            pool = stack.enter_context(
                ProcessPoolExecutor(
                    workers, mp_context=context, initializer=_obey_parent, initargs=(heard,)
                )
            )
        try:
            yield pool
        except BaseException as error:
            held.close()
            pool.shutdown(cancel_futures=True)
            # The library's words tell neither why it happens nor what to do.
            if isinstance(error, BrokenProcessPool):
                raise WorkerError(_KILLED) from error
            raise


def results_in_turn(
    work: Callable[[Task], Result], tasks: Iterable[Task], *, workers: int = 1
) -> Generator[Result, None, None]:
    """The result of every task, in the order of the tasks, as soon as it is there.

    Tasks are taken as they are needed, and few results wait: memory stays flat however many there
    are. An exception of a task, or Ctrl-C, ends the run, and so does closing the generator. This
    process is one of the workers: it begins at once, while others still load what they need.

    Parameters
    ----------
    work : function of a task
        As of `run_tasks`.
    tasks : iterable
    workers : int, optional
        As of `run_tasks`.

    Raises
    ------
    WorkerError
        As of `run_tasks`.
    """
    if workers < 2:
        for task in tasks:
            with interruptible():
                result = work(task)
            yield result
        return
    todo = iter(tasks)
    # The first is for this process, which has nothing to load.
    waiting = deque(_Waiting[Task, Result](task, Future()) for task in islice(todo, 1))
    with _processes(workers - 1) as pool:
        while waiting:
            with _interrupts_held_back():
                for task in islice(todo, _WAITING_PER_WORKER * workers - len(waiting)):
                    waiting.append(_Waiting(task, _submitted(pool, work, [task])))
            if waiting[0].results.done() or not _work_here(work, waiting):
                yield from waiting.popleft().results.result()


@dataclass
class _Waiting(Generic[Task, Result]):
    """A task of a run, and where its result will be."""

    task: Task
    results: Future[list[Result]]


def _work_here(work: Callable[[Task], Result], waiting: Iterable[_Waiting[Task, Result]]) -> bool:
    """Do in this process the first task that no other has begun; whether there was one."""
    for one in waiting:
        if one.results.cancel():
            one.results = Future()
            try:
                with interruptible():
                    one.results.set_result([work(one.task)])
            except Exception as error:
                # It comes after the results before it.
                one.results.set_exception(error)
            return True
    return False


@contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """Let Ctrl-C wait; processes started meanwhile never receive it, not even while they load."""
    if sys.platform == "win32":
        yield
        return
    earlier = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    # Another thread may catch it for this one: then it is only noted here.
    received: list[int] = []
    is_main = threading.current_thread() is threading.main_thread()
    handler = signal.getsignal(signal.SIGINT) if is_main else None
    if handler is not None:
        signal.signal(signal.SIGINT, lambda number, _: received.append(number))
    try:
        yield
    finally:
        if handler is not None:
            signal.signal(signal.SIGINT, handler)
        signal.pthread_sigmask(signal.SIG_SETMASK, earlier)
    if received:
        signal.raise_signal(signal.SIGINT)


_stop = threading.Event()
"""In a worker process: set when no further task is to be begun."""
_at_work = False
_work_lock = threading.Lock()
"""Of `_at_work`: a process never ends between its work and the sending of the result."""


def is_ending() -> bool:
    """In a worker process: whether its run has ended, and a task is to come to its end."""
    return _stop.is_set()


def _obey_parent(heard: Connection) -> None:
    """Leave interrupts to the parent process, and end when it has ended, however it did."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # The parent waits for the end: nothing is looked through once more for unused memory.
    atexit.register(gc.freeze)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    threading.Thread(target=_end_with_run, daemon=True, args=(heard,)).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _end_with_run(heard: Connection) -> None:
    """Leave a task that takes longer than a user waits after Ctrl-C."""
    with suppress(EOFError, OSError):
        heard.recv()
    _stop.set()
    time.sleep(_GRACE_S)
    with _work_lock:
        if _at_work:
            os._exit(1)


def _set_at_work(value: bool) -> None:
    global _at_work
    with _work_lock:
        _at_work = value


def _work_through(work: Callable[[Task], Result], chunk: Sequence[Task]) -> list[Result]:
    """Results of a chunk's tasks, up to the one at which the parent process ended the run."""
    finished: list[Result] = []
    _set_at_work(True)
    try:
        for task in chunk:
            if is_ending():
                break
            finished.append(work(task))
    finally:
        _set_at_work(False)
    return finished


@contextmanager
def _environment_of_processes() -> Iterator[None]:
    """The environment in which processes keep to one core each; afterwards as it was.

    Where this process is killed, what it shared with them is cleared away without a word.
    """
    changes = {f"{library}_NUM_THREADS": "1" for library in _LIBRARIES}
    warnings = os.environ.get("PYTHONWARNINGS")
    changes["PYTHONWARNINGS"] = f"{warnings},{_LEAKS}" if warnings else _LEAKS
    earlier = {name: os.environ.get(name) for name in changes}
    os.environ.update(changes)
    try:
        yield
    finally:
        for name, value in earlier.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
