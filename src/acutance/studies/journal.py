"""Finished trials on disk, so that an interrupted study goes on where it was."""

from __future__ import annotations

import hashlib
import json
import math
import os
import sys
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from acutance.errors import OptionError

__all__ = ["Journal", "journal_key"]


def journal_key(study: str, options: object, seed: int, version: str) -> str:
    """Sixteen hexadecimal digits that change with anything that changes a trial.

    Parameters
    ----------
    study : str
    options : frozen dataclass
        Its ``repr`` has to hold every number.
    seed : int
    version : str
        Of the software.
    """
    # Of an array the repr shows a few numbers of the borders, unless it is asked for all of them.
    with np.printoptions(threshold=sys.maxsize, floatmode="unique"):
        text = json.dumps([study, repr(options), seed, version])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


class Journal:
    """An append-only file of finished trials, one line of JSON each.

    A line is written at once and counts only when it ends: what a crash left of a line is cut
    off when the file is opened again. Every line carries a checksum of its trial and values.
    Lines that are damaged otherwise, or changed by hand, are left where they are and named in a
    warning; their trials are not among those done. Use it as a context.

    Parameters
    ----------
    folder : Path
        Made if it does not exist.
    study : str
    key : str
        From `journal_key`: it is part of the file's name, so other options have another file.

    Raises
    ------
    OptionError
        If the folder cannot be written to.
    """

    def __init__(self, folder: Path, study: str, key: str) -> None:
        self.path = folder / f"{study}-{key}.trials.jsonl"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._handle = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o644)
        except OSError as error:
            raise OptionError(
                f"the study's folder {folder} cannot be written to ({error.strerror}): choose "
                "another one"
            ) from error
        self.done = self._read()

    def _read(self) -> dict[int, dict[str, Any]]:
        """Trials that were finished earlier, by number; the file then ends after the last."""
        content = self.path.read_bytes()
        whole = content.rfind(b"\n") + 1
        if whole < len(content):
            os.ftruncate(self._handle, whole)
        done, damaged = {}, []
        for number, line in enumerate(content[:whole].split(b"\n")[:-1], start=1):
            try:
                trial, values = _parse(line)
            except (ValueError, KeyError, TypeError, AttributeError):
                damaged.append(number)
            else:
                done[trial] = values
        if damaged:
            warnings.warn(_damage(self.path, damaged), stacklevel=2)
        return done

    def append(self, trial: int, values: Mapping[str, Any]) -> None:
        """Keep one finished trial."""
        known = {
            name: None if isinstance(value, float) and not math.isfinite(value) else value
            for name, value in values.items()
        }
        entry = {"trial": trial, "values": known, "check": _checksum(trial, known)}
        line = json.dumps(entry, allow_nan=False)
        os.write(self._handle, line.encode() + b"\n")

    def __enter__(self) -> Journal:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        os.close(self._handle)


def _parse(line: bytes) -> tuple[int, dict[str, Any]]:
    """The trial of a line; any of the errors of a text that is something else."""
    entry = json.loads(line)
    trial, values = entry["trial"], entry["values"]
    if entry["check"] != _checksum(trial, values):
        raise ValueError("the line is not what was written")
    return trial, {name: math.nan if value is None else value for name, value in values.items()}


def _checksum(trial: int, values: Mapping[str, Any]) -> str:
    """Eight hexadecimal digits that change with anything in a line."""
    return hashlib.sha256(json.dumps([trial, values]).encode()).hexdigest()[:8]


def _damage(path: Path, lines: Sequence[int]) -> str:
    which = f"line{'s' if len(lines) > 1 else ''} {', '.join(map(str, lines))}"
    return f"{path}, {which}: damaged, so passed over; what stood there is computed again"
