"""Whether measurements that are combined have the same pixels on the ground."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from acutance.errors import OptionError
from acutance.raster import Gsd
from acutance.targets.combine.inputs import MeasuredInput

__all__ = ["common_gsd", "require_one_product", "without_gsd"]

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


def require_one_product(inputs: Sequence[MeasuredInput], stated: Gsd) -> None:
    """Refuse measurements that cannot all be of pixels of the GSD stated, or a multiple of it.

    It may correct the GSD of all, or tell rows from columns where each measurement knows one
    distance alone; pixels of two sizes it cannot make one product.

    Raises
    ------
    OptionError
        If they differ.
    """
    ratios = {one.name: _ratios(one.image.pixel_gsd_m, stated) for one in inputs
              if one.image.pixel_gsd_m is not None}  # fmt: skip
    if not ratios:
        return
    larger = max(ratios, key=lambda name: ratios[name][0])
    smaller = min(ratios, key=lambda name: ratios[name][1])
    if ratios[larger][0] > ratios[smaller][1] * (1 + _GSD_SHARE):
        own = {one.name: one.image.pixel_gsd_m or () for one in inputs}
        raise OptionError(
            f"the measurements have different pixels: {smaller} {_size(own[smaller])}, {larger} "
            f"{_size(own[larger])}, which the GSD that is stated does not make one. Frequencies "
            "per pixel mean different things then: combine those of one sensor and one product"
        )


def _ratios(own_m: tuple[float, float], stated: Gsd) -> tuple[float, float]:
    """From which to which multiple of the stated GSD a measurement's own may be.

    One number for rows and columns may be that of either side, or of a direction in between.
    """
    of_rows, of_cols = own_m[0] / stated.row_m, own_m[1] / stated.col_m
    low, high = sorted((of_rows, of_cols))
    return (low, high) if own_m[0] == own_m[1] else (high, low)


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
