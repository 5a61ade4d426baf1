"""What a study found."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from acutance.errors import OptionError
from acutance.optics import Sensor, describe_block
from acutance.studies.table import Table

__all__ = ["Finding", "StudyResult", "options_dict", "printed_for"]


@dataclass(frozen=True)
class Finding:
    """One answer of a study.

    Parameters
    ----------
    name : str
        Identifier, ends in its unit.
    value : float
        ``nan`` where the study has no answer.
    text : str
        The answer in a sentence.
    published : float, optional
        What the paper printed for it.
    """

    name: str
    value: float
    text: str
    published: float | None = None


@dataclass(frozen=True)
class StudyResult:
    """Tables and answers of one study.

    Parameters
    ----------
    name, title : str
    options : frozen dataclass
        What was studied.
    seed : int
    tables : dict of Table
        The summary first, under the study's name; the trials under ``"trials"``.
    findings : tuple of Finding
    """

    name: str
    title: str
    options: Any
    seed: int
    tables: Mapping[str, Table]
    findings: tuple[Finding, ...]

    @property
    def table(self) -> Table:
        """The summary."""
        return self.tables[self.name]

    def finding(self, name: str) -> Finding:
        """The answer of that name.

        Raises
        ------
        OptionError
            If there is none.
        """
        for found in self.findings:
            if found.name == name:
                return found
        known = ", ".join(found.name for found in self.findings)
        raise OptionError(f"the study {self.name} has no finding {name!r}, only {known}")

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain numbers, texts and lists, for JSON."""
        return {
            "schema": "acutance/study/1",
            "study": self.name,
            "title": self.title,
            "options": options_dict(self.options),
            "seed": self.seed,
            "findings": [
                {
                    "name": found.name,
                    "value": found.value if math.isfinite(found.value) else None,
                    "published": found.published,
                    "text": found.text,
                }
                for found in self.findings
            ],
            "tables": {name: table.to_dict() for name, table in self.tables.items()},
        }


def options_dict(options: Any) -> Any:
    """Options as plain numbers, texts and lists; a sensor as the texts of its blocks."""
    if isinstance(options, Sensor):
        return {
            "gsd_m": options.gsd_m,
            "gsd_along_m": options.gsd_along_m,
            "blocks": [describe_block(block) for block in options.blocks],
        }
    if is_dataclass(options):
        return {one.name: options_dict(getattr(options, one.name)) for one in fields(options)}
    if isinstance(options, tuple | list):
        return [options_dict(one) for one in options]
    return options


def printed_for(options: Any, number: float, free: Collection[str]) -> float | None:
    """What the paper printed, where the options are those it was printed for.

    Parameters
    ----------
    options : frozen dataclass
        Whose defaults are the paper's parameters.
    number : float
        The printed one.
    free : collection of str
        Options that do not change what the number means.

    Returns
    -------
    float or None
        None where another option than those is not the paper's: the numbers are of two things.
    """
    of_paper = type(options)()
    alike = all(
        getattr(options, field.name) == getattr(of_paper, field.name)
        for field in fields(options)
        if field.name not in free
    )
    return number if alike else None
