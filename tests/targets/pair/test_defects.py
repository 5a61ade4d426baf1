"""Single values far beyond all others, in one image of a pair: left out, named, no harm done."""

import numpy as np
import pytest

import acutance as ac
from acutance import simulate
from acutance.errors import TargetError
from acutance.optics import Detector, Gaussian, Sensor
from acutance.targets.pair.defects import find_defects, repaired

LOW = Sensor([Gaussian(0.4), Detector()])
HIGH = Sensor([Gaussian(0.35), Detector()])


@pytest.fixture(scope="module")
def images():
    low, high, _ = simulate.pair(LOW, HIGH, ratio=3, shape=(72, 72), snr=100,
                                 rng=np.random.default_rng(5))  # fmt: skip
    return low, high


@pytest.fixture(scope="module")
def clean(images):
    return ac.measure_biresolution(*images, ratio=3)


def changed(image, value, *places):
    found = image.copy()
    for place in places:
        found[place] = value
    return found


def checks_of(found):
    return {check.name: check for check in found.checks}


@pytest.mark.parametrize("value", [1e6, 1e30, -3.4e38])
@pytest.mark.parametrize("which", ["low", "high"])
def test_a_value_beyond_any_scene_is_left_out_and_named(images, clean, which, value):
    low, high = images
    if which == "low":
        low = changed(low, value, (36, 30))
    else:
        high = changed(high, value, (105, 110))
    found = ac.measure_biresolution(low, high, ratio=3)
    std = clean.across.mtf_nyquist.std
    assert abs(found.across.mtf_nyquist.value - clean.across.mtf_nyquist.value) < 0.5 * std
    assert found.verdict.word == clean.verdict.word
    assert checks_of(found)["coherence"].passed
    counts = ("1", "0") if which == "low" else ("0", "1")
    named = "{} pixels of the low image and {} samples".format(*counts)
    assert named in checks_of(found)["left_out"].message


def test_one_hot_pixel_leaves_the_windows_of_the_spectra(images, clean):
    low, high = images
    hot = low.mean() + 6 * low.std()
    found = ac.measure_biresolution(changed(low, hot, (36, 30)), high, ratio=3)
    assert found.coherence.windows == clean.coherence.windows
    value, usual = (checks_of(one)["coherence"].value for one in (found, clean))
    assert value == pytest.approx(usual, abs=0.05)
    assert found.left_out <= clean.left_out + 5


def test_what_both_images_show_is_kept():
    """A lamp on dark ground is no defect, wherever the other image lies by then."""
    rng = np.random.default_rng(1)
    samples = rng.normal(size=(3 * 98, 3 * 98))
    samples[150:153, 141:144] += 3000.0
    low = rng.normal(size=(50, 50)) / 3
    low[30, 20] += 1000.0
    found = find_defects(low, samples, (3, 3))
    assert not found.low.any()
    assert not found.high.any()
    alone = find_defects(rng.normal(size=(50, 50)), samples, (3, 3))
    assert alone.high.sum() == 9
    assert find_defects(low, rng.normal(size=samples.shape), (3, 3)).low.sum() == 1


def test_even_ground_has_no_defects():
    low, samples = np.zeros((30, 30)), np.zeros((78, 78))
    low[4, 4] = 100.0
    found = find_defects(low, samples, (1, 1))
    assert not found.low.any()
    assert not found.high.any()


def test_a_repaired_value_is_that_of_its_neighbours():
    rows, cols = np.indices((20, 20), dtype=float)
    field, bad = rows + 2 * cols, np.zeros((20, 20), bool)
    bad[8:10, 9] = True
    found = repaired(np.where(bad, 1e30, field), bad, 2)
    assert np.abs(found - field).max() < 0.6
    assert np.array_equal(found[~bad], field[~bad])


def test_an_even_pair_with_one_source_is_refused_in_words():
    low = np.zeros((60, 60))
    low[30, 30] = 100.0
    high = np.repeat(np.repeat(low, 3, 0), 3, 1)
    with pytest.raises(TargetError, match="even but for a few outlying values"):
        ac.measure_biresolution(low, high, ratio=3)
