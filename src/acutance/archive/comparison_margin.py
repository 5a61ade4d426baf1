"""The margin within which groups are said to agree: of the comparisons and of all that ask them."""

from typing import Final

__all__ = ["MARGIN"]

MARGIN: Final = 0.05
"""Relative difference below which groups are said to agree: what methods are trusted to."""
