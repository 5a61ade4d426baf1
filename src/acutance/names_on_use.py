"""Names of a package that are loaded when they are first used, so that importing it stays quick."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from typing import Any

__all__ = ["names_on_use"]


def names_on_use(package: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """The function ``__getattr__`` of a package whose names live in modules below it.

    Parameters
    ----------
    package : str
        Its dotted name.
    homes : mapping of str to str
        By name the module, seen from the package.

    Returns
    -------
    function of str
        Loads the module of a name and returns what it names there; `AttributeError` of others.
    """

    def load(name: str) -> Any:
        if name in homes:
            return getattr(importlib.import_module(f"{package}.{homes[name]}"), name)
        raise AttributeError(f"module {package!r} has no attribute {name!r}")

    return load
