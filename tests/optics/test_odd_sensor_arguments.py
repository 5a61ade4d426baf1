"""Whatever a sensor and its functions are handed in wrongly is refused in words."""

import math
import re

import numpy as np
import pytest

from acutance.errors import AcutanceError, ModelError, OptionError
from acutance.optics import (
    FAMILIES,
    Detector,
    Gaussian,
    RasterPsf,
    Sensor,
    SensorFile,
    Smear,
    budget,
    describe_block,
    draw_sensor,
    numerical_psf,
    on_the_ground,
    preset,
    psf_on_the_ground,
    read_sensor,
    sensor_file_from_toml,
    sensor_file_to_toml,
    write_sensor,
)

SENSOR = Sensor([Gaussian(0.4), Detector()], gsd_m=1.0)
FAMILY = next(iter(FAMILIES))
RNG = np.random.default_rng(1)
WRONG = ["x", b"x", None, [], {}, ["a"], 1j, list, object(), np.zeros((3, 3))]


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize(
    "call",
    [
        lambda x: SENSOR.psf(x),
        lambda x: SENSOR.psf(step_px=x),
        lambda x: SENSOR.response(3.0, x),
        lambda x: SENSOR.gsd_along_normal_m(x),
        lambda x: budget(x),
        lambda x: budget(SENSOR, x),
        lambda x: describe_block(x),
        lambda x: draw_sensor(x, RNG),
        lambda x: draw_sensor(FAMILY, x),
        lambda x: numerical_psf(x),
        lambda x: numerical_psf(SENSOR, subpixels=x),
        lambda x: numerical_psf(SENSOR, trim_px=x),
        lambda x: on_the_ground(x),
        lambda x: preset(x),
        lambda x: psf_on_the_ground(x),
        lambda x: psf_on_the_ground(SENSOR, x),
        lambda x: psf_on_the_ground(SENSOR, step_m=x),
        lambda x: RasterPsf(np.ones((3, 3)), x),
        lambda x: Smear(0.1, x),
        lambda x: sensor_file_from_toml(x),
        lambda x: sensor_file_to_toml(x),
        lambda x: SensorFile(x),
        lambda x: write_sensor(x, "never.toml"),
    ],
)
def test_what_is_of_the_wrong_kind_is_refused(call, wrong):
    words = r"give|has to be|choose|there is no|is no TOML|pass numpy"
    with pytest.raises(AcutanceError, match=words):
        call(wrong)


@pytest.mark.parametrize("wrong", ["x", b"x", {}, ["a"], 1j, list, object()])
@pytest.mark.parametrize(
    "call",
    [
        lambda x: SENSOR.otf(x, 0.0),
        lambda x: SENSOR.otf(0.0, x),
        lambda x: SENSOR.profile(3.0).esf(x),
        lambda x: SENSOR.profile(3.0).lsf(x),
        lambda x: RasterPsf(x, 0.5),
    ],
)
def test_arrays_hold_numbers(call, wrong):
    with pytest.raises(OptionError, match="it has to hold numbers"):
        call(wrong)


@pytest.mark.parametrize("path", [None, 3, [], b"x", {}])
def test_a_path_is_a_text(path):
    for call in (lambda: read_sensor(path), lambda: write_sensor(SENSOR, path)):
        with pytest.raises(OptionError, match=r"path is .*: give the path of a file"):
            call()


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: budget(SENSOR, math.inf), ModelError, "freq_cpp is inf, .* finite"),
        (lambda: budget(SENSOR, -1), ModelError, "freq_cpp is -1, it has to be at least 0"),
        (lambda: RasterPsf(np.ones(3), 0.5), ModelError, r"shape \(3,\): give rows and columns"),
        (lambda: RasterPsf([[math.nan]], 0.5), ModelError, "give rows and columns of finite"),
        (lambda: RasterPsf(np.ones((3, 3)), 0), ModelError, "step_px is 0, .* above 0"),
        (lambda: numerical_psf(SENSOR, subpixels=2.5), OptionError, "subpixels is 2.5, .* whole"),
        (lambda: SensorFile(SENSOR, sources=("a",)), OptionError, "1 sources of 2 blocks: give"),
        (lambda: SensorFile(SENSOR, name=3), OptionError, "name has to be text, found 3"),
        (lambda: read_sensor("a\0b"), ModelError, "cannot be read .*check its path"),
        (lambda: write_sensor(SENSOR, "a\0b"), ModelError, "cannot be written .*another path"),
    ],
)
def test_what_makes_no_sense_is_refused(call, error, message):
    with pytest.raises(error, match=re.compile(message, re.DOTALL)):
        call()
