"""A budget as text, JSON and figure."""

import json

import pytest

from acutance.optics import Detector, Gaussian, Sensor, budget, preset
from acutance.report import budget_document, budget_figure, budget_text, json_text

GENERIC = budget(preset("generic-2005"))
OBLONG = budget(Sensor([Gaussian(0.4), Detector()], gsd_m=0.7, gsd_along_m=0.9))


def test_text_lists_every_block_and_the_whole():
    lines = budget_text(GENERIC).splitlines()
    assert lines[3].startswith("Gaussian sigma 0.39 px")
    assert lines[3].split("  ")[-1].startswith("exp(-2 pi^2")
    assert [line.split()[0] for line in lines[3:]] == [
        "Gaussian",
        "Detector",
        "Smear",
        "Butterworth",
        "all",
    ]
    assert "0.7143 cycles per metre across, 0.5556 along" in budget_text(OBLONG)


def test_the_document_is_strict_json():
    document = json.loads(json_text(budget_document(OBLONG)))
    assert document["schema"] == "acutance/budget/1"
    assert document["freq_cpm"] == pytest.approx([0.5 / 0.7, 0.5 / 0.9])
    assert document["sensor"]["gsd_along_m"] == 0.9
    assert [row["block"] for row in document["rows"]] == ["Gaussian", "Detector"]


def test_the_figure_draws_both_directions():
    page = budget_figure(GENERIC)
    across, along = page.axes
    # The number stands where no curve can cross it.
    assert across.get_title(loc="left") == "Across: 0.2665 at 0.5 c/px"
    assert along.get_title(loc="left") == "Along: 0.2597 at 0.5 c/px"
    # Four blocks, the whole, and the mark at Nyquist.
    assert len(across.lines) == len(along.lines) == 6
    assert along.lines[-1].get_ydata()[0] == pytest.approx(0.2597, abs=5e-5)
