"""Loops over pixels and samples, compiled to machine code.

A chain of array operations reads and writes every intermediate array; a loop that does the same
work for one pixel after another keeps them in registers. Such loops are compiled by numba when
they are first called, and kept in a folder of the user's, so that other processes load them:
the first calls of a fresh installation take some thirty seconds longer.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

__all__ = ["compiled", "inlined"]

_F = TypeVar("_F", bound=Callable[..., Any])
_OPTIONS: dict[str, Any] = {
    "nogil": True,
    # Nothing calls them back from C: without that entry they are loaded a tenth faster.
    "no_cfunc_wrapper": True,
    "error_model": "numpy",
    "fastmath": {"reassoc", "contract"},
}


def compiled(function: _F) -> _F:
    """A function of numbers and arrays, compiled for the types it is called with.

    Sums may be taken in another order than written (they are vectorised), so results may differ
    between processors in the last digits. Division by zero gives infinities, as in numpy.
    Constants and inlined functions of other modules become part of it, and a change of them goes
    unseen: it wants a `make clean`.
    """
    return cast(_F, numba.njit(function, cache=True, **_OPTIONS))


def inlined(function: _F) -> _F:
    """A short function of numbers that becomes part of the compiled loops that call it.

    A loop that calls nothing is vectorised: the processor takes several pixels at once.
    """
    return cast(_F, numba.njit(function, forceinline=True, **_OPTIONS))
