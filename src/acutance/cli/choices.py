"""What a user may choose of a measurement: methods, limits, the centre of RER."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.curves import Estimate
    from acutance.curves.metrics import RerCentre

__all__ = [
    "choose_methods",
    "choose_rer_centre",
    "numbers_of",
    "parse_band",
    "parse_grid",
    "parse_limits",
    "parse_numbers",
    "parse_pair",
    "parse_share",
    "parse_stated",
]

RER_CENTRES: dict[str, RerCentre] = {"half": "half", "peak": "peak"}


def choose_methods(first: str, compare: str | None, known: Sequence[str]) -> list[str]:
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
            f"--compare {compare!r} compares {first} with nothing: name others, of {rest}"
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


def parse_limits(texts: Sequence[str]) -> dict[str, float]:
    """The numbers of every ``--limit NAME=VALUE``; which names there are the options know.

    Raises
    ------
    OptionError
        If a value is not a number.
    """
    return dict(map(_parse_limit, texts))


def _parse_limit(text: str) -> tuple[str, float]:
    name, _, number = text.partition("=")
    try:
        value = float(number)
    except ValueError:
        value = math.nan
    # No value is above or below one that is not a number: the check would always fail.
    if math.isnan(value):
        raise OptionError(f"--limit {text}: write NAME=VALUE with a number, as in {name}=10")
    return name, value


def numbers_of(text: str, separator: str = ",") -> list[float]:
    """Numbers between separators, a regular expression; none if a part is no number."""
    try:
        return [float(part) for part in re.split(separator, text)]
    except ValueError:
        return []


def parse_numbers(option: str, text: str) -> tuple[float, ...]:
    """Numbers with commas between, one or more.

    Raises
    ------
    OptionError
        If a part is no number.
    """
    numbers = tuple(numbers_of(text))
    if not numbers:
        raise OptionError(f"{option} {text}: write numbers with commas, as in 20,40")
    return numbers


def parse_pair(option: str, text: str, words: str) -> tuple[float, float]:
    """Two numbers with a comma between.

    Parameters
    ----------
    option, text : str
        Its name, and what was typed.
    words : str
        What to write, with an example.

    Raises
    ------
    OptionError
        If it is not two numbers.
    """
    numbers = numbers_of(text)
    if len(numbers) != 2:
        raise OptionError(f"{option} {text}: write {words}")
    return numbers[0], numbers[1]


def parse_stated(option: str, text: str | None) -> Estimate | None:
    """A stated number with its standard deviation: 0.05, 0.05+-0.02 or 0.05±0.02.

    Raises
    ------
    OptionError
        If it is neither.
    """
    if text is None:
        return None
    from acutance.curves import Estimate

    numbers = numbers_of(text, r"\+-|\+/-|±")
    if len(numbers) not in (1, 2):
        raise OptionError(
            f"{option} {text}: write a number, or one with its standard deviation (0.05+-0.02)"
        )
    if numbers[1:] and numbers[1] < 0:
        raise OptionError(f"{option} {text}: its standard deviation is {numbers[1]:g}, below 0")
    return Estimate(*numbers)


def parse_share(option: str, text: str | None, of: str = "the contrast") -> float:
    """A share, as a number (0.005) or in per cent (0.5%); 0 where none is given.

    Parameters
    ----------
    option, text : str
        Its name, and what was typed.
    of : str, optional
        Of what.

    Raises
    ------
    OptionError
        If it is neither.
    """
    if text is None:
        return 0.0
    try:
        return float(text[:-1]) / 100 if text.endswith("%") else float(text)
    except ValueError:
        raise OptionError(f"{option} {text}: write a share of {of} (0.5% or 0.005)") from None


def parse_band(text: str) -> int:
    """The number of a band.

    Raises
    ------
    OptionError
        If it is none.
    """
    try:
        return int(text)
    except ValueError:
        raise OptionError(
            f"--band {text or '(nothing)'} is not the number of a band: write one, or several as "
            "in 1,2,3, counted from 1 (acutance image FILE lists them with their names)"
        ) from None


def parse_grid(option: str, text: str) -> tuple[int, int]:
    """Rows and columns of a grid, as in ``3x3``.

    Raises
    ------
    OptionError
        If they are not two numbers.
    """
    found = re.fullmatch(r"(\d{1,4})x(\d{1,4})", text.strip())
    if found is None:
        raise OptionError(f"{option} {text} is no grid: give rows and columns, such as 3x3")
    return int(found[1]), int(found[2])
