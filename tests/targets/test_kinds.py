"""The table of kinds names what the rooms have, and loads none of them."""

import importlib
import inspect
import subprocess
import sys

import numpy as np
import pytest

from acutance.errors import OptionError
from acutance.targets.kinds import KINDS, methods_text

TABLES = {
    "edge": "METHODS",
    "pulse": "PULSE_METHODS",
    "points": "POINTS_METHODS",
    "biresolution": "BIRESOLUTION_METHODS",
    "bars": "BARS_METHODS",
    "star": "STAR_METHODS",
}
MEASURED = [kind for kind in KINDS.values() if kind.name != "combined"]


@pytest.mark.parametrize("kind", KINDS.values(), ids=lambda kind: kind.name)
def test_the_room_has_what_the_table_names(kind):
    assert inspect.isfunction(kind.load(kind.measure))
    assert kind.load(kind.options)().limits == {}
    if kind.measure_all is not None:
        assert inspect.isfunction(kind.load(kind.measure_all))


@pytest.mark.parametrize("kind", MEASURED, ids=lambda kind: kind.name)
def test_methods_are_those_of_the_room_the_reference_first(kind):
    assert list(kind.methods) == list(
        getattr(importlib.import_module(kind.room), TABLES[kind.name])
    )
    parameters = inspect.signature(kind.load(kind.measure)).parameters
    assert parameters["method"].default == kind.methods[0]
    assert {"roi", "options"} <= set(parameters)


@pytest.mark.parametrize("kind", MEASURED, ids=lambda kind: kind.name)
def test_a_method_that_is_not_in_the_table_is_refused(kind):
    images = [np.eye(40)] * (2 if kind.name == "biresolution" else 1)
    with pytest.raises(OptionError, match="magic"):
        kind.load(kind.measure)(*images, method="magic")


def test_the_table_is_read_without_numpy():
    code = "import acutance.targets.kinds, sys; print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


def test_methods_in_a_help_text():
    assert methods_text(("joint",)) == "joint"
    assert methods_text(("spline", "fermi")) == "spline (the reference) or fermi"
    assert methods_text(("a", "b", "c")) == "a (the reference), b or c"
