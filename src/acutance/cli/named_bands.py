"""The option ``--band`` of measuring commands: numbers, and names that the image states."""

from __future__ import annotations

from collections.abc import Sequence

from acutance.cli.choices import parse_band
from acutance.errors import OptionError

__all__ = ["number_or_name", "numbers_of_bands", "parse_bands"]


def parse_bands(text: str) -> list[int | str]:
    """Numbers of bands, and what may be names of some.

    Raises
    ------
    OptionError
        If one is nothing.
    """
    parts = [one.strip() for one in text.split(",")]
    return [number_or_name(one) if one else parse_band(one) for one in parts]


def number_or_name(text: str) -> int | str:
    """The number of a band, or what may be the name of one."""
    try:
        return parse_band(text)
    except OptionError:
        return text


def numbers_of_bands(path: str, bands: Sequence[int | str]) -> list[int]:
    """Numbers of bands that are given by number or by name.

    Raises
    ------
    ImageError
        If the file has no band of a name.
    """
    if all(isinstance(one, int) for one in bands):
        return [int(one) for one in bands]
    from acutance.raster.metadata.read_statement import band_numbers
    from acutance.raster.open_image import open_unnamed

    return band_numbers(open_unnamed(path), bands)
