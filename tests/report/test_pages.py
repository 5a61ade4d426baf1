"""HTML pages: whole, safe, and holding what is asked of them."""

import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

import acutance
from acutance import optics, simulate
from acutance.report import compare, notebook_html, page
from acutance.report.html import Headline, Link, Section, Table, Verdict, render_page
from acutance.targets import Check, TargetResult
from acutance.targets.straight.many_edges import combine_edges

BLUR = "from part to part the blur changes by 8 %: another edge crosses it"


def parsed(html):
    """The page as a tree; it is written so that an XML parser can read it too."""
    return ElementTree.fromstring(html.removeprefix("<!DOCTYPE html>"))


def words(html):
    tree = parsed(html)
    body = tree.find("body") if tree.tag == "html" else tree
    return " ".join(" ".join(body.itertext()).split())


def titles(html):
    return [heading.text for heading in parsed(html).iter("h2")]


@pytest.fixture(scope="module")
def edge_page(measurement):
    """The page of an edge, once: drawing takes longer than all questions about it."""
    return page(measurement)


def test_a_page_begins_with_the_verdict_and_the_main_numbers(measurement, edge_page):
    html = edge_page
    text = words(html)
    assert titles(html)[:2] == ["Result", "Curves and pixels"]
    verdict, numbers = (
        text.index(f"Doubtful: {BLUR}"),
        text.index(f"{measurement.rer.value:.4f}"),
    )
    assert text.index("Result") < verdict < numbers < text.index("Curves and pixels")
    first = parsed(html).find(".//div[@class='side']")
    assert len(first.findall(".//table")) == 1
    assert len(first.findall(".//img")) == 2


@pytest.mark.usefixtures("undrawn")
def test_a_page_says_where_the_pixels_come_from_and_when_they_were_measured(measurement, edge_page):
    text = words(edge_page)
    facts = text[: text.index("Result")]
    for fact in ("image scene.tif", "band 1", "rows 100–139, columns 260–295", "GSD 0.7 m"):
        assert fact in facts
    assert "measured 2026-01-02 03:04 UTC" in facts
    assert "satellite" not in facts
    described = replace(measurement, options={"sensor": "QB02", "acquired": "2003-04-05"})
    assert "satellite QB02 acquired 2003-04-05 measured" in words(page(described))
    assert "from 203 to 1208 DN" in facts


def test_the_page_of_an_edge_holds_numbers_checks_and_how_to_repeat_it(measurement, edge_page):
    html = edge_page
    text = words(html)
    for number in measurement.metrics().values():
        assert str(number).split(" ± ")[0] in text
    for check in measurement.checks:
        assert check.name in text
        assert check.question in text
    assert "KOMPSAT-3 draft 3c" in text
    assert "acutance edge scene.tif --roi 100,260,40,36 --gsd 0.7 --method spline" in text
    assert "limits.contrast_snr" in text
    assert len(parsed(html).findall(".//img")) == 4
    assert len(re.findall(r"<tr><td class=\"r\">\d\.\d\d</td>", html)) == 51


@pytest.mark.usefixtures("undrawn")
def test_the_page_of_a_pulse_speaks_of_a_pulse(pulse, make_pulse):
    text = words(page(pulse))
    assert "Pulse, method spline" in text
    assert "1208 DN on a background of 203 DN" in text
    assert "Width on the ground" in text
    # Nothing was stated: the command that repeats it states nothing.
    assert "acutance pulse scene.tif --roi 100,260,40,36 --gsd 0.7 --method" in text
    stated = replace(pulse, stated_width_px=3.1500000)
    assert "--gsd 0.7 --width-px 3.15 --method" in words(page(stated))
    held = replace(make_pulse(width_std=0.0), stated_width_px=3.153)
    assert "--width-px 3.153 --hold-width --method" in words(page(held))


@pytest.mark.usefixtures("undrawn")
def test_the_command_says_which_axis_is_along_track(measurement):
    turned = replace(measurement, image=replace(measurement.image, along_track="x"))
    text = words(page(turned))
    assert "along track, 6.02" in text
    assert "--along-track x --method" in text


def test_nothing_is_loaded_from_elsewhere(edge_page, compared, truth, target, both):
    others = (compare(compared, truth=truth), target, both)
    for html in (edge_page, *map(page, others)):
        addresses = re.findall(r"(?:src|href)=\"([^\"]{1,40})", html)
        assert addresses
        assert all(address.startswith("data:image/svg+xml;base64,") for address in addresses)
        assert "<script" not in html
        assert "@import" not in html


def test_every_image_has_words_for_those_who_cannot_see_it(edge_page):
    assert all(image.get("alt") for image in parsed(edge_page).findall(".//img"))


@pytest.mark.usefixtures("undrawn")
def test_text_from_outside_is_escaped(measurement):
    hostile = '<script>alert("&")</script>'
    odd = replace(
        measurement,
        image=replace(measurement.image, path=hostile),
        checks=(Check("snr", 1.0, "<=", 2.0, False, hostile),),
        options={hostile: hostile},
    )
    for html in (page(odd, command=hostile), notebook_html(odd)):
        assert "<script" not in html
        assert words(html).count('alert("&")') >= 2


@pytest.mark.usefixtures("undrawn")
def test_a_page_without_gsd_and_checks_leaves_their_parts_out(vague_measurement):
    text = words(page(vague_measurement))
    assert "c/m" not in text
    assert "Source of the limit" not in text
    assert "No checks were made." in text
    assert "undefined" in text
    assert "acutance edge" not in text


def test_without_details_a_page_has_its_curves_alone(measurement):
    html = page(measurement.without_details())
    assert len(parsed(html).findall(".//img")) == 2
    assert "Edge spread function" not in words(html)


@pytest.mark.usefixtures("undrawn")
def test_a_comparison_shows_verdicts_the_target_and_one_table(compared, truth):
    html = page(compare(compared, truth=truth))
    text = words(html)
    assert titles(html) == ["Verdict", "Target and curves", "Numbers", "How it was measured"]
    for one in compared:
        assert f"{one.method} – Doubtful: {BLUR}" in text
        assert text.count(str(one.mtf_nyquist)) == 1
    assert "truth spline sdsu-2005 iso12233" in text
    assert "methods spline, sdsu-2005, iso12233" in text
    assert "--method spline --compare sdsu-2005,iso12233" in text


@pytest.mark.usefixtures("undrawn")
def test_the_comparison_shows_only_options_that_all_share(compared):
    first, second = compared[:2]
    other = replace(second, options={**second.options, "robust": True})
    text = words(page([first, other]))
    assert "methods spline, sdsu-2005 rer_centre half limits.contrast_snr 50" in text


def test_the_page_of_all_edges_begins_with_their_picture(target):
    html = page(target, command="acutance edge scene.tif --all")
    text = words(html)
    first = next(parsed(html).iter("section"))
    assert first.find("h2").text == "The target"
    assert len(first.findall(".//img")) == 1
    assert first.find(".//table") is None
    assert "Doubtful: 4 of 24 checks failed." in text
    assert text.index("Failed checks") > text.index("The target")
    assert "blur_uniformity 1 (0.08), 2 (0.08), 3 (0.08), 4 (0.08); asked <= 0.05" in text
    mean = str(target.groups["along"].metrics["mtf_nyquist"])
    assert f"along mean of 2 edges {mean}" in text
    assert "<aligned> with the grid" in text
    assert "acutance edge scene.tif --all" in text


@pytest.mark.usefixtures("undrawn")
def test_all_edges_without_a_failed_check_are_good(target):
    edges = tuple(replace(one, checks=one.checks[:3]) for one in target.measurements)
    html = page(TargetResult(edges, (), combine_edges(edges)))
    assert 'class="verdict good"' in html
    assert "Good: All 12 checks passed." in words(html)


def test_a_section_holds_whatever_it_is_given():
    section = Section(
        "Mirrors",
        paragraphs=("Twenty of them.",),
        headlines=(Headline("Width", "1.4", "px", ("± 0.1",)),),
        verdicts=(Verdict("good", "All."), Verdict("invalid", "Not all.", (("snr", "low"),))),
        tables=(Table(("a", "b"), (("1\nmore", "2"), ("3", "4"), ("5", "6")), "lr", 2,
                      frozenset({1})),),
        links=(Link("more", "more.html"),),
        command="acutance points",
    )  # fmt: skip
    html = render_page("Points", "twenty", [section], {"image": "a.tif"})
    assert len(parsed(html).findall(".//table")) == 2
    assert html.count('class="alert"') == 1
    assert html.count('class="verdict invalid"') == 1
    for part in ("± 0.1", "snr : low", "image a.tif", "1 more 2"):
        assert part in words(html)
    assert 'href="more.html"' in html


@pytest.mark.parametrize("details", [True, False])
def test_a_notebook_shows_numbers_checks_and_a_figure(measurement, both, details):
    for result in (measurement, both):
        shown = result if details else result.without_details()
        html = notebook_html(shown)
        text = words(html)
        assert "Doubtful: " in text
        for number in shown.directions[shown.measured_directions[0]].metrics().values():
            if number.std > 0:
                assert f"± {str(number).split(' ± ')[1]}" in text
                break
        assert len(parsed(html).findall(".//img")) == 1


@pytest.mark.usefixtures("undrawn")
def test_a_record_shows_the_numbers_of_its_measurement(measurement, pulse, both):
    for result in (measurement, pulse, both):
        full, light = notebook_html(result), notebook_html(result.record)
        assert words(full) == words(light)
        assert len(parsed(light).findall(".//img")) == 1


@pytest.mark.usefixtures("undrawn")
def test_measurements_and_records_show_themselves_in_notebooks(measurement):
    for one in (measurement, measurement.record):
        assert words(one._repr_html_()) == words(notebook_html(one))


def test_several_measurements_show_their_tables_in_notebooks(few_forms):
    """All edges of a target, and the bands of a scene."""
    sensor = optics.Sensor([optics.Gaussian(0.4), optics.Detector()])
    site = simulate.site(sensor, np.random.default_rng(3))
    every = acutance.measure_edges(site.image)
    shown = words(every._repr_html_())
    assert "measured 4" in shown
    assert all(f"{one.mtf_nyquist}" in shown for one in every.measurements)
    image, _ = simulate.landscape(sensor, shape=(400, 400), snr=100, rng=np.random.default_rng(1))
    images = [acutance.Image.from_array(image), acutance.Image.from_array(image + 1)]
    with few_forms():
        bands = acutance.scan_bands(images)
    shown = words(bands._repr_html_())
    assert all(f"{scene.along.rer}" in shown for scene in bands.measurements)


def test_on_paper_the_result_begins_on_the_first_sheet(edge_page):
    """As one block that keeps together, numbers and drawings left the first sheet empty."""
    (printed,) = re.findall(r"@media print \{(.+?)\n\}", edge_page, re.DOTALL)
    (kept,) = re.findall(r"([^{}\n]+) \{ break-inside: avoid; \}", printed)
    assert ".side" not in kept
    assert "figure" in kept
    assert ".side > div:not(.plates) { display: contents; }" in printed
