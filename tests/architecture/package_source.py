"""The package's own source, read without importing it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import acutance

ROOT = Path(acutance.__file__).parent
MODULES = sorted(path.relative_to(ROOT).as_posix() for path in ROOT.rglob("*.py"))


@dataclass(frozen=True)
class Import:
    """One imported module, and where it is imported."""

    importer: str
    line: int
    target: str

    def __str__(self) -> str:
        return f"{self.importer}:{self.line} imports {self.target}"


def dotted_name(module: str) -> str:
    """``acutance.geometry.line`` of ``geometry/line.py``."""
    parts = ["acutance", *module.removesuffix(".py").split("/")]
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def imports_of(module: str) -> tuple[Import, ...]:
    """Every import of a module, at its top, in functions and for type checking."""
    return tuple(_imports_of(module))


def _imports_of(module: str) -> Iterator[Import]:
    tree = ast.parse((ROOT / module).read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.level:
            names = ["." * node.level + (node.module or "")]
        elif isinstance(node, ast.ImportFrom) and node.module == "acutance":
            names = [f"acutance.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [node.module or ""]
        else:
            continue
        for name in names:
            yield Import(module, node.lineno, name)


def all_imports() -> Iterator[Import]:
    for module in MODULES:
        yield from imports_of(module)
