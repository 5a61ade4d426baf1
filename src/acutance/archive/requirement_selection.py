"""Which requirements of a specification ask about what is selected of an archive, and for what."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from acutance.archive.selection import names_of
from acutance.archive.specification import Requirement, Specification

__all__ = ["asked_of", "asks_nothing"]

_BY_NAME: Final = ("sensor", "level", "band", "orientation", "site", "target", "kind", "method")


def asked_of(
    specification: Specification, selection: Mapping[str, Any]
) -> list[tuple[Requirement, dict[str, Any]]]:
    """The requirements of what is selected, with the filters of both.

    Names that both state are those of both; a requirement of others is left out: nothing of a
    specification for one sensor is asked of another. Days and verdict of a requirement go before.

    Parameters
    ----------
    specification : Specification
    selection : mapping
        Filters of an archive.
    """
    found = []
    for requirement in specification.requirement:
        both = _names_of_both(requirement.selection, selection)
        if both is not None:
            found.append((requirement, {**selection, **requirement.selection, **both}))
    return found


def _names_of_both(
    own: Mapping[str, Any], selection: Mapping[str, Any]
) -> dict[str, str | list[str]] | None:
    """The names that two selections have in common; None where there are none."""
    found: dict[str, str | list[str]] = {}
    for name in _BY_NAME:
        if own.get(name) is None or selection.get(name) is None:
            continue
        wanted = names_of(selection[name])
        common = [one for one in names_of(own[name]) if one in wanted]
        if not common:
            return None
        found[name] = common[0] if len(common) == 1 else common
    return found


def asks_nothing(specification: Specification, selection: Mapping[str, Any]) -> str:
    """That no requirement is of what is selected, in a clause with those that there are."""
    wanted = ", ".join(
        f"{name} {' or '.join(repr(one) for one in names_of(selection[name]))}"
        for name in _BY_NAME
        if selection.get(name) is not None
    )
    own = {
        name: list(dict.fromkeys(
            one
            for requirement in specification.requirement
            for one in names_of(requirement.selection.get(name) or [])
        ))
        for name in _BY_NAME
        if selection.get(name) is not None
    }  # fmt: skip
    listed = "; ".join(f"{name} {', '.join(names)}" for name, names in own.items() if names)
    return f"the specification asks nothing of {wanted}: its requirements are of {listed}"
