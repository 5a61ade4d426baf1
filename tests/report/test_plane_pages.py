"""The faces of a 2-D measurement: figure, text, CSV, JSON and page."""

from __future__ import annotations

import csv
import html
import io
import json
from dataclasses import dataclass, replace

import numpy as np
import pytest
from jsonschema import Draft202012Validator, ValidationError
from matplotlib.text import Text

from acutance import optics
from acutance.curves import Otf2d
from acutance.optics import Sensor
from acutance.report import (
    PlanePanel,
    json_text,
    measurement_schema,
    plane_csv,
    plane_document,
    plane_figure,
    plane_report,
    plane_text,
)
from acutance.report.page import figure_bytes
from acutance.targets import Check, ImageInfo, Measurement2d

SENSOR = Sensor([optics.Gaussian(0.4, 0.5), optics.Detector(), optics.Smear(0.7, "along")])
CHECKS = (
    Check("sources", 20.0, ">= 15", True, "20 sources."),
    Check("spacing_px", 3.2, ">= 5", False, "Sources stand 3.2 px apart."),
)


@dataclass(frozen=True)
class Blurred:
    """A sensor whose blur is uncertain by one latent variable."""

    band_cpp: float = 4.0

    def otf(self, u_cpp, v_cpp):
        return np.asarray(SENSOR.otf(u_cpp, v_cpp), complex)

    def factor(self, u_cpp, v_cpp):
        return (-0.02 * (u_cpp**2 + v_cpp**2) * self.otf(u_cpp, v_cpp))[:, None]


@pytest.fixture(scope="module")
def plane():
    return Measurement2d(
        kind="points", method="psf-fit", otf=Otf2d(Blurred(), (0.7, 0.72)), snr=80.0, checks=CHECKS
    )


def test_the_document_keeps_to_the_schema(plane):
    validator = Draft202012Validator(measurement_schema())
    document = json.loads(json_text(plane_document(plane, covariance=True)))
    validator.validate(document)
    factor = np.array(document["along"]["lsf"]["factor"])
    assert np.linalg.norm(factor, axis=1) == pytest.approx(document["along"]["lsf"]["std"])
    del document["along"]
    with pytest.raises(ValidationError):
        validator.validate(document)


def test_the_csv_holds_both_directions(plane):
    rows = list(csv.DictReader(io.StringIO(plane_csv(plane))))
    assert [sum(row["direction"] == name for row in rows) for name in ("across", "along")] == [
        51,
        51,
    ]
    nyquist = {row["direction"]: row for row in rows if row["freq_cpp"] == "0.50"}
    for name, response in (("across", plane.across), ("along", plane.along)):
        found = nyquist[name]
        assert float(found["mtf"]) == pytest.approx(response.mtf_nyquist.value, abs=1e-6)
        assert float(found["freq_cpm"]) == pytest.approx(0.5 / response.gsd_m, abs=1e-6)


def test_text_and_page_hold_numbers_of_both_directions_and_complaints(plane):
    text = plane_text(plane, ["  block of the method"])
    page = plane_report(plane, command="acutance points scene.tif")
    for number in (plane.across.mtf_nyquist, plane.along.mtf_nyquist):
        assert str(number) in text
    assert "block of the method" in text
    assert "Sources stand 3.2 px apart." in text
    assert "1 of 2 checks failed (spacing_px)" in page
    assert "acutance points scene.tif" in page


def test_extra_panels_are_drawn_and_widen_the_page(plane):
    drawn = []
    panels = [
        PlanePanel("one", "narrow", lambda page: drawn.append(page)),
        PlanePanel("two", "wide", lambda page: drawn.append(page), wide=True, height_in=3.0),
    ]
    plain, more = plane_figure(plane), plane_figure(plane, panels)
    assert len(drawn) == 2
    assert more.get_figheight() == pytest.approx(plain.get_figheight() + 4.3 + 3.0)
    assert figure_bytes(plain, ".png") == figure_bytes(plane_figure(plane), ".png")


def test_directions_change_places_when_along_track_is_the_x_axis(plane):
    turned = replace(plane, image=ImageInfo(along_track="x"))
    assert turned.across.mtf_nyquist.value == plane.along.mtf_nyquist.value
    assert turned.along.gsd_m == plane.across.gsd_m


class Ratio(Measurement2d):
    """Of a pair of images without a reference."""

    is_ratio = True


def test_a_ratio_of_two_sensors_is_called_one_in_every_face(plane):
    ratio = Ratio(kind="biresolution", method="kernel-fit", otf=plane.otf, snr=80.0, checks=CHECKS)
    text, page = plane_text(ratio), plane_report(ratio)
    for face in (text, page):
        assert "MTF ratio low/high at Nyquist" in face
        assert "RER of the ratio" in face
        assert "not the low sensor's own MTF" in html.unescape(face)
        assert "MTF at Nyquist" not in face
    assert "Modulation transfer function" not in page
    assert "MTF ratio low/high in steps of" in page
    words = {text.get_text() for text in plane_figure(ratio).findobj(Text)}
    assert {"MTF ratio low/high", "Line spread function of the ratio low/high"} <= words
    assert not [one for one in words if one.startswith(("Modulation", "MTF;", "MTF at", "PSF,"))]
    assert plane_csv(ratio).startswith("direction,freq_cpp,mtf_low_over_mtf_high,std,")
    assert plane_csv(plane).startswith("direction,freq_cpp,mtf,std,")
