"""Checks of what processing left in the pixels, whatever the target: copies and JPEG blocks."""

from __future__ import annotations

from collections.abc import Sequence

from acutance.raster import Box, Image
from acutance.targets.check import Check, Limits, answer
from acutance.targets.processing_traces import ProcessingTraces, sample_boxes, traces_of_parts
from acutance.targets.region import RegionPixels, read_data

__all__ = ["PROCESSING_CHECKS", "image_processing_checks", "processing_checks"]

PROCESSING_CHECKS = ("repeated_pixels", "jpeg_blocks")
"""Names of these checks."""


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
    found = [
        traces_of_parts(read_data(image, part)[0] for part in sample_boxes(box))
        for image, box in images
    ]
    worse = ProcessingTraces(max(one.repeated for one in found), max(one.blocks for one in found))
    return _answers(worse, limits)


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
