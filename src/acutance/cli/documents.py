"""JSON documents that commands wrote, read again."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from acutance.errors import OptionError

__all__ = ["read_json"]


def read_json(name: str) -> Any:
    """The document of a file.

    Raises
    ------
    OptionError
        If it cannot be read, or is no JSON.
    """
    try:
        return json.loads(Path(name).read_text(encoding="utf-8-sig"))
    except OSError as error:
        reason = error.strerror or str(error)
        raise OptionError(
            f"{name} cannot be read ({reason}): give files that a measuring command wrote "
            "with --json"
        ) from error
    except ValueError as error:
        raise OptionError(
            f"{name} holds no JSON ({error}): write it with a measuring command and --json"
        ) from error
