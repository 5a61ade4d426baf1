"""Numbers with what they count."""

from __future__ import annotations

__all__ = ["counted"]


def counted(count: int, noun: str) -> str:
    """A number with its noun, in the plural where it is not one: "1 image", "3 images"."""
    return f"{count} {noun}{'' if count == 1 else 's'}"
