"""Questions about pairs of two resolutions: what has to hold for one kernel to be the blur between.

Source: Li et al., "On-orbit MTF estimation methods"; limits without one were set by simulation
(documentation, "The bi-resolution method").
"""

from __future__ import annotations

from typing import Final

from acutance.targets.question import Question

__all__ = ["PAIR_QUESTIONS"]

PAIR_QUESTIONS: Final = {
    "ratio": Question(
        "How many times finer are the high image's pixels?", ">=", 2.0,
        "its own blur and aliasing count the less the finer it is", "Li et al. 5.2",
    ),
    "reference_mtf": Question(
        "Which is the high image's own MTF at the low one's Nyquist frequency?", ">=", 0.5,
        "it is divided out, and every per cent it is wrong by is in the result",
        "Li et al. 5.1, 5.2",
    ),
    "reference_directions": Question(
        "In how many directions was the reference measured?", ">=", 2.0,
        "the one is taken for all: smear or asymmetry of its sensor is then in the result; combine "
        "measurements in two directions, or use points or a star",
    ),
    "correlation": Question(
        "How much do the low image and the blurred high one correlate?", ">=", 0.9,
        "other bands, dates or views show other things", "Li et al. 5.1",
    ),
    "coherence": Question(
        "Which share of the low image's detail at Nyquist does the high one explain?", ">=", 0.1,
        "the rest is noise, aliasing and scene differences; choose a region with roads, "
        "shorelines, buildings", "Li et al. 5.2", "note",
    ),
    "high_noise": Question(
        "By which share is the MTF at Nyquist uncertain as the high image's noise is?", "<=", 0.1,
        "its power is taken off what the two have in common, and known to 30 %; state its standard "
        "deviation (noise_high, --high-noise) if it is not that, or choose a region of more detail",
        severity="note", caution=0.25,
    ),
    "pixels": Question(
        "How many low pixels were used?", ">=", 2000.0,
        "the standard deviations fall with their root; choose a larger region", severity="note",
    ),
    "left_out": Question(
        "Which share of the low pixels does not fit the rest?", "<=", 0.2,
        "clouds, shadows, changes between the two dates, defects: mask them, or choose another "
        "region",
    ),
    "registration_px": Question(
        "How much do the images shift against each other from place to place?", "<=", 0.1,
        "that blurs the kernel; choose a smaller region",
    ),
    "shift_px": Question(
        "How far does the low image lie off its geometry?", "<=", 3.0,
        "measured and allowed for, but a sign of a wrong pair or ratio", severity="note",
    ),
    "residual_correlation": Question(
        "How much do neighbouring residuals correlate?", "<=", 0.2,
        "the two bands have different colours, or the scene changed; the fit whitens the residuals "
        "and the intervals allow for it, but a difference that looks like blur stays in the MTF",
    ),
    "equal_blur": Question(
        "By how many deviations does the blur of strong and weak structures differ?", "<=", 4.0,
        "no sensor does that: a filter that removes noise and keeps edges blurs weak structures "
        "alone, and so does strong compression; use the images before it",
    ),
    "inflation": Question(
        "How many times more than white residuals explain do the regions scatter?", "<=", 2.0,
        "the standard deviations were raised by that", severity="note",
    ),
    "iteration_change": Question(
        "Did the parametric fit settle, change over threshold?", "<=", 1.0,
        "allow more steps, or a larger threshold", "Li et al. 5.3",
    ),
}  # fmt: skip
