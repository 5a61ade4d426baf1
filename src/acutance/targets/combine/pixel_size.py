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
    """The measurements whose pixels nobody knows, where others' are known."""
    unknown = tuple(one.name for one in inputs if one.gsd_m is None)
    return unknown if len(unknown) < len(inputs) else ()


def common_gsd(inputs: Sequence[MeasuredInput]) -> Gsd | None:
    """The GSD all inputs share; ``None`` if none of them knows it.

    Documents of older versions hold but the GSD along the normal: with nothing else, pixels are
    taken to be square.

    Raises
    ------
    OptionError
        If they differ.
    """
    known = {one.name: one.gsd_m for one in inputs if one.gsd_m is not None}
    pixels = {one.name: one.pixel_gsd_m for one in inputs if one.pixel_gsd_m is not None}
    if not pixels:
        _require_alike({name: (gsd_m,) for name, gsd_m in known.items()})
        return Gsd.square(_mean(list(known.values()))) if known else None
    _require_alike(pixels)
    rows, cols = zip(*pixels.values(), strict=True)
    gsd = Gsd(_mean(rows), _mean(cols))
    for one in inputs:
        if one.gsd_m is not None:
            normal = 0.0 if one.of_plane else float(one.slices.normal_deg[0])
            here = f"the others along its normal ({one.direction})"
            _require_alike({one.name: (one.gsd_m,), here: (gsd.along_normal(normal),)})
    return gsd


def _require_alike(known: Mapping[str, tuple[float, ...]]) -> None:
    """Refuse sizes, (rows, columns) or along a normal, that differ by more than rounding."""
    for axis in range(len(next(iter(known.values()), ()))):
        least, most = (pick(known, key=lambda name: known[name][axis]) for pick in (min, max))
        if known[most][axis] > known[least][axis] * (1 + _GSD_SHARE):
            raise OptionError(
                f"the measurements have different pixels: {least} {_size(known[least])}, {most} "
                f"{_size(known[most])}. Frequencies per pixel mean different things then: combine "
                "those of one sensor and one product; for pixels that are not square state both "
                "distances (--gsd ROW,COL)"
            )


def _size(sides_m: tuple[float, ...]) -> str:
    same = len(set(sides_m)) == 1
    return f"{sides_m[0]:.4g} m" if same else " x ".join(f"{one:.4g}" for one in sides_m) + " m"


def _mean(sizes_m: Sequence[float]) -> float:
    """Geometric mean: sizes differ by rounding alone."""
    return math.exp(math.fsum(map(math.log, sizes_m)) / len(sizes_m))
