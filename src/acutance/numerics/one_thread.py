"""One thread for many small matrices.

Every fit solves dozens of systems of some fifty to some hundred unknowns. Shared among threads
each of them takes longer than alone: 20 sources four times as long on two cores, an edge six times
when another program needs one of them. Several cores are used best by measuring several images at
once.
"""

from __future__ import annotations

from collections.abc import Callable
from contextvars import ContextVar
from functools import cache, wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import LibController, ThreadpoolController

__all__ = ["one_thread"]

Given = ParamSpec("Given")
Result = TypeVar("Result")
_IS_ALONE: ContextVar[bool] = ContextVar("is_alone", default=False)


def one_thread(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """The same function, during which linear algebra keeps to one thread."""

    @wraps(function)
    def alone(*args: Given.args, **options: Given.kwargs) -> Result:
        if _IS_ALONE.get():
            return function(*args, **options)
        outside = _IS_ALONE.set(True)
        try:
            threads = [(one, one.get_num_threads()) for one in _linear_algebra()]
            several = [(library, count) for library, count in threads if count > 1]
            for library, _ in several:
                library.set_num_threads(1)
            try:
                return function(*args, **options)
            finally:
                for library, count in several:
                    library.set_num_threads(count)
        finally:
            _IS_ALONE.reset(outside)

    return alone


@cache
def _linear_algebra() -> tuple[LibController, ...]:
    """The libraries with threads of their own; looking for them takes some milliseconds."""
    return tuple(ThreadpoolController().select(user_api="blas").lib_controllers)
