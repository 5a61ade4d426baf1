"""From rows of an archive to groups that can be compared: all else is the same in them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from acutance.archive.columns import Columns
from acutance.archive.trends.measured_series import random_and_systematic, years_of
from acutance.curves import METRICS
from acutance.curves.grid import Floats
from acutance.errors import NothingSelectedError, OptionError

__all__ = [
    "COMPARED",
    "NEVER_MIXED",
    "MeasuredGroup",
    "Stratum",
    "Target",
    "group_names",
    "strata_of",
]

COMPARED: Final = ("orientation", "method", "kind", "band", "level", "sensor", "site", "target")
"""What can be compared."""
NEVER_MIXED: Final = ("sensor", "band", "level", "orientation")
_MAX_GROUPS: Final = 12
"""More groups have more pairs than anybody reads."""
_UNKNOWN: Final = "unknown"
_ALWAYS_KNOWN: Final = ("kind", "method")
"""Of all else rows without it are left out where it is what is compared."""
Target = tuple[str | None, str | None]
_Word = TypeVar("_Word", str, tuple[str, ...])


@dataclass(frozen=True, eq=False, kw_only=True)
class MeasuredGroup:
    """Measurements of one of the groups, n of them.

    Attributes
    ----------
    name : str
    value, std, systematic_std : (n,) array
        The random part of the stated deviation, and what does not average out.
    when : (n,) array
        Years with decimals; ``nan`` without a date.
    image, measurement : (n,) int array
    target : list of tuple or None
        Site and name: targets of one name stand at many sites.
    procedure : list of str
        Kind and method.
    gsd_m : float
        Median; ``nan`` where none is known.
    """

    name: str
    value: Floats
    std: Floats
    systematic_std: Floats
    when: Floats
    image: NDArray[np.int64]
    measurement: NDArray[np.int64]
    target: list[Target | None]
    procedure: list[str]
    gsd_m: float

    def where(self, mask: NDArray[np.bool_]) -> MeasuredGroup:
        """The measurements of which a mask (n,) is true."""
        return replace(
            self, value=self.value[mask], std=self.std[mask],
            systematic_std=self.systematic_std[mask], when=self.when[mask],
            image=self.image[mask], measurement=self.measurement[mask],
            target=[one for one, own in zip(self.target, mask, strict=True) if own],
            procedure=[one for one, own in zip(self.procedure, mask, strict=True) if own],
        )  # fmt: skip


@dataclass(frozen=True)
class Stratum:
    """Groups of one sensor, band, product level and direction, except what is compared.

    Attributes
    ----------
    name : str
        "QB02, pan, across".
    groups : tuple of MeasuredGroup
        Two at least.
    """

    name: str
    groups: tuple[MeasuredGroup, ...]


def strata_of(rows: Columns, metric: str, by: str) -> Iterator[Stratum]:
    """The groups to be compared, by sensor, band, product level and direction.

    Parameters
    ----------
    rows : Columns
        Of `acutance.Archive.measurements`.
    metric : str
    by : str
        Of `COMPARED`.

    Raises
    ------
    OptionError
        If there is no such metric or group, there are no rows, or too many groups.
    """
    rows = _comparable(rows, metric, by)
    fixed = [name for name in NEVER_MIXED if name != by]
    keys = list(zip(*(_words(rows, name) for name in fixed), strict=True))
    strata, of_stratum = _numbered(keys)
    names, of_name = _numbered(_words(rows, by))
    for at in sorted(range(len(strata)), key=strata.__getitem__):
        own = of_stratum == at
        found = sorted(np.unique(of_name[own]).tolist(), key=names.__getitem__)
        if len(found) < 2:
            continue
        if len(found) > _MAX_GROUPS:
            listed = ", ".join(names[one] for one in found[:3])
            raise OptionError(
                f"there are {len(found)} {by}s to be compared, {listed}, ...: select up to "
                f"{_MAX_GROUPS} of them"
            )
        groups = tuple(_group(rows, metric, names[one], own & (of_name == one)) for one in found)
        yield Stratum(", ".join(part for part in strata[at] if part != _UNKNOWN), groups)


def group_names(rows: Columns, metric: str, by: str) -> tuple[str, ...]:
    """Names of all groups in order, whether there is another one to compare each with or not.

    Parameters
    ----------
    rows : Columns
    metric, by : str
        As of `strata_of`.
    """
    return tuple(sorted(set(_words(_comparable(rows, metric, by), by))))


def _comparable(rows: Columns, metric: str, by: str) -> Columns:
    """Rows with a number, of which what is compared is known."""
    _require(rows, metric, by)
    known = np.isfinite(rows[metric])
    if by not in _ALWAYS_KNOWN:
        known &= np.array([one is not None for one in rows[by].tolist()], bool)
    return Columns({name: column[known] for name, column in rows.columns.items()})


def _numbered(words: Sequence[_Word]) -> tuple[list[_Word], NDArray[np.int64]]:
    """The words that occur, and the place of each row's word among them."""
    index = {word: at for at, word in enumerate(dict.fromkeys(words))}
    return list(index), np.array([index[word] for word in words], np.int64)


def _require(rows: Columns, metric: str, by: str) -> None:
    if not isinstance(metric, str) or metric not in METRICS:
        raise OptionError(f"there is no metric {metric!r}, only {', '.join(METRICS)}")
    if not isinstance(by, str) or by not in COMPARED:
        raise OptionError(f"{by!r} cannot be compared: choose of {', '.join(COMPARED)}")
    if not len(rows):
        raise NothingSelectedError("the archive holds nothing that is selected: widen the filters")


def _words(rows: Columns, name: str) -> list[str]:
    if name == "method":
        return _procedures(rows)
    return [_UNKNOWN if one is None else str(one) for one in rows[name].tolist()]


def _procedures(rows: Columns) -> list[str]:
    """Kind and method: methods of several kinds have the same name."""
    pairs: Sequence[tuple[Any, Any]] = list(zip(rows["kind"], rows["method"], strict=True))
    return [f"{kind} {method}" if method is not None else str(kind) for kind, method in pairs]


def _group(rows: Columns, metric: str, name: str, mask: NDArray[np.bool_]) -> MeasuredGroup:
    std, systematic = random_and_systematic(rows, metric, mask)
    own = Columns({key: column[mask] for key, column in rows.columns.items()})
    return MeasuredGroup(
        name=name, value=own[metric], std=std, systematic_std=systematic,
        when=years_of(own["acquired"]), image=own["image_id"], measurement=own["id"],
        target=_targets(own), procedure=_procedures(own), gsd_m=_median_gsd(own),
    )  # fmt: skip


def _targets(rows: Columns) -> list[Target | None]:
    """Site and name; what has neither is not known to come again."""
    pairs: list[Target] = list(zip(rows["site"].tolist(), rows["target"].tolist(), strict=True))
    return [None if pair == (None, None) else pair for pair in pairs]


def _median_gsd(rows: Columns) -> float:
    known = rows["gsd_m"][np.isfinite(rows["gsd_m"])]
    return float(np.median(known)) if known.size else float("nan")
