"""What a band is called wherever a person reads it."""

from __future__ import annotations

__all__ = ["label_band"]


def label_band(band: int | str, name: str | None) -> str:
    """A band by its number, with its name where it has another: "2 (B3)"."""
    return str(band) if name in (None, str(band)) else f"{band} ({name})"
