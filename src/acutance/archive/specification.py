"""What a sensor has to reach, as a file of requirements.

.. code-block:: toml

    title = "NASA data purchase"

    [[requirement]]
    name = "panchromatic MTF"
    metric = "mtf_nyquist"
    minimum = 0.09              # or maximum = ...
    sensor = "QB02"             # of all sensors without it, each by itself
    band = "pan"
    orientation = "across"      # of both without it, each by itself
    confidence = 0.95
    since = 2003-01-01          # or window_days = 365, up to the last image
    on = 2003-12-31             # the day asked; that of the last image without it
    verdict = "usable"          # measurements of this verdict or better
"""

from __future__ import annotations

import datetime
import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from acutance.curves import METRICS
from acutance.curves.metric_bounds import limit_fault
from acutance.curves.metric_names import did_you_mean
from acutance.errors import OptionError
from acutance.raster.document_faults import document_faults

__all__ = ["Requirement", "Specification", "read_specification"]

_LEAST = 'write metric = "mtf_nyquist", for example, and minimum = 0.09 or maximum = ...'
_NOTHING_ASKED = (
    "there is no requirement in it: write [[requirement]] on a line, and below it metric = "
    '"mtf_nyquist" and minimum = 0.09, for example (documentation, "Specifications", has all keys)'
)

Names = str | list[str]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
"""A number of the file, no text of one and no true or false."""


class Requirement(BaseModel):
    """One requirement: the mean of a sensor at a date, above a minimum or below a maximum.

    Parameters
    ----------
    metric : str
        One of the numbers of a measurement, "mtf_nyquist".
    minimum, maximum : float, optional
        Exactly one of them, above what the metric cannot fall below.
    name : str, optional
        What it is called.
    sensor, level, band, orientation, site, target, kind, method : optional
        Which measurements count.
    confidence : float, optional
        Probability from which it is met, and from which it is not met.
    since, until : date, optional
        Days of acquisition that count, both included.
    window_days : float, optional
        Only so many days up to the last image.
    on : date, optional
        The day for which it is asked; that of the last image without it.
    verdict : str, optional
        Measurements of this verdict or better.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    metric: str
    minimum: Number | None = None
    maximum: Number | None = None
    name: str = ""
    sensor: Names | None = None
    level: Names | None = None
    band: Names | None = None
    orientation: Literal["across", "along"] | None = None
    site: Names | None = None
    target: Names | None = None
    kind: Names | None = None
    method: Names | None = None
    confidence: Number = Field(0.95, gt=0.5, lt=1)
    since: datetime.date | None = None
    until: datetime.date | None = None
    window_days: Number | None = Field(None, gt=0)
    on: datetime.date | None = None
    verdict: Literal["good", "usable", "doubtful", "invalid"] = "usable"

    @model_validator(mode="after")
    def _has_one_limit(self) -> Requirement:
        if (self.minimum is None) == (self.maximum is None):
            raise ValueError("give a minimum or a maximum, one of them")
        if fault := limit_fault(self.metric, self.limit):
            raise ValueError(f"{self.sentence} cannot be tested: {fault}")
        return self

    @field_validator("metric")
    @classmethod
    def _is_metric(cls, name: str) -> str:
        if name not in METRICS:
            raise ValueError(f"{name!r} is none of {', '.join(METRICS)}{did_you_mean(name)}")
        return name

    @property
    def limit(self) -> float:
        """The minimum or the maximum."""
        return float(self.maximum if self.minimum is None else self.minimum)  # type: ignore[arg-type]

    @property
    def is_minimum(self) -> bool:
        """Whether the sensor has to be above the limit."""
        return self.minimum is not None

    @property
    def sentence(self) -> str:
        """Metric, sense and limit."""
        return f"{self.metric} {'>=' if self.is_minimum else '<='} {self.limit:g}"

    @property
    def selection(self) -> dict[str, Any]:
        """The filters of an archive that it means."""
        names = ("sensor", "level", "band", "orientation", "site", "target", "kind", "method",
                 "since", "until", "verdict")  # fmt: skip
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}


class Specification(BaseModel):
    """All requirements of a file.

    Parameters
    ----------
    title : str, optional
    requirement : list of Requirement
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    title: str = ""
    requirement: list[Requirement] = Field(min_length=1)

    @classmethod
    def of(cls, document: Mapping[str, Any], source: str = "the specification") -> Specification:
        """The specification of a document; everything that is wrong is named at once.

        Parameters
        ----------
        document : mapping
        source : str, optional
            Where it came from, for the message.

        Raises
        ------
        OptionError
            If it has unknown keys, or values they cannot have.
        """
        try:
            return cls.model_validate(document)
        except ValidationError as error:
            raise OptionError(f"{source}: {'; '.join(_wrong(error, document))}") from None


def read_specification(path: str | os.PathLike[str]) -> Specification:
    """The specification of a TOML file.

    Parameters
    ----------
    path : path

    Returns
    -------
    Specification

    Raises
    ------
    OptionError
        If there is no path, the file cannot be read, is no TOML, or says what cannot be.
    """
    try:
        text = Path(path).read_bytes().decode("utf-8-sig")
        document = tomllib.loads(text)
    except TypeError:
        raise OptionError(
            f"the specification is of type {type(path).__name__}: give the path of a TOML file, or "
            "acutance.archive.specification.Specification.of(document)"
        ) from None
    except OSError as error:
        raise OptionError(f"{path} cannot be read ({error.strerror}): name a TOML file") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise OptionError(f"{path} is no TOML: {error}") from error
    return Specification.of(document, str(path))


def _wrong(error: ValidationError, document: Mapping[str, Any]) -> list[str]:
    """What is wrong, each with its place."""
    found = []
    for one in document_faults(error, document):
        if one.kind == "extra_forbidden":
            model = Requirement if one.within else Specification
            said = f"is no key, only {', '.join(model.model_fields)}"
        elif one.kind == "list_type" and isinstance(one.found, Mapping):
            said = f"is a single table, and there may be several: write [[{one.place}]]"
        elif one.place == "requirement" and (one.kind == "missing" or one.found == []):
            found.append(_NOTHING_ASKED)
            continue
        elif one.kind == "missing":
            said = f"is missing: {_LEAST}"
        else:
            said = one.message[:1].lower() + one.message[1:]
        found.append(f"{one.place}: {said}")
    return found
