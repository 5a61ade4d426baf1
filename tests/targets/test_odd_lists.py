"""Lists of regions, names and bands are lists, in all that measures many."""

import numpy as np
import pytest

import acutance as ac

PIXELS = np.random.default_rng(0).normal(100.0, 1.0, (60, 60))
PIXELS[:, 30:] += 100.0
RECORDS = [object(), object()]


@pytest.mark.parametrize("wrong", [3, object(), list, True])
@pytest.mark.parametrize(
    "call",
    [
        lambda x: list(ac.each_edge(PIXELS, x)),
        lambda x: list(ac.each_pulse(PIXELS, x, width_px=3.0)),
        lambda x: ac.combine(RECORDS, names=x),
        lambda x: ac.measure_biresolution(PIXELS, PIXELS, ratio="x" if x in (3, True) else x),
        lambda x: ac.measure_pulse(PIXELS, width_px=3.0, fit_width=x if x is not True else 1),
        lambda x: ac.scan_bands(x),
        lambda x: ac.scan_bands([PIXELS, PIXELS], bands=x),
        lambda x: ac.scan_scene(PIXELS, keep=x),
        lambda x: ac.read_plan(x),
        lambda x: ac.run_batch(images=x, targets="t.geojson", archive="a.db"),
        lambda x: ac.run_batch(images=["a.tif"], targets=x, archive="a.db"),
        lambda x: ac.run_batch(images=["a.tif"], targets="t.geojson", archive=x),
        lambda x: ac.execution.run_tasks(abs, [1], print, workers=x if x != 3 else "3"),
    ],
)  # fmt: skip
def test_what_is_no_list_or_path_is_refused(call, wrong):
    with pytest.raises(ac.AcutanceError, match=r"give|has to be|ha(s|ve) to|choose"):
        call(wrong)


def test_many_without_regions_are_pairs():
    with pytest.raises(
        ac.OptionError, match=r"(?s)pairs \(image, region\) .* number 1 is .*: give"
    ):
        list(ac.each_edge(PIXELS))
