"""The option ``--band`` of measuring commands: numbers, and names that the image states."""

from __future__ import annotations

from collections.abc import Sequence

from acutance.cli.choices import parse_band
from acutance.errors import OptionError

__all__ = ["numbers_of_bands", "parse_bands"]


def parse_bands(text: str) -> list[int | str]:
    """Numbers of bands, and what may be names of some.

    Raises
    ------
    OptionError
        If one is nothing.
    """
    return [_number_or_name(one.strip()) for one in text.split(",")]


def _number_or_name(text: str) -> int | str:
    try:
        return parse_band(text)
    except OptionError:
        if not text:
            raise
        return text


def numbers_of_bands(path: str, bands: Sequence[int | str]) -> list[int]:
    """Numbers of bands that are given by number or by name.

    Raises
    ------
    OptionError
        If the file has no band of a name.
    """
    if all(isinstance(one, int) for one in bands):
        return [int(one) for one in bands]
    from acutance.raster.metadata.read_statement import band_names
    from acutance.raster.open_image import open_unnamed

    first = open_unnamed(path)
    names = band_names(first) or ()
    by_name = {name.casefold(): number for number, name in enumerate(names, start=1)}
    found = [one if isinstance(one, int) else by_name.get(one.casefold()) for one in bands]
    for asked, number in zip(bands, found, strict=True):
        if number is None:
            bands_there = ", ".join(names) or f"{first.band_count}, without names"
            raise OptionError(
                f"--band {asked} is not the number of a band, from 1 to {first.band_count}, nor "
                f"the name of one: the bands of {path} are {bands_there}"
            )
    return [number for number in found if number is not None]
