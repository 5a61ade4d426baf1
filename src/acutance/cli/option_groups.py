"""Groups of options: declared once as a dataclass, taken whole by every command that has them.

typer reads one option from each parameter of a function. A command decorated with `with_groups`
has a dataclass as a parameter; typer sees the fields of the dataclass in its place.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from dataclasses import MISSING, Field, fields, is_dataclass
from functools import wraps
from typing import Any, get_type_hints

__all__ = ["with_groups"]


def with_groups(command: Callable[..., None]) -> Callable[..., None]:
    """A command whose dataclass parameters are replaced by the fields of the dataclass.

    Parameters
    ----------
    command : function
        Its other parameters are annotated as typer wants them.
    """
    hints = get_type_hints(command, include_extras=True)
    groups: dict[str, Any] = {name: kind for name, kind in hints.items() if is_dataclass(kind)}

    @wraps(command)
    def expanded(**given: Any) -> None:
        gathered = {
            name: kind(**{field.name: given.pop(field.name) for field in fields(kind)})
            for name, kind in groups.items()
        }
        command(**given, **gathered)

    # typer reads the signature, its type hints are the annotations.
    signature = inspect.Signature(list(_parameters(command, hints)))
    expanded.__signature__ = signature  # type: ignore[attr-defined]
    expanded.__annotations__ = {
        name: parameter.annotation for name, parameter in signature.parameters.items()
    }
    return expanded


def _parameters(command: Callable[..., None], hints: dict[str, Any]) -> Iterator[inspect.Parameter]:
    """Parameters of the command, in the order of its signature: that of its help text."""
    for name, parameter in inspect.signature(command).parameters.items():
        kind = hints[name]
        if not is_dataclass(kind):
            yield _parameter(name, kind, parameter.default)
            continue
        inner = get_type_hints(kind, include_extras=True)
        for field in fields(kind):
            yield _parameter(field.name, inner[field.name], _default(field))


def _parameter(name: str, kind: Any, default: Any) -> inspect.Parameter:
    # By keyword only: the ones with a default may then stand before those without.
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=kind)


def _default(field: Field[Any]) -> Any:
    return inspect.Parameter.empty if field.default is MISSING else field.default
