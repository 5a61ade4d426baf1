"""Drawings of files with strange names are well-formed."""

from dataclasses import replace
from xml.etree import ElementTree

import pytest

from acutance.report.figure import measurement_figure
from acutance.report.paper import figure_bytes


@pytest.mark.filterwarnings("ignore:Glyph")
def test_an_svg_has_no_control_characters(measurement):
    named = replace(measurement, image=replace(measurement.image, path="a\x01b.tif"))
    ElementTree.fromstring(figure_bytes(measurement_figure(named), ".svg"))
