"""What a user may choose of a measurement: methods, limits, the centre of RER."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import Field, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeVar

from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.curves.metrics import RerCentre

__all__ = ["change_limits", "choose_methods", "choose_rer_centre"]


class _Limits(Protocol):
    """Limits of any target's checks: a dataclass of numbers."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]


LimitsT = TypeVar("LimitsT", bound=_Limits)
RER_CENTRES: dict[str, RerCentre] = {"half": "half", "peak": "peak"}
SIDES = ("_dark", "_bright", "_before", "_behind", "_strip")


def choose_methods(first: str, compare: str | None, known: Collection[str]) -> list[str]:
    """The methods of ``--method`` and ``--compare``, each once.

    Raises
    ------
    OptionError
        If one of them is not among `known`, or nothing is compared.
    """
    others = [name.strip() for name in (compare or "").split(",")]
    wanted = list(dict.fromkeys([first, *(name for name in others if name)]))
    if compare is not None and wanted == [first]:
        rest = ", ".join(name for name in known if name != first)
        raise OptionError(
            f"--compare {compare!r} sets nothing beside {first}: name others, of {rest}"
        )
    for name in wanted:
        if name not in known:
            raise OptionError(f"there is no method {name!r}: choose from {', '.join(known)}")
    return wanted


def choose_rer_centre(name: str | None) -> RerCentre | None:
    """The value of ``--rer-centre``.

    Raises
    ------
    OptionError
        If it is neither half nor peak.
    """
    if name is not None and name not in RER_CENTRES:
        raise OptionError(f"--rer-centre {name}: it has to be half or peak")
    return None if name is None else RER_CENTRES[name]


def change_limits(defaults: LimitsT, changes: Sequence[str]) -> LimitsT:
    """Limits changed as every ``--limit NAME=VALUE`` asks.

    Raises
    ------
    OptionError
        If there is no limit of that name, or the value is not a number.
    """
    known = {field.name for field in fields(defaults)}
    return replace(defaults, **dict(_parse_limit(text, known) for text in changes))


def _parse_limit(text: str, known: set[str]) -> tuple[str, float]:
    name, _, number = text.partition("=")
    if name not in known:
        both = next((limit for side in SIDES if (limit := name.replace(side, "")) in known), None)
        hint = f"; {both} holds for every side" if both else ""
        raise OptionError(f"--limit {text}: the limits are {', '.join(sorted(known))}{hint}")
    try:
        value = float(number)
    except ValueError:
        value = math.nan
    # No value is above or below one that is not a number: the check would always fail.
    if math.isnan(value):
        raise OptionError(f"--limit {text}: write a number, as in {name}=10")
    return name, value
