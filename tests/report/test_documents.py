"""JSON documents and the schema that ships with the package."""

import copy
import json

import numpy as np
import pytest
from jsonschema import Draft202012Validator, ValidationError

from acutance.report import document as document_of
from acutance.report import (
    json_text,
    measurement_schema,
    page,
    sensor_document,
    text,
    truth_document,
)


@pytest.fixture(scope="module")
def validator():
    schema = measurement_schema()
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def test_a_measurement_keeps_to_the_schema(measurement, validator):
    validator.validate(measurement.to_dict())
    validator.validate(json.loads(json_text(measurement.to_dict())))


def test_a_pulse_keeps_to_the_schema_and_has_a_width(pulse, validator):
    document = json.loads(json_text(pulse.to_dict()))
    validator.validate(document)
    assert document["width_px"]["value"] == 3.153
    del document["width_px"]
    with pytest.raises(ValidationError):
        validator.validate(document)


def test_undefined_numbers_are_null_and_keep_to_the_schema(vague_measurement, validator):
    document = json.loads(json_text(vague_measurement.to_dict()))
    validator.validate(document)
    assert document["mtf30_cpp"] == {"value": None, "std": None, "interval95": None}
    assert document["snr"] is None
    assert "fwhm_m" not in document


def test_the_covariance_comes_when_asked_and_gives_the_standard_deviations(measurement, validator):
    document = json.loads(json_text(document_of(measurement, covariance=True)))
    validator.validate(document)
    factor = np.array(document["lsf"]["factor"])
    assert np.linalg.norm(factor, axis=1) == pytest.approx(document["lsf"]["std"], rel=5e-3)
    assert "factor" not in document_of(measurement)["lsf"]


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("orientation",), "diagonal"),
        (("rer", "std"), -0.1),
        (("rer",), 0.68),
        (("image", "roi"), [1, 2, 3]),
        (("schema",), "acutance/measurement/2"),
        (("checks", 0, "passed"), "yes"),
        (("checks", 0, "severity"), "bad"),
        (("checks", 0, "sense"), ">"),
        (("verdict", "word"), "fine"),
        (("measured_directions",), ["up"]),
        (("gsd_m",), -1.0),
    ],
)
def test_the_schema_refuses_what_it_should(measurement, validator, path, value):
    document = copy.deepcopy(measurement.to_dict())
    place = document
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    with pytest.raises(ValidationError):
        validator.validate(document)


def test_json_is_strict_and_keeps_a_list_of_numbers_on_one_line():
    text = json_text({"a": [1.0, float("nan")], "b": {"c": [{"d": 1}]}, "e": [], "f": "±"})
    assert '"a": [1.0, null]' in text
    assert json.loads(text) == {"a": [1.0, None], "b": {"c": [{"d": 1}]}, "e": [], "f": "±"}


@pytest.mark.usefixtures("undrawn")
def test_comparison_and_target_hold_measurements(compared, target, validator):
    comparison = json.loads(json_text(document_of(compared)))
    whole = json.loads(json_text(document_of(target)))
    for document in (*comparison["measurements"], *whole["measurements"]):
        validator.validate(document)
    assert whole["groups"]["along"]["edges"] == [2, 3]
    assert whole["groups"]["along"]["chi_square"]["rer"] > 0
    # Text and page count from 1, and say what that is in the document.
    for shown in (text(target), page(target)):
        assert "edge 1 is measurements[0]" in shown
    assert whole["rejected"][0]["stage"] == "phases"


def test_a_truth_names_its_sensor_and_has_no_standard_deviation():
    from acutance import optics, simulate

    sensor = optics.Sensor([optics.Gaussian(0.4), optics.Detector()], gsd_m=0.5)
    _, truth = simulate.edge(sensor)
    document = json.loads(json_text(truth_document(truth, sensor)))
    assert document["mtf_nyquist"] == pytest.approx(0.2891, abs=1e-3)
    assert document["sensor"]["blocks"][0]["block"] == "Gaussian"
    assert set(document["mtf"]) == {"freq_cpp", "value", "phase_rad"}


def test_documents_of_truths_and_studies_name_both_distances_of_a_sensor():
    from acutance import optics, simulate
    from acutance.studies.result import options_dict

    sensor = optics.Sensor([optics.Detector()], gsd_m=0.5, gsd_along_m=0.7)
    _, truth = simulate.edge(sensor)
    for own in (truth_document(truth, sensor)["sensor"], options_dict(sensor)):
        assert (own["gsd_m"], own["gsd_along_m"]) == (0.5, 0.7)
    assert truth_document(truth, sensor)["sensor"] == sensor_document(sensor)


def test_the_truth_of_a_pulse_has_its_width_and_three_levels():
    from acutance import optics, simulate

    sensor = optics.Sensor([optics.Gaussian(0.4), optics.Detector()], gsd_m=2.8)
    _, truth = simulate.pulse(sensor, width_px=3.0, dark=100.0, right_dark=150.0)
    document = json.loads(json_text(truth_document(truth, sensor)))
    assert (document["dark"], document["bright"], document["dark_behind"]) == (100, 1200, 150)
    assert document["width_m"] == pytest.approx(8.4)
    assert document["prf_fwhm_px"] == pytest.approx(3.0, abs=0.05)
