"""Whether measurements that are combined have the same pixels on the ground."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from acutance.errors import OptionError
from acutance.raster import Gsd
from acutance.targets.combine.inputs import MeasuredInput

__all__ = ["common_gsd", "without_gsd"]

_GSD_SHARE = 0.02


def without_gsd(inputs: Sequence[MeasuredInput]) -> tuple[str, ...]:
    """The measurements without a GSD, where others have one."""
    unknown = tuple(one.name for one in inputs if one.image.pixel_gsd_m is None)
    return unknown if len(unknown) < len(inputs) else ()


def common_gsd(inputs: Sequence[MeasuredInput]) -> Gsd | None:
    """The GSD all inputs share; ``None`` if none of them has one.

    Raises
    ------
    OptionError
        If they differ.
    """
    known = {one.name: one.image.pixel_gsd_m for one in inputs if one.image.pixel_gsd_m is not None}
    if not known:
        return None
    _require_equal(known)
    rows, cols = zip(*known.values(), strict=True)
    return Gsd(_mean(rows), _mean(cols))


def _require_equal(known: Mapping[str, tuple[float, ...]]) -> None:
    """Refuse sizes, (rows, columns) or along a normal, that differ by more than rounding."""
    for axis in range(len(next(iter(known.values()), ()))):
        smallest, largest = (pick(known, key=lambda name: known[name][axis]) for pick in (min, max))
        if known[largest][axis] > known[smallest][axis] * (1 + _GSD_SHARE):
            raise OptionError(
                f"the measurements have different pixels: {smallest} {_size(known[smallest])}, "
                f"{largest} {_size(known[largest])}. Frequencies per pixel mean different things "
                "then: combine those of one sensor and one product; for pixels that are not square "
                "state both distances (--gsd ROW,COL)"
            )


def _size(sides_m: tuple[float, ...]) -> str:
    same = len(set(sides_m)) == 1
    return f"{sides_m[0]:.4g} m" if same else " x ".join(f"{one:.4g}" for one in sides_m) + " m"


def _mean(sizes_m: Sequence[float]) -> float:
    """Geometric mean: sizes differ by rounding alone."""
    return math.exp(math.fsum(map(math.log, sizes_m)) / len(sizes_m))
