"""Options of plans and studies of a type they are not declared to have."""

import pytest

from acutance import OptionError, Sensor
from acutance.optics import Detector, Gaussian
from acutance.studies import (
    TABLE_3_3,
    AngleOptions,
    GroundNoiseOptions,
    MirrorPlanOptions,
    PlanOptions,
    SnrOptions,
    WidthCorrectionOptions,
    WidthOptions,
)

SENSOR = Sensor([Gaussian(0.45), Detector()], gsd_m=0.7)


@pytest.mark.parametrize(
    ("kind", "name", "value"),
    [
        (PlanOptions, "rows", 40),
        (PlanOptions, "rows", (40.5,)),
        (PlanOptions, "angles_deg", 6.0),
        (PlanOptions, "widths_px", 3.0),
        (PlanOptions, "snr", "x"),
        (PlanOptions, "snr", float("nan")),
        (PlanOptions, "draws", 2.5),
        (PlanOptions, "target", ["edge"]),
        (WidthOptions, "widths_px", 3.0),
        (WidthOptions, "nominal_px", "x"),
        (AngleOptions, "angles_deg", 6.0),
        (AngleOptions, "places", 2.5),
        (SnrOptions, "noise_dn", 2.0),
        (SnrOptions, "draws", "x"),
        (GroundNoiseOptions, "runs", 2.5),
        (WidthCorrectionOptions, "draws", None),
        (MirrorPlanOptions, "count", 5.5),
        (MirrorPlanOptions, "sensor", "x"),
        (MirrorPlanOptions, "draws", 2.5),
        (MirrorPlanOptions, "arrangement", "circle"),
    ],
)
def test_options_of_another_type_are_refused(kind, name, value):
    needed = {"sensor": SENSOR} if kind is MirrorPlanOptions else {}
    with pytest.raises(OptionError, match=rf"{kind.__name__}: {name} has to be .*, found"):
        kind(**(needed | {name: value}))


@pytest.mark.parametrize(
    ("kind", "levels"),
    [
        (SnrOptions, {"noise_dn": (5.0, 9.0, 5.0)}),
        (GroundNoiseOptions, {"levels_dn": ((900.0, 600.0), (900.0, 600.0))}),
        (AngleOptions, {"angles_deg": (6.0, 6.0)}),
        (WidthOptions, {"widths_px": (2.9, 2.9)}),
        (WidthCorrectionOptions, {"cases": (TABLE_3_3[0], TABLE_3_3[0])}),
    ],
)
def test_a_level_that_is_named_twice_is_refused(kind, levels):
    (name,) = levels
    with pytest.raises(OptionError, match=rf"^{name} has .* more than once: name every level once"):
        kind(**levels)
