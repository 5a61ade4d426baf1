"""Questions about what readout and processing left in the pixels: limits by simulation.

The documentation has their rates ("Edges": what processing leaves).
"""

from __future__ import annotations

from typing import Final

from acutance.targets.question import Question

__all__ = ["PROCESSING_QUESTIONS"]

PROCESSING_QUESTIONS: Final = {
    "repeated_pixels": Question(
        "Which share of the pixels repeats a neighbour?", "<=", 0.01,
        "the image was resampled by taking the nearest pixel, which breaks edges in steps of a "
        "pixel: its MTF is not the sensor's; use the original grid",
    ),
    "jpeg_blocks": Question(
        "How many times rarer is detail in blocks of 8 by 8 pixels at one place?", "<=", 1.25,
        "the image was compressed by JPEG, which takes noise and fine detail away: MTFs err by "
        "more than the intervals; use the original",
    ),
    "odd_even": Question(
        "How much do odd and even columns, or rows, differ beyond noise?", "<=", 0.005,
        "two readouts have gains or offsets of their own; the intervals allow for it and are up to "
        "three times as wide as without: equalise the columns", severity="note",
    ),
}  # fmt: skip
