"""Whatever studies and plans are handed in wrongly is refused in words."""

import numpy as np
import pytest

from acutance.errors import AcutanceError
from acutance.optics import Detector, Gaussian, Sensor
from acutance.studies import (
    AngleOptions,
    Design,
    MirrorPlanOptions,
    equivalent_blur,
    free_bound,
    lay_out_mirrors,
    minimum_snr,
    plan_mirrors,
    plan_target,
    run_study,
    shape_bound,
    study_angle,
)

SENSOR = Sensor([Gaussian(0.4), Detector()], gsd_m=1.0)
BLUR = equivalent_blur(SENSOR, 6.0)
DESIGN = Design("edge", 40, 6.0)
LAYOUT = lay_out_mirrors(20, pixel_m=(1.0, 1.0))
WRONG = ["x", b"x", {"a": 1}, ["a"], 1j, list, object(), np.zeros((3, 3))]


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize(
    "call",
    [
        lambda x: Design(x, 40, 6.0),
        lambda x: Design("edge", x, 6.0),
        lambda x: Design("edge", 40, x),
        lambda x: equivalent_blur(x, 6.0),
        lambda x: free_bound(x, DESIGN, 100.0),
        lambda x: free_bound(BLUR, x, 100.0),
        lambda x: free_bound(BLUR, DESIGN, x),
        lambda x: free_bound(BLUR, DESIGN, 100.0, x),
        lambda x: shape_bound(BLUR, DESIGN, x),
        lambda x: lay_out_mirrors(x, pixel_m=(1.0, 1.0)),
        lambda x: lay_out_mirrors(20, pixel_m=x),
        lambda x: lay_out_mirrors(20, pixel_m=(1.0, 1.0), arrangement=x),
        lambda x: lay_out_mirrors(20, pixel_m=(1.0, 1.0), columns=x),
        lambda x: lay_out_mirrors(20, pixel_m=(1.0, 1.0), spacing_px=x),
        lambda x: LAYOUT.gap_px(x),
        lambda x: minimum_snr(x, [1.0], 5.0),
        lambda x: minimum_snr([10.0], [1.0], x),
        lambda x: plan_mirrors(x),
        lambda x: plan_mirrors(MirrorPlanOptions(sensor=SENSOR), x),
        lambda x: plan_target(x),
        lambda x: plan_target(execution=x),
        lambda x: run_study(x),
        lambda x: run_study("angle", x),
        lambda x: study_angle(AngleOptions(sensor=SENSOR, angles_deg=(6.0,)), x),
    ],
)
def test_what_is_of_the_wrong_kind_is_refused(call, wrong):
    with pytest.raises(AcutanceError, match=r"give|ha(s|ve) to|choose|there is no study|takes"):
        call(wrong)


def test_a_layout_of_nothing_is_refused():
    with pytest.raises(AcutanceError, match="count is 0, it has to be a whole number, 1 or more"):
        lay_out_mirrors(0, pixel_m=(1.0, 1.0))
