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
    "periodic_noise": Question(
        "By how much does the noise vary periodically over the image?", "<=", 0.03,
        "the image was interpolated onto a grid that was stretched or turned: the blur differs "
        "from pixel to pixel, and the numbers are those of the product in the mean; use the "
        "original grid", severity="note",
    ),
    "removed_noise": Question(
        "How much more do single pixels scatter at the border than on the plateaus?", "<=", 2.0,
        "noise was removed where the ground is flat, by a filter that keeps edges: it sharpens "
        "borders, and the intervals do not know; use the image before it",
    ),
    "odd_even": Question(
        "How much do odd and even columns, or rows, differ beyond noise?", "<=", 0.005,
        "two readouts have gains or offsets of their own; the intervals allow for it and are up to "
        "three times as wide as without: equalise the columns", severity="note",
    ),
}  # fmt: skip
