"""Questions asked of whole scenes: limits by simulation (documentation, "Scenes")."""

from __future__ import annotations

from typing import Final

from acutance.targets.question import Question

__all__ = ["SCENE_QUESTIONS"]

SCENE_QUESTIONS: Final = {
    "edges_used": Question(
        "How many edges of the scene are used?", ">=", 30.0,
        "the intervals widen, and few of the objects may be ideal; scan a larger part, or several "
        "scenes and combine them", severity="note",
    ),
    "trusted_share": Question(
        "Which share of the edges that can be measured, faint ones apart, is good or usable?",
        ">=", 0.2,
        "where nearly all edges contradict a sensor, those that pass may do so by chance: the "
        "image may be decimated, drawn or a mosaic; scan the original",
    ),
    "scene_directions": Question(
        "In how many directions, of 15 degrees each, are there edges?", ">=", 4.0,
        "rotation and asymmetry follow from the prior alone", severity="note",
    ),
    "ideal_share": Question(
        "Which share of the objects is blurred by 0.1 px at most?", ">=", 0.15,
        "few objects show the sensor itself, the intervals widen; scan built-up areas, or more",
        severity="note",
    ),
    "ideal_borders": Question(
        "How many borders, of one or more pieces, are those of ideal objects?", ">=", 6.0,
        "a blur that differs by direction has three numbers, and three borders agree with one "
        "whatever their objects are; scan a larger part, or several scenes and combine them",
        severity="note", caution=4.0,
    ),
    "strange_share": Question(
        "Which share of the edges is neither ideal nor soft?", "<=", 0.15,
        "the sensor may change over the scene, or rims, shadows and processing make other edges",
    ),
    "scene_settled": Question(
        "Did the fit of sensor and objects fail to settle?", "<=", 0.0,
        "the edges do not separate the sensor from its objects", severity="fail",
    ),
    "form_agrees": Question(
        "How much more do edges differ from the form of the sensor than their deviations say?",
        "<=", 1.5,
        "no form of sensor is like these edges, or they do not have one: the numbers may err by "
        "more than their intervals; look at the edges by direction",
    ),
    "halo_share": Question(
        "Which share of the light lies in a halo?", "<=", 0.2,
        "optics scatter less; borders that fall off slowly (hedges, banks, wet ground) were taken "
        "for ideal ones: scan a larger part, or another image",
    ),
    "parts_agree": Question(
        "By which share is the MTF at Nyquist uncertain as the parts disagree?", "<=", 0.05,
        "their objects differ in a softness that all of them have; compare other scenes",
        severity="note",
    ),
    "rival": Question(
        "How much smaller is the log likelihood of the likeliest other sensor?", ">=", 20.0,
        "its ideal objects would be others, of few borders: so small a difference may be theirs; "
        "scan a larger part, or another image, and compare",
    ),
    "diagonals": Question(
        "By which share do the MTFs along the two diagonals surely differ?", "<=", 0.1,
        "the blur of a sensor lies along rows and columns: unless this image was turned, the "
        "objects of one diagonal are softer, or those of few borders were taken for ideal ones; "
        "scan a larger part, or another image",
    ),
    "axes_differ": Question(
        "By which share does the larger MTF across or along surely exceed the other?", "<=", 0.25,
        "a smear of one pixel makes 57 % at Nyquist; borders of one direction that are all soft "
        "alike pass for one: scan a larger part, or another image, and compare",
        severity="note", caution=0.6,
    ),
    "field_change": Question(
        "By which share of its mean does sharpness surely change over the field?", "<=", 0.1,
        "the numbers are means over the field: read those of the places", severity="note",
    ),
}  # fmt: skip
