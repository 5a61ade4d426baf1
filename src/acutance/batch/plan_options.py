"""The options with which targets are measured: those of the plan, then those of the target.

What is given is compared by names and values. The classes of the options, and with them the rooms
of the kinds, are loaded when something is to be measured.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from acutance.errors import OptionError
from acutance.raster.surveyed_targets import SurveyedTarget
from acutance.targets.kinds import KINDS

__all__ = ["ChosenOptions", "choose_options", "faults_of_plan", "require_options"]

_NOT_HERE = frozenset(("method_options", "groups", "centre"))
"""Options that are objects, or places in one image."""
_STATED = ("target_softness_m", "target_softness_px")
_SCENE = ("acutance.scan", "ScanOptions", ("population",))


@dataclass(frozen=True)
class ChosenOptions:
    """How one target is measured.

    Parameters
    ----------
    kind, method : str
    given : mapping
        Options by name; the others have their default values.
    """

    kind: str
    method: str
    given: Mapping[str, Any]

    @property
    def document(self) -> dict[str, Any]:
        """What is part of the key of a row."""
        return {"method": self.method, **self.given}

    def build(self) -> Any:
        """The options as an object of the kind's own class.

        Raises
        ------
        OptionError
            If a value means nothing.
        """
        of_class = _class_of(self.kind)
        try:
            return of_class(**{name: _value(name, one) for name, one in self.given.items()})
        except (TypeError, ValueError) as error:
            raise OptionError(str(error)) from error


def choose_options(
    targets: Sequence[SurveyedTarget], of_plan: Mapping[str, Mapping[str, Any]]
) -> tuple[ChosenOptions, ...]:
    """The method and the options of every target, whatever they are worth.

    Parameters
    ----------
    targets : sequence of SurveyedTarget
    of_plan : mapping of str to mapping
        By kind.
    """
    return tuple(
        _chosen(one.kind, one.method, of_plan.get(one.kind, {}), one.options) for one in targets
    )


def require_options(
    targets: Sequence[SurveyedTarget],
    chosen: Sequence[ChosenOptions],
    of_plan: Mapping[str, Mapping[str, Any]],
) -> None:
    """Refuse options that do not exist, and values that mean nothing.

    Parameters
    ----------
    targets, chosen : sequences
        As of `choose_options`.
    of_plan : mapping of str to mapping

    Raises
    ------
    OptionError
        Names all of them at once, those of the plan once and not for every target.
    """
    of_kinds = faults_of_plan(of_plan)
    faults = [f"the plan: {one}" for several in of_kinds.values() for one in several]
    for number, (target, one) in enumerate(zip(targets, chosen, strict=True), start=1):
        if target.kind not in of_kinds:
            named = f" ({target.name})" if target.name != str(number) else ""
            faults.extend(f"target {number}{named}: {fault}" for fault in _faults(one))
    if faults:
        raise OptionError("options cannot be used:\n" + "\n".join(f"  - {one}" for one in faults))


def faults_of_plan(of_plan: Mapping[str, Mapping[str, Any]]) -> dict[str, list[str]]:
    """What is wrong with the options of a plan, in words, by the kinds that have faults.

    Parameters
    ----------
    of_plan : mapping of str to mapping
        By kind.
    """
    found = {kind: _faults(_chosen(kind, None, given, {})) for kind, given in of_plan.items()}
    return {kind: faults for kind, faults in found.items() if faults}


def _chosen(
    kind: str, method: str | None, of_plan: Mapping[str, Any], own: Mapping[str, Any]
) -> ChosenOptions:
    """Options of a target go before those of the plan, limit by limit."""
    merged = {**of_plan, **own}
    limits = {**_limits(of_plan), **_limits(own)}
    if limits:
        merged["limits"] = limits
    stated = merged.pop("method", None)
    return ChosenOptions(kind, method or stated or _of_kind(kind)[2][0], merged)


def _limits(given: Mapping[str, Any]) -> dict[str, Any]:
    limits = given.get("limits")
    return dict(limits) if isinstance(limits, Mapping) else {}


def _faults(chosen: ChosenOptions) -> list[str]:
    """What is wrong with options, in words."""
    methods = _of_kind(chosen.kind)[2]
    known = [one.name for one in fields(_class_of(chosen.kind)) if one.name not in _NOT_HERE]
    found = [f"{chosen.kind} has no option {one!r}" for one in chosen.given if one not in known]
    if chosen.method not in methods:
        named = ", ".join(methods)
        found.append(f"there is no {chosen.kind} method {chosen.method!r}: {named}")
    usable = {name: one for name, one in chosen.given.items() if name in known}
    return found + _bad_values(replace(chosen, given=usable))


def _bad_values(chosen: ChosenOptions) -> list[str]:
    """What is wrong with values, each by itself if it is wrong by itself."""
    whole = _refusal(chosen)
    if whole is None:
        return []
    single = [{name: one} for name, one in chosen.given.items() if name != "limits"]
    single += [{"limits": {name: one}} for name, one in _limits(chosen.given).items()]
    alone = (_refusal(replace(chosen, given=one)) for one in single)
    return list(dict.fromkeys(one for one in alone if one is not None)) or [whole]


def _refusal(chosen: ChosenOptions) -> str | None:
    try:
        chosen.build()
    except OptionError as error:
        return str(error).removeprefix(f"{_of_kind(chosen.kind)[1]}: ")
    return None


def _of_kind(kind: str) -> tuple[str, str, tuple[str, ...]]:
    """Room, class of options and methods of a kind."""
    if kind == "scene":
        return _SCENE
    found = KINDS[kind]
    return found.room, found.options, found.methods


def _class_of(kind: str) -> Any:
    room, name, _ = _of_kind(kind)
    return getattr(importlib.import_module(room), name)


def _value(name: str, value: Any) -> Any:
    """A number with its deviation, {value = 0.05, std = 0.02}, as an estimate; lists as tuples."""
    from acutance.curves import Estimate

    if name in _STATED and isinstance(value, Mapping):
        if set(value) != {"value", "std"}:
            raise OptionError(f"{name} is {dict(value)!r}: write a number, or value and std")
        return Estimate(float(value["value"]), float(value["std"]))
    return tuple(value) if isinstance(value, list) else value
