"""The HTML report: whole, safe, and holding the numbers."""

import re
from dataclasses import replace
from xml.etree import ElementTree

from acutance.report import comparison_report, edge_report, target_report
from acutance.report.html import Headline, Link, Section, Table, Verdict, render_report
from acutance.targets.measurement import Check


def parsed(page):
    """The page as a tree; it is written so that an XML parser can read it too."""
    return ElementTree.fromstring(page.removeprefix("<!DOCTYPE html>"))


def words(page):
    return " ".join(" ".join(parsed(page).find("body").itertext()).split())


def test_the_edge_report_holds_numbers_checks_and_how_to_repeat_it(measurement):
    page = edge_report(measurement)
    text = words(page)
    for number in measurement.metrics().values():
        assert str(number).split(" ± ")[0] in text
    for check in measurement.checks:
        assert check.name in text
    assert "KOMPSAT-3 draft, step 2" in text
    assert "acutance edge scene.tif --roi 100,260,40,36 --gsd 0.7 --method spline" in text
    assert "limits.contrast_snr" in text
    assert len(parsed(page).findall(".//img")) == 4
    assert len(re.findall(r"<tr><td class=\"r\">\d\.\d\d</td>", page)) == 51


def test_the_report_of_a_pulse_speaks_of_a_pulse(pulse, make_pulse):
    text = words(edge_report(pulse))
    assert "Pulse measurement, across" in text
    assert "A pulse, across: angle" in text
    assert "Width on the ground" in text
    # Nothing was stated: the command that repeats it states nothing.
    assert "acutance pulse scene.tif --roi 100,260,40,36 --gsd 0.7 --method" in text
    stated = replace(pulse, stated_width_px=3.1500000)
    assert "--gsd 0.7 --width-px 3.15 --method" in words(edge_report(stated))
    held = replace(make_pulse(width_std=0.0), stated_width_px=3.153)
    assert "--width-px 3.153 --hold-width --method" in words(edge_report(held))


def test_the_command_says_which_axis_is_along_track(measurement):
    turned = replace(measurement, image=replace(measurement.image, along_track="x"))
    assert "Edge measurement, along" in words(edge_report(turned))
    assert "--along-track x --method" in words(edge_report(turned))


def test_nothing_is_loaded_from_elsewhere(measurement, compared, truth, target):
    for page in (
        edge_report(measurement),
        comparison_report(compared, truth=truth),
        target_report(target),
    ):
        addresses = re.findall(r"(?:src|href)=\"([^\"]{1,40})", page)
        assert addresses
        assert all(address.startswith("data:image/svg+xml;base64,") for address in addresses)
        assert "<script" not in page
        assert "@import" not in page


def test_every_image_has_words_for_those_who_cannot_see_it(measurement):
    assert all(image.get("alt") for image in parsed(edge_report(measurement)).findall(".//img"))


def test_text_from_outside_is_escaped(measurement):
    hostile = '<script>alert("&")</script>'
    odd = replace(
        measurement,
        image=replace(measurement.image, path=hostile),
        checks=(Check("snr", 1.0, "<= 2", False, hostile),),
        options={hostile: hostile},
    )
    page = edge_report(odd, command=hostile)
    assert "<script" not in page
    assert words(page).count('alert("&")') >= 4


def test_a_report_without_gsd_and_checks_leaves_their_parts_out(vague_measurement):
    page = edge_report(vague_measurement)
    text = words(page)
    assert "c/m" not in text
    assert "Source of the limit" not in text
    assert "undefined" in text
    assert "acutance edge" not in text


def test_the_comparison_tells_all_failed_checks_and_how_all_were_measured(compared):
    text = words(comparison_report(compared))
    message = "The bright plateau is 2.0 px wide, at least 3 px are needed: use a wider region."
    for one in compared:
        assert f"{one.method} plateau_px {message}" in text
    assert "methods spline, sdsu-2005, iso12233" in text
    assert "--method spline --compare sdsu-2005,iso12233" in text


def test_the_comparison_shows_only_options_that_all_share(compared):
    first, second = compared[:2]
    other = replace(second, options={**second.options, "robust": True})
    text = words(comparison_report([first, other]))
    assert "methods spline, sdsu-2005 rer_centre half limits.contrast_snr 50" in text


def test_the_comparison_shows_every_method_and_the_truth(compared, truth):
    text = words(comparison_report(compared, truth=truth))
    for one in compared:
        assert str(one.mtf_nyquist) in text
    assert "truth spline sdsu-2005 iso12233" in text


def test_the_target_report_shows_means_edges_and_rejections(target):
    text = words(target_report(target, command="acutance edge scene.tif --all"))
    assert "Result across Weighted mean of 2 edges. MTF at Nyquist" in text
    assert "4 of 24 checks failed" in text
    assert "<aligned> with the grid" in text
    assert "acutance edge scene.tif --all" in text


def test_any_method_can_add_sections():
    section = Section(
        "Mirrors",
        paragraphs=("Twenty of them.",),
        headlines=(Headline("Width", "1.4", "px", ("± 0.1",)),),
        verdicts=(Verdict(True, "All is well."), Verdict(False, "Not all.")),
        tables=(Table(("a", "b"), (("1", "2"), ("3", "4"), ("5", "6")), "lr", 2, frozenset({1})),),
        links=(Link("more", "more.html"),),
        command="acutance points",
    )
    page = render_report("Points", "twenty", [section])
    assert len(parsed(page).findall(".//table")) == 2
    assert page.count('class="alert"') == 1
    assert page.count('class="verdict failed"') == 1
    assert "± 0.1" in words(page)
    assert 'href="more.html"' in page
