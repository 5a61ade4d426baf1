"""Independent tasks on an existing cluster, by way of its dask scheduler."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any, NamedTuple, TypeVar

from acutance.errors import AcutanceError, OptionError

__all__ = ["run_on_cluster"]

Task = TypeVar("Task")
Result = TypeVar("Result")

_PATIENCE_S = 20
"""For the scheduler, and for the first of its workers."""


def run_on_cluster(
    work: Callable[[Task], Result],
    tasks: Sequence[Task],
    keep: Callable[[int, Result], None],
    *,
    scheduler: str,
) -> None:
    """Hand the result of every task to `keep` as soon as it is there, in any order.

    An exception of a task, or Ctrl-C, ends the run: tasks that were not begun are taken back from
    the cluster, and results that were fetched by then have been handed to `keep`.

    Parameters
    ----------
    work : function of a task
        At the top of a module of this package (or a ``functools.partial`` of one).
    tasks : sequence
    keep : function of (place of the task, result)
        Runs in this process.
    scheduler : str
        Address of the dask scheduler: "tcp://host:8786".

    Raises
    ------
    OptionError
        If dask is not installed, the scheduler or its workers cannot be reached, they have
        another version of this package, or end in the middle of the work.
    """
    with _client(scheduler) as client:
        from distributed import as_completed
        from distributed.client import FutureCancelledError
        from distributed.scheduler import KilledWorker

        _require_version(client, scheduler)
        futures = client.map(partial(_outcome, work), tasks, pure=False)
        places = {future.key: place for place, future in enumerate(futures)}
        # Only what the cluster still works on is referred to: what was fetched is forgotten there.
        waiting = as_completed(futures)
        del futures
        try:
            for future in waiting:
                result = future.result()
                if isinstance(result, _Failure):
                    raise result.kind(result.message)
                keep(places[future.key], result)
                future.release()
        except (FutureCancelledError, KilledWorker) as error:
            raise OptionError(
                f"the cluster {scheduler} lost its work ({error}): look at its logs, and run the "
                "same again"
            ) from error
        finally:
            client.cancel(list(waiting.futures))


class _Failure(NamedTuple):
    """An error of ours on its way: what caused it in a library may not travel."""

    kind: type[AcutanceError]
    message: str


def _outcome(work: Callable[[Task], Result], task: Task) -> Result | _Failure:
    """The result of a task, or why there is none."""
    try:
        return work(task)
    except AcutanceError as error:
        return _Failure(type(error), str(error))


@contextmanager
def _client(scheduler: str) -> Iterator[Any]:
    """A connection to a scheduler.

    Raises
    ------
    OptionError
        If there is none.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise OptionError(
            f"the cluster {scheduler} needs dask, which is not installed: "
            "pip install 'acutance[dask]', or leave it out to use the cores of this machine"
        ) from error
    try:
        client = Client(scheduler, timeout=_PATIENCE_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise OptionError(
            f"the dask scheduler {scheduler} cannot be reached ({error}): give the address it "
            "prints at its start, tcp://HOST:8786"
        ) from error
    with client, client.as_current():
        yield client


def _require_version(client: Any, scheduler: str) -> None:
    """Refuse workers that would compute something else.

    Raises
    ------
    OptionError
        If there are no workers, or one of them has another version of this package or none.
    """
    from acutance import __version__

    try:
        client.wait_for_workers(1, timeout=_PATIENCE_S)
    except TimeoutError as error:
        raise OptionError(
            f"the dask scheduler {scheduler} has no workers: start one, dask worker {scheduler}"
        ) from error

    # Functions inside functions are sent as they are: workers need no package to run it.
    def installed_version() -> str | None:
        from importlib import import_module

        try:
            return str(import_module("acutance").__version__)
        except ImportError:
            return None

    for worker, found in client.run(installed_version).items():
        if found != __version__:
            has = "none" if found is None else found
            raise OptionError(
                f"the worker {worker} has acutance {has}, and this is {__version__}: install the "
                "same on all of them"
            )
