"""Checks of what processing left in the pixels, whatever the target: copies and JPEG blocks.

Interpolation shows in large images only, and scenes are asked for it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from acutance.curves.grid import Floats
from acutance.numerics.periodic_noise import PeriodicNoise, periodic_noise
from acutance.raster import Box, Image
from acutance.targets.check import Check, Limits, answer
from acutance.targets.processing_traces import ProcessingTraces, sample_boxes, traces_of_parts
from acutance.targets.region import RegionPixels, read_data

__all__ = [
    "PROCESSING_CHECKS",
    "SCENE_PROCESSING_CHECKS",
    "image_processing_checks",
    "processing_checks",
    "scene_processing_checks",
]

PROCESSING_CHECKS = ("repeated_pixels", "jpeg_blocks")
"""Names of these checks."""

SCENE_PROCESSING_CHECKS = (*PROCESSING_CHECKS, "periodic_noise")
"""Those of scenes."""


def processing_checks(region: RegionPixels, limits: Limits) -> tuple[Check, Check]:
    """Whether pixels of a region repeat their neighbours, and whether JPEG compressed them.

    Parameters
    ----------
    region : RegionPixels
    limits : mapping of str to float
        Limits the caller changed.
    """
    return _answers(region.traces, limits)


def image_processing_checks(
    images: Sequence[tuple[Image, Box]], limits: Limits
) -> tuple[Check, Check]:
    """The same of parts of images, which are read here: of the worse image.

    Parameters
    ----------
    images : sequence of (Image, Box)
    limits : mapping of str to float
        Limits the caller changed.
    """
    found = [traces_of_parts(_parts(image, box)) for image, box in images]
    worse = ProcessingTraces(max(one.repeated for one in found), max(one.blocks for one in found))
    return _answers(worse, limits)


def scene_processing_checks(image: Image, box: Box, limits: Limits) -> tuple[Check, Check, Check]:
    """The same of a part of one image, and whether its noise has the beats of interpolation.

    Parameters
    ----------
    image : Image
    box : Box
    limits : mapping of str to float
        Limits the caller changed.
    """
    parts = list(_parts(image, box))
    noise = periodic_noise(parts)
    periodic = answer("periodic_noise", noise.amplitude, _in_words(noise), limits)
    return (*_answers(traces_of_parts(parts), limits), periodic)


def _parts(image: Image, box: Box) -> Iterator[Floats]:
    """Pixels of the parts that are looked at."""
    return (read_data(image, part)[0] for part in sample_boxes(box))


def _in_words(noise: PeriodicNoise) -> str:
    """Periods of noise, and the stretch or the turn of a grid that has them."""
    if noise.amplitude == 0:
        return "the noise does not vary periodically"
    periods = " and ".join(f"{1 / math.hypot(*beat):.1f}" for beat in noise.beats_cpp)
    fastest = max(abs(part) for beat in noise.beats_cpp for part in beat)
    return (
        f"the noise varies by {100 * noise.amplitude:.0f} % with periods of {periods} px in two "
        f"directions at right angles, as that of an image interpolated to {1 / (1 - fastest):.2f} "
        f"or {1 / (1 + fastest):.2f} times its size, or turned by "
        f"{math.degrees(math.asin(fastest)):.0f} degrees"
    )


def _answers(found: ProcessingTraces, limits: Limits) -> tuple[Check, Check]:
    return (
        answer(
            "repeated_pixels", found.repeated,
            f"{100 * found.repeated:.1f} % of the pixels repeat the one above or beside them",
            limits,
        ),
        answer(
            "jpeg_blocks", found.blocks,
            f"detail is {found.blocks:.2f} times rarer in blocks of 8 x 8 pixels cut at one place "
            "than at any other", limits,
        ),
    )  # fmt: skip
