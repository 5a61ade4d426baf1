"""Every question asked of a target: its limit, what a failure means and what to do, its source.

Sources: the KOMPSAT-3 draft (Lee et al. 2014); Li et al., "On-orbit MTF estimation methods"; the
QuickBird report (Helder et al. 2003); the pulse report (Helder and Choi 2005). Limits without a
source were set by simulation: documentation, "Edges", "Pulses", "Points" and so on.
"""

from __future__ import annotations

from acutance.targets.pair_questions import PAIR_QUESTIONS
from acutance.targets.processing_questions import PROCESSING_QUESTIONS
from acutance.targets.question import PLACES, Question
from acutance.targets.scene_questions import SCENE_QUESTIONS

__all__ = ["QUESTIONS"]

_ANY_TARGET = {
    "contrast_snr": Question(
        "How large is the contrast, relative to the noise?", ">=", 50.0,
        "the intervals widen; choose a target of more contrast, or a longer one",
        "KOMPSAT-3 draft 3c; pulse report 3.4 (edges, pulses: 20, simulated)", "note",
    ),
    "saturation": Question(
        "Which share of the pixels is clipped at an end of the scale?", "<=", 0.001,
        "the target's height and shape are then not those of the scene", severity="fail",
    ),
    "undeclared_fill": Question(
        "How many pixels are a constant without data that the image does not declare?", "<=", 0.0,
        "they are left out; declare the value (nodata, --nodata), or state that every value is "
        "data (nan)", severity="note",
    ),
    "stated_gsd": Question(
        "By which factor does the stated GSD differ from the image's own?", "<=", 3.0,
        "numbers in metres follow the stated one; give metres, not centimetres (gsd_m, --gsd)",
    ),
    "correlated_noise": Question(
        "How much do neighbouring pixels' noise correlate?", "<=", 0.1,
        "texture, resampling or structure, which the intervals allow for", severity="note",
    ),
    "outliers": Question(
        "Which share of the pixels lies far from the fit?", "<=", 0.02,
        "objects on the target, or a fit that does not hold; choose a cleaner region",
    ),
    "full_pixel": Question(
        "Which MTF at Nyquist is surely exceeded?", "<=", 0.66,
        "no sensor whose pixels touch is that sharp: the image was sharpened, decimated or drawn",
        severity="note",
    ),
}  # fmt: skip

_STRAIGHT = {
    **{
        f"uniformity_{side}": Question(
            f"How uniform is the plateau {where}, contrast over variation?", ">=", 20.0,
            "the intervals allow for it", "simulated (KOMPSAT-3 draft 3b: 50)", "note",
        )
        for side, where in PLACES.items()
    },
    "uniformity_target": Question(
        "How uniform is the pulse itself, height over variation?", ">=", 50.0,
        "seams, dirt, a ridge or sides that are not straight", "as KOMPSAT-3 draft 3b",
    ),
    "angle_deg": Question(
        "How inclined is the edge to the grid?", "<=", 45.0,
        "use the method spline, or another edge",
        "KOMPSAT-3 draft 3d (30 degrees for methods that work row by row)",
    ),
    "sample_phases": Question(
        "How many sub-pixel phases do the samples have?", ">=", 3.0,
        "with so few fine structure is not determined; the intervals are wider", severity="note",
    ),
    "rows": Question(
        "How many pixels of the edge's length are used?", ">=", 20.0,
        "the intervals are wide; choose a region with more of it",
        "KOMPSAT-3 draft 3e (more than 10 to 20 rows)", "note",
    ),
    "straightness_px": Question(
        "How far does the edge leave its line?", "<=", 0.05, "choose a straighter part",
    ),
    "blur_uniformity": Question(
        "How much of the MTF at Nyquist does the blur change along the edge?", "<=", 0.05,
        "another edge crosses it, or it is not equally sharp everywhere; choose a shorter part",
    ),
    "edge_roughness_px": Question(
        "How far does the edge move to and fro from pixel to pixel?", "<=", 0.05,
        "it is rough, another edge crosses it, or the fit does not follow; choose another part",
    ),
    "lsf_width_px": Question(
        "Is the LSF as wide as that of any detector?", ">=", 0.5,
        "no detector is that narrow: the numbers are no sampled light (wrapped around the end of "
        "their type, thresholded, or drawn)", severity="fail",
    ),
    "lsf_narrow_px": Question(
        "Is the LSF as narrow as that of a camera?", "<=", 3.2,
        "the border is soft on the ground (forest, cloud, hedge), or the image was enlarged",
    ),
    **{
        f"plateau_{side}_px": Question(
            f"How wide is the uniform plateau {where}?", ">=", 7.0,
            "a halo beyond it is not measured, and the intervals are wide",
            "Li et al. 4.2 (7 to 10)", "note",
        )
        for side, where in PLACES.items()
    },
    "quantisation": Question(
        "How many steps of the image's numbers is the noise?", ">=", 0.2,
        "so much rounding is no noise: it is equal for the pixels of a plateau and shifts its "
        "level by more than the intervals; use data of more bits",
    ),
    "nonlinearity": Question(
        "How far from a straight line between the plateaus is the image's characteristic?",
        "<=", 0.01,
        "values that are not proportional to light change RER and MTF; linearise the image by its "
        "known curve (linearize, --gamma, --linearize), or take the product before its "
        "enhancement",
    ),
    "gradient": Question(
        "How steep is the background far from the target, against light that an aperture scatters?",
        "<=", 1.0,
        "the ground is not level there, or the sensor has a wide halo, which lowers the MTF; both "
        "look alike here, and the intervals allow for either; choose a region with level sides",
        severity="note",
    ),
    "structure": Question(
        "How much does the profile go up and down next to the edge?", "<=", 0.02,
        "something else lies there, and its spectrum is taken for the sensor's",
    ),
    "asymmetric_wings": Question(
        "Do the far wings of the LSF hold equal light on both sides?", "<=", 0.01,
        "no halo does this; a step of the background parallel to the edge does, or a long charge "
        "trail; choose another side or a narrower region",
    ),
    "profile": Question(
        "How far do the pixels leave the fit in the same way all along the target?", "<=", 0.0005,
        "parallel lines, an uneven pulse, or ringing finer than the fit follows; below 2 % "
        "intervals have held all the same, above no interval allows for it",
        severity="note", caution=0.02,
    ),
    "ground": Question(
        "How much does the ground beside the target differ from its level at the target?",
        "<=", 0.02, "the fit follows it, and the intervals allow for it", severity="note",
    ),
    "close_ground": Question(
        "How much does the ground step where the blur of the target ends?", "<=", 0.05,
        "a step closer to it would be taken for blur; choose a target with a plain border",
        severity="note", caution=0.2,
    ),
    "asymmetric_lsf": Question(
        "How far is the ESF from symmetric about its middle?", "<=", 0.01,
        "a thin strip, an uneven pulse, a trail, or interpolation at one phase; compare others",
        severity="note",
    ),
    "rim": Question(
        "How probable is a strip along the border that moves RER or MTF at Nyquist?", "<=", 0.1,
        "a rim, gutter or kerb is then taken for the sensor's; compare other edges",
    ),
    "one_sided_overshoot": Question(
        "How much more does the profile overshoot on one side than on the other?", "<=", 0.03,
        "sharpening does so on both: a bright rim or a dark line runs along the edge; choose "
        "another edge",
    ),
    "double_edge": Question(
        "How high is a second peak of the LSF, relative to the first?", "<=", 0.15,
        "two edges lie close to one another; choose another one", severity="fail",
    ),
    "mirrored_ground": Question(
        "How much is the ground on one side the mirror image of that on the other?", "<=", 0.8,
        "ground is not; ringing of a sharpened or compressed product is, and it is then missing "
        "from the sensor's MTF; measure another target of the product",
    ),
    "parallel_deg": Question(
        "Are the two sides of the pulse parallel?", "<=", 0.5,
        "the width changes along the target; choose another part, or another target",
        "Li et al. 3.2",
    ),
    "background_step": Question(
        "How much do the backgrounds before and behind the pulse differ?", "<=", 0.25,
        "the joint fit allows for it, the ratio to a symmetric pulse does not",
    ),
    "width_px": Question(
        "Is the pulse wide enough?", ">=", 2.0,
        "the narrower, the less signal; use a target of three times the GSD",
        "Li et al. 3.2", "note",
    ),
    "width_sigmas": Question(
        "Does the stated width agree with the image?", "<=", 3.0,
        "measure the target again, and check the GSD",
    ),
    "zero_distance_cpp": Question(
        "How far are the reported frequencies from the zeros of the pulse's spectrum?", ">=", 0.08,
        "the ratio is unusable at a zero and uncertain near it; use method spline, or a target of "
        "another width", "Li et al. 3.2",
    ),
}  # fmt: skip

_POINTS = {
    "sources": Question(
        "How many sources were measured?", ">=", 15.0,
        "the intervals are wide; 15 to 20 give a reasonable result", "Li et al. 2.2", "note",
    ),
    "peak_snr": Question(
        "How many times the background's noise is the median source's peak?", ">=", 50.0,
        "the intervals widen; use larger mirrors, or more of them", "QuickBird report 3.6", "note",
    ),
    "spacing_px": Question(
        "How far apart are the two nearest sources?", ">=", 5.0,
        "their wings overlap; set them further apart", "QuickBird report 5.7.2; Li et al. 2.2",
    ),
    "phase_gap_px": Question(
        "How large is the gap in the sub-pixel phases?", "<=", 0.25,
        "fine structure is not determined and the intervals are wider, and need not hold where all "
        "sources have about one phase; steps of 0.2 by 0.25 px leave 0.16",
        "QuickBird report 5.7.2", "note", caution=0.66,
    ),
    "full_scale": Question(
        "Where in the detector's range is the brightest pixel?", "<=", 0.9,
        "near its end the detector may not be linear; about 75 % is best", "Li et al. 2.2",
    ),
    "psf_width_px": Question(
        "Is the PSF as narrow as that of a camera?", "<=", 5.0,
        "these are no images of points but parts of edges, roofs and the like, or they are far out "
        "of focus: give the places of mirrors, lamps or stars, or a region that holds nothing else",
        severity="fail",
    ),
    "source_misfit": Question(
        "How many times the noise are the residuals of the worst source?", "<=", 1.5,
        "it is no point, or the PSF differs over the region; leave it out",
    ),
    "equal_widths": Question(
        "By how many deviations do the widths of the sources differ more than by noise?",
        "<=", 4.0,
        "mirrors of different sizes, doubles, or a PSF that differs over the region: the MTF is "
        "that of their mean; leave out the wide ones, or measure parts of the region",
    ),
    "background_uniformity": Question(
        "How much do the backgrounds differ, relative to the median peak?", "<=", 0.05,
        "use a uniform grassy area", "QuickBird report 4.4",
    ),
    "background_curvature": Question(
        "How far does the ground bend within the reach of a source, relative to the median peak?",
        "<=", 0.002,
        "a bent background is taken for wings of the PSF; choose a plane area, or use fewer "
        "pixels around each source (radius_px)",
    ),
    "positions": Question(
        "Which share of the positions has a source?", ">=", 0.5, "give row, column of this image",
    ),
    "survey_px": Question(
        "How far are the measured places from the surveyed ones?", "<=", 0.1,
        "check the survey, or the order of its points", "QuickBird report 5.7.3 (0.017 to 0.047)",
    ),
}  # fmt: skip

_PERIODIC = {
    "level": Question(
        "How well is the contrast before the sensor known?", "<=", 0.01,
        "it scales the whole MTF, and the intervals are wide: state the levels of wide patches of "
        "the same materials (dark and bright), add a group of wide bars, or use a star with fewer "
        "cycles or a larger radius",
        severity="note", caution=0.2,
    ),
    "stated_levels": Question(
        "How far are the stated levels from those of the image, relative to their contrast?",
        "<=", 0.05,
        "they scale the whole MTF: take both from wide patches of the same materials in this "
        "image and band (dark and bright), or state none", severity="fail",
    ),
    "contrast_uniformity": Question(
        "How much does the contrast differ from group to group, or from side to side?",
        "<=", 0.005,
        "paint, haze or a cloud differ there, and a part of it is taken for the sensor; leave the "
        "group out, or take another image",
    ),
    "coarsest_cpp": Question(
        "Which is the frequency of the widest bars?", "<=", 0.2,
        "below it the MTF follows from the outline of the groups", severity="note",
    ),
    "finest_cpp": Question(
        "Which is the frequency of the finest bars?", ">=", 0.4,
        "beyond it the MTF follows from the bars' edges, which aliasing mixes up",
        severity="note",
    ),
    "bars": Question(
        "How many bars has the smallest group?", ">=", 3.0,
        "with fewer than 3 its frequency is not one",
    ),
    "bar_directions": Question(
        "In how many directions do the bars point?", ">=", 1.0,
        "other directions follow from what all sensors have in common, with wide intervals",
        severity="note",
    ),
    "misfit": Question(
        "How many times the noise are the residuals of the worst group?", "<=", 1.5,
        "it may be damaged, or have other bars than it was taken for",
    ),
    "rim_cpp": Question(
        "Which is the frequency of the widest spokes?", "<=", 0.15,
        "below it the MTF is continued to 1 at zero frequency, not measured", severity="note",
    ),
    "centre_cpp": Question(
        "Which is the frequency of the finest spokes?", ">=", 0.5,
        "beyond it the MTF is continued, not measured", severity="note",
    ),
    "sweep_deg": Question(
        "Which angle of directions does the star hold?", ">=", 90.0,
        "the other directions follow from what all sensors have in common, with wide intervals",
        severity="note",
    ),
    "wave": Question(
        "Which share of the contrast is a third harmonic that the stated wave does not have?",
        "<=", 0.01,
        "the star may be a square wave instead of a sine, or the other way round, bright and dark "
        "spokes may not be equally wide, or a slanted view or pixels that are not square make an "
        "ellipse of it", severity="fail",
    ),
}  # fmt: skip

_COMBINED = {
    "agreement": Question(
        "Which is the chance of a larger chi-square, if the measurements agree?", ">=", 0.01,
        "they differ by more than their deviations explain, which were widened for it",
    ),
    "worst_member": Question(
        "Which is that chance for the measurement that fits least?", ">=", 0.01,
        "leave it out, or find why it differs",
    ),
    "plain_sensor": Question(
        "Which is that chance for the best product of OTF blocks?", ">=", 0.01,
        "its parameters are only a description", severity="note",
    ),
    "correction": Question(
        "How much of the logarithm of the MTF is that of no product of OTF blocks?", "<=", 0.1,
        "no sensor's MTF changes like that with direction and frequency: the measurements are not "
        "of one sensor, or one of them is wrong; leave out the one that fits least",
        severity="fail",
    ),
    "beyond_members": Question(
        "How far does the MTF lie beyond that of every measurement?", "<=", 0.02,
        "no sensor is less, or more, sharp than each of its measurements: they are of several, or "
        "one of them is wrong; leave out the one that fits least", severity="fail",
    ),
    "directions": Question(
        "How many directions differ by 15 degrees?", ">=", 3.0,
        "rotation and asymmetry follow from the prior alone: add an edge at 30 to 60 degrees, "
        "points or a star", severity="note",
    ),
    "failed_inputs": Question(
        "How many measurements are doubtful or invalid themselves?", "<=", 0.0,
        "read those checks, or leave the measurements out",
    ),
    "shared_targets": Question(
        "How many pairs of measurements used the same pixels?", "<=", 0.0,
        "the same pixels count only once, or the deviations become too small",
    ),
    "assumed_covariance": Question(
        "How many measurements come without covariance?", "<=", 0.0,
        "errors at frequencies within 0.08 c/px are taken to be equal: write the JSON again with "
        "this version", severity="note",
    ),
    "unknown_gsd": Question(
        "How many measurements come without a GSD, where others have one?", "<=", 0.0,
        "their pixels may be others: state the GSD when measuring, or that of all when combining",
    ),
}  # fmt: skip

QUESTIONS: dict[str, Question] = {
    **_ANY_TARGET, **PROCESSING_QUESTIONS, **_STRAIGHT, **_POINTS, **_PERIODIC, **PAIR_QUESTIONS,
    **_COMBINED, **SCENE_QUESTIONS,
}  # fmt: skip
"""All questions by name; each kind of target asks some of them."""
