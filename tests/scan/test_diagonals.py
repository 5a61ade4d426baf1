"""A blur that lies along neither rows nor columns is that of objects, or of an image turned."""

import numpy as np
import pytest
from bare_ground import check_of_bare_ground

from acutance import optics


class Oblique:
    """A Gaussian blur whose axes are the diagonals."""

    def otf(self, u, v):
        p, q = (u + v) / np.sqrt(2), (v - u) / np.sqrt(2)
        return np.asarray(np.exp(-2 * np.pi**2 * ((0.30 * p) ** 2 + (0.45 * q) ** 2)))


@pytest.mark.parametrize(
    ("blur", "word"),
    [
        (optics.Gaussian(0.4, 0.45), "good"),
        # Its axes differ by more than a quarter, which is a note.
        (optics.Gaussian(0.33, 0.45), "usable"),
        (Oblique(), "doubtful"),
    ],
)
def test_a_sensor_is_the_same_along_both_diagonals(blur, word, few_forms):
    sensor = optics.Sensor([blur, optics.Detector()])
    # All three are Gaussian, as both forms that are left are, in any direction.
    with few_forms():
        scene, check = check_of_bare_ground("diagonals", sensor, 560, 90, seed=5)
    assert check.passed == (word != "doubtful")
    assert scene.verdict.word == word
    if word == "doubtful":
        assert "diagonal" in scene.verdict.sentence
