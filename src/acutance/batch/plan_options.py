"""The options with which targets are measured: those of the plan, then those of the target."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from acutance.curves import Estimate
from acutance.errors import OptionError
from acutance.raster.surveyed_targets import SurveyedTarget
from acutance.targets.kinds import KINDS

__all__ = ["ChosenOptions", "choose_options"]

_NOT_HERE = frozenset(("method_options", "groups", "centre"))
"""Options that are objects, or places in one image."""
_STATED = ("target_softness_m", "target_softness_px")
_SCENE = ("acutance.scan", "ScanOptions", ("population",))


@dataclass(frozen=True)
class ChosenOptions:
    """How one target is measured.

    Parameters
    ----------
    method : str
    options : object
        Of the kind's own class.
    document : mapping
        The same for JSON: part of the key.
    """

    method: str
    options: Any
    document: Mapping[str, Any]


def choose_options(
    targets: Sequence[SurveyedTarget], of_plan: Mapping[str, Mapping[str, Any]]
) -> tuple[ChosenOptions, ...]:
    """The method and the options of every target.

    Parameters
    ----------
    targets : sequence of SurveyedTarget
    of_plan : mapping of str to mapping
        By kind.

    Raises
    ------
    OptionError
        If the plan or targets have options that do not exist, or values that mean nothing: all
        of them are named at once.
    """
    faults: list[str] = []
    wrong = {
        kind for kind, given in of_plan.items()
        if _chosen(kind, "the plan", None, given, faults) is None
    }  # fmt: skip
    found = [
        _chosen(one.kind, f"target {one.name}", one.method, _merged(one, of_plan), faults)
        for one in targets
        if one.kind not in wrong
    ]
    if faults:
        raise OptionError("options cannot be used:\n" + "\n".join(f"  - {one}" for one in faults))
    return tuple(one for one in found if one is not None)


def _merged(target: SurveyedTarget, of_plan: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """The options of a target go before those of the plan, limit by limit."""
    given = of_plan.get(target.kind, {})
    merged = {**given, **target.options}
    limits = _limits(given, target.options)
    return {**merged, "limits": limits} if limits else merged


def _limits(*given: Mapping[str, Any]) -> dict[str, Any]:
    merged: dict[str, Any] = {}
    for one in given:
        if isinstance(one.get("limits"), Mapping):
            merged.update(one["limits"])
    return merged


def _chosen(
    kind: str, whose: str, method: str | None, given: Mapping[str, Any], faults: list[str]
) -> ChosenOptions | None:
    """The options of one kind; None where something is wrong with them, added to the faults."""
    before = len(faults)
    room, name, methods = _of_kind(kind)
    of_class: Any = getattr(importlib.import_module(room), name)
    known = [one.name for one in fields(of_class) if one.name not in _NOT_HERE]
    unknown = [one for one in given if one not in (*known, "method")]
    faults.extend(f"{whose}: {kind} has no option {one!r}" for one in unknown)
    chosen = method or given.get("method") or methods[0]
    if chosen not in methods:
        faults.append(f"{whose}: there is no {kind} method {chosen!r}: {', '.join(methods)}")
    values = {key: one for key, one in given.items() if key in known}
    try:
        options = of_class(**{key: _value(key, one) for key, one in values.items()})
    except (OptionError, TypeError, ValueError) as error:
        faults.append(f"{whose}: {error}")
        return None
    if len(faults) > before:
        return None
    return ChosenOptions(str(chosen), options, {"method": chosen, **options.to_dict()})


def _of_kind(kind: str) -> tuple[str, str, tuple[str, ...]]:
    if kind == "scene":
        return _SCENE
    found = KINDS[kind]
    return found.room, found.options, found.methods


def _value(name: str, value: Any) -> Any:
    """A number with its deviation, {value = 0.05, std = 0.02}; lists as tuples."""
    if name in _STATED and isinstance(value, Mapping):
        if set(value) != {"value", "std"}:
            raise OptionError(f"{name} is {dict(value)!r}: write a number, or value and std")
        return Estimate(float(value["value"]), float(value["std"]))
    return tuple(value) if isinstance(value, list) else value
