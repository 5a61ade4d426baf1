"""A sensor twice as sharp across as along is seldom one: borders of a direction are soft alike."""

import pytest
from bare_ground import check_of_bare_ground

from acutance import optics


@pytest.mark.parametrize(
    ("smear_px", "size_px", "word"),
    [(0.01, 480, "good"), (0.9, 480, "usable"), (1.3, 480, "doubtful"), (1.3, 720, "usable")],
)
def test_a_scan_says_when_its_axes_surely_differ(smear_px, size_px, word):
    """A smear of .9 px makes 43 % at Nyquist, one of 1.3 px 129 %.

    Where there are edges enough the parts of the scene were asked, and agree about it.
    """
    blocks = [optics.Gaussian(0.35), optics.Detector(), optics.Smear(smear_px, "along")]
    sensor = optics.Sensor(blocks)
    scene, check = check_of_bare_ground("axes_differ", sensor, size_px, 120, seed=7)
    assert check.passed == (word == "good")
    assert scene.verdict.word == word
    if word == "doubtful":
        assert "soft alike" in scene.verdict.sentence
    elif word == "usable":
        assert check.value > 0.25
