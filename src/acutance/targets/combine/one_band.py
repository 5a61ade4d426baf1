"""Whether measurements of one image that are combined are of one band."""

from __future__ import annotations

from collections.abc import Sequence

from acutance.errors import OptionError
from acutance.targets.combine.inputs import MeasuredInput
from acutance.targets.combine.shared_pixels import is_same_file

__all__ = ["require_one_band"]


def require_one_band(inputs: Sequence[MeasuredInput]) -> None:
    """Refuse measurements of several bands of one file: each has an MTF of its own.

    Bands of several files cannot be told apart: one file may have the pan band alone, another all.

    Raises
    ------
    OptionError
        If two of them differ.
    """
    for i, one in enumerate(inputs):
        for other in inputs[:i]:
            if one.image.band != other.image.band and is_same_file(one, other):
                raise OptionError(
                    f"{other.name} is of band {other.image.band_label} and {one.name} of band "
                    f"{one.image.band_label} of {one.image.path}: each band has an MTF of its own; "
                    "combine the measurements of one band"
                )
