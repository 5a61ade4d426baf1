"""A filter on paper: figure, tables, page and text hold what it does and what it costs."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest

import acutance as ac
from acutance.report import (
    before_after_figure,
    niirs_text,
    proof_text,
    restoration_figure,
    restoration_page,
    restoration_tables,
    restoration_text,
)


@pytest.fixture(scope="module")
def sharpening():
    sensor = ac.Sensor([ac.optics.Gaussian(0.5), ac.optics.Detector()], gsd_m=0.7)
    return ac.design_restoration(sensor, snr=80, noise_gain=1.6, size=7)


@pytest.fixture(scope="module")
def large():
    """As large a kernel, and one that amplifies much."""
    sensor = ac.Sensor([ac.optics.Gaussian(0.62), ac.optics.Detector()])
    return ac.design_restoration(sensor, snr=200, noise_gain=2.6, size=21)


def test_the_text_has_both_sides_of_the_bargain(sharpening):
    text = restoration_text(sharpening)
    after = sharpening.after.across
    for words in (
        f"{after.mtf_nyquist.value:.4f}", f"{after.rer.value:.4f}", "noise gain 1.6 asked for",
        "1.600", "50", "GIQE 4", "Share of fine detail that is aliased",
    ):  # fmt: skip
        assert words in text


def test_the_noise_of_neighbours_correlates_by_the_direction_of_the_track():
    sensor = ac.Sensor([ac.optics.Gaussian(0.4, sigma_along_px=0.6), ac.optics.Detector()])
    document = ac.design_restoration(sensor, snr=80, noise_gain=1.5, size=7).to_dict()

    def listed(track):
        image = {**document["image"], "along_track": track}
        filter = ac.RestorationFilter.from_dict({**document, "image": image})
        rows = restoration_tables(filter)[1].rows
        return {row[0].split()[-1]: row[-1] for row in rows if row[0].startswith("Correlation")}

    upwards, sideways = listed("y"), listed("x")
    assert upwards["across"] != upwards["along"]
    assert sideways == {"across": upwards["along"], "along": upwards["across"]}


def test_a_change_without_a_deviation_has_the_sign_of_other_numbers(sharpening):
    """Of a described sensor: version 5 loses by the noise."""
    (line,) = re.findall(r"Change of NIIRS, GIQE 5.*", restoration_text(sharpening))
    assert sharpening.niirs_change[5].value < 0
    assert re.search(r" −0\.\d+$", line)


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(
    ("sources", "notes", "shown"),
    [
        (["scene"], ["l8.json: usable: noise: it varies"], ["Usable: noise: it varies."]),
        (
            ["a", "b"],
            ["a.json: usable: it varies", "b.json: doubtful: it is short", "no SNR is known"],
            ["Usable: a.json: it varies.", "b.json: doubtful: it is short.", "no SNR is known."],
        ),
        (["scene"], ["no SNR is known"], ["Usable: no SNR is known."]),
    ],
)
def test_a_note_repeats_neither_the_word_nor_the_only_name(sharpening, sources, notes, shown):
    """ "Usable: l8scan.json: usable: the noise varies" stood there."""
    document = {**sharpening.to_dict(), "notes": notes, "sources": sources, "verdict": "usable"}
    page = restoration_page(ac.RestorationFilter.from_dict(document))
    boxes = [
        re.sub("<[^>]*>", "", one)
        for one in re.findall(r'class="verdict[^>]*>(.*?)</div>', page, re.S)
    ]
    assert [one.strip() for one in boxes] == shown


def test_the_kernel_is_a_table_with_all_its_weights(sharpening):
    kernel = restoration_tables(sharpening)[-1]
    assert len(kernel.rows) == len(kernel.columns) - 1 == 7
    assert [row[0] for row in kernel.rows] == list(kernel.columns[1:])
    middle = float(kernel.rows[3][4].replace("−", "-"))
    assert middle == pytest.approx(1000 * sharpening.kernel[3, 3], abs=0.01)


def test_of_a_large_kernel_the_middle_is_shown(large):
    kernel = restoration_tables(large)[-1]
    assert len(kernel.rows) == len(kernel.columns) - 1 == 15
    assert float(kernel.rows[7][8]) == pytest.approx(1000 * large.kernel[10, 10], abs=0.01)
    assert "the middle 15 by 15 are shown" in kernel.notes[0]


def test_nothing_lies_over_curves_or_other_numbers(large):
    """The legend of the noise, and the weights in the drawing of the kernel."""
    figure = restoration_figure(large)
    figure.draw_without_rendering()
    (noise,) = [one for one in figure.axes if one.get_title(loc="left") == "Noise spectrum"]
    box = noise.get_legend().get_window_extent()
    for line in noise.get_lines():
        places = line.get_transform().transform(line.get_xydata())
        assert not box.count_contains(places)
    (kernel,) = [one for one in figure.axes if one.get_title(loc="left") == "The kernel"]
    boxes = [text.get_window_extent() for text in kernel.texts if text.get_text()]
    assert len(boxes) == 25
    for i, one in enumerate(boxes):
        assert not one.count_overlaps(boxes[:i])


@pytest.mark.usefixtures("undrawn")
def test_the_head_names_the_sources_and_numbers_without_deviations_have_none(sharpening, large):
    html = restoration_page(sharpening)
    head = html[: html.index("</header>")]
    assert "a described sensor" in head
    assert "± –" not in html
    overshoot = f"{100 * sharpening.after.overshoot.value:.1f}"
    assert f'<div class="value">{overshoot} <span class="unit">%' in html
    many = dict(large.document) | {"sources": [f"edge {i}" for i in range(9)]}
    html = restoration_page(ac.RestorationFilter.from_dict(many))
    assert "edge 3; and 5 more" in html[: html.index("</header>")]


def test_the_page_is_whole_and_holds_every_drawing(sharpening):
    html = restoration_page(sharpening, command="acutance restore design x.json")
    tree = ElementTree.fromstring(html.removeprefix("<!DOCTYPE html>"))
    text = " ".join("".join(tree.itertext()).split())
    assert len(list(tree.iter("img"))) == 6
    assert "acutance restore design x.json" in text
    assert "The kernel" in text
    assert not re.search(r'(src|href)="https?:', html)


def test_a_filter_without_an_snr_is_drawn_too():
    sensor = ac.Sensor([ac.optics.Gaussian(0.5), ac.optics.Detector()])
    filter = ac.design_restoration(sensor, noise_gain=1.5, size=5)
    assert "no SNR is known" in restoration_text(filter)
    axes = restoration_figure(filter).axes
    assert any(text.get_text() == "no SNR is known" for one in axes for text in one.texts)


def test_the_figure_marks_the_chosen_kernel(sharpening):
    figure = restoration_figure(sharpening)
    trade = next(axes for axes in figure.axes if axes.get_title(loc="left") == "The trade")
    chosen = [line.get_xydata()[0] for line in trade.lines if line.get_marker() == "o"]
    assert [place[0] for place in chosen] == pytest.approx([1.6, 1.6], rel=1e-6)
    assert chosen[0][1] == sharpening.after.across.mtf_nyquist.value


def test_before_and_after_have_the_same_greys():
    before = np.random.default_rng(1).normal(100, 10, (30, 40))
    figure = before_after_figure(before, 3 * before - 200, ("a", "b"))
    one, other = (axes.images[0].get_clim() for axes in figure.axes)
    assert one == other


def test_a_proof_and_a_number_in_words(sharpening):
    pixels, _ = ac.simulate.edge(
        ac.Sensor([ac.optics.Gaussian(0.5), ac.optics.Detector()]),
        shape=(70, 60), snr=200, rng=np.random.default_rng(1),
    )  # fmt: skip
    images = (ac.Image.from_array(one) for one in (pixels, ac.restore(pixels, sharpening)))
    proof = ac.verify_restoration(*images, sharpening, [(5, 5, 60, 50)])
    assert str(proof.edges[0].predicted) in proof_text(proof)
    told = niirs_text(ac.niirs(gsd_m=0.7, rer=0.4, snr=3))
    assert "low SNR" in told
    assert "NIIRS (GIQE 5)" in told


def test_a_number_below_0_has_the_minus_sign_of_all_reports():
    told = niirs_text(ac.niirs(gsd_m=70, rer=0.4, snr=30))
    assert "-" not in told
    assert told.count("−") == 3


def test_a_stated_gsd_is_told_beside_the_measured_one():
    pixels, _ = ac.simulate.edge(
        ac.Sensor([ac.optics.Gaussian(0.5), ac.optics.Detector()]), shape=(60, 60), snr=200,
        rng=np.random.default_rng(1),
    )  # fmt: skip
    edge = ac.measure_edge(pixels, gsd_m=1.0)
    assert "0.3 (stated; the document's own is 1 m)" in niirs_text(ac.niirs(edge, gsd_m=0.3))
    assert "stated;" not in niirs_text(ac.niirs(edge, gsd_m=1.0))


@pytest.mark.usefixtures("undrawn")
def test_a_kernel_that_blurs_is_told_in_text_and_page():
    sensor = ac.Sensor([ac.optics.Gaussian(0.5), ac.optics.Detector()])
    filter = ac.design_restoration(sensor, noise_gain=0.2, snr=80, size=7)
    for shown in (restoration_text(filter), restoration_page(filter)):
        assert "the kernel blurs edges, it does not sharpen" in shown


def test_version_5_names_no_input_that_it_does_not_have():
    stated = {"gsd_m": 0.7, "rer": 0.45, "snr": 80}
    plain, older = (niirs_text(ac.niirs(**stated, version=one)) for one in (5, 4))
    for words in ("overshoot H", "noise gain"):
        assert words not in plain
        assert words in older


def test_notes_on_a_niirs_are_no_rows_of_its_table():
    rows = niirs_text(ac.niirs(gsd_m=0.7, rer=0.45, snr=2)).splitlines()
    assert next(row for row in rows if "low SNR" in row).startswith("note: low SNR: ")


def test_a_proof_has_what_the_filter_was_designed_for():
    sensor = ac.Sensor([ac.optics.Gaussian(0.5), ac.optics.Detector()])
    filter = ac.design_restoration(sensor, snr=100, noise_gain=1.6)
    pixels, _ = ac.simulate.edge(
        sensor, shape=(100, 100), angle_deg=7, snr=100, rng=np.random.default_rng(1)
    )
    before, after = map(ac.Image.from_array, (pixels, ac.restore(pixels, filter)))
    shown = proof_text(ac.verify_restoration(before, after, filter, [(10, 10, 80, 80)]))
    assert "designed for" in shown.splitlines()[1]
    assert f"{np.exp(-2 * (np.pi * 0.5 * 0.5) ** 2) * np.sinc(0.5):.3f}" in shown


@pytest.mark.usefixtures("undrawn")
def test_what_is_called_an_overshoot_is_one(sharpening):
    """The largest of both may be an undershoot, of which the table has another number."""
    page = restoration_page(sharpening)
    worst = f"{100 * sharpening.after.overshoot.value:.1f}"
    label = '<div class="label">Largest over- or undershoot</div>'
    assert f'{label}<div class="value">{worst} ' in page
    (trade,) = (one for one in restoration_tables(sharpening) if one.title == "The trade")
    assert trade.columns[3] == "Over- or undershoot [%]"
