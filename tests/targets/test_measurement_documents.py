"""What a measurement writes, its class reads."""

import json

import numpy as np
import pytest

import acutance as ac
from acutance.errors import OptionError


def test_from_dict_reads_what_to_dict_wrote():
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
    pixels, _ = ac.simulate.edge(sensor, angle_deg=6, snr=100, rng=np.random.default_rng(1))
    measured = ac.measure_edge(pixels)
    again = ac.Measurement.from_dict(json.loads(json.dumps(measured.to_dict())))
    assert again == measured.record
    assert type(measured).from_dict(measured.to_dict()).across.rer == measured.rer
    with pytest.raises(OptionError, match="no document"):
        ac.Measurement.from_dict({"schema": "acutance/target/1"})
