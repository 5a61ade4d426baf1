"""Loops over pixels and samples, compiled to machine code.

A chain of array operations reads and writes every intermediate array; a loop that does the same
work for one pixel after another keeps them in registers. Such loops are compiled by numba when
they are first called, and kept in a folder of the user's, so that other processes load them:
the first calls of a fresh installation take some thirty seconds longer, which the logger "acutance"
notes.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import event

__all__ = ["compiled", "inlined"]

_F = TypeVar("_F", bound=Callable[..., Any])
_OPTIONS: dict[str, Any] = {
    "nogil": True,
    # Nothing calls them back from C: without that entry they are loaded a tenth faster.
    "no_cfunc_wrapper": True,
    "error_model": "numpy",
    "fastmath": {"reassoc", "contract"},
}


class _FirstCompilation(event.Listener):
    """Notes once that loops are compiled which no earlier process has left in the folder."""

    def __init__(self) -> None:
        self._is_noted = False

    def on_start(self, found: Any) -> None:
        loop = found.data["dispatcher"]
        folder, module = loop.stats.cache_path, loop.py_func.__module__
        # Inlined functions have no folder; other packages of the process have loops of their own.
        if self._is_noted or folder is None or not module.startswith("acutance."):
            return
        # New types of a known loop take a second or two: nothing to be told of.
        if not any(Path(folder).glob("*.nbi")):
            self._is_noted = True
            logging.getLogger("acutance").info(
                "compiling loops once, some 30 s; later starts load them"
            )

    def on_end(self, found: Any) -> None:
        pass


cast(Any, event).register("numba:compile", _FirstCompilation())


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
