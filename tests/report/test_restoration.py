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


def test_the_text_has_both_sides_of_the_bargain(sharpening):
    text = restoration_text(sharpening)
    after = sharpening.after.across
    for words in (
        f"{after.mtf_nyquist.value:.4f}", f"{after.rer.value:.4f}", "noise gain 1.6 asked for",
        "1.600", "50", "GIQE 4", "Share of fine detail that is aliased",
    ):  # fmt: skip
        assert words in text


def test_the_kernel_is_a_table_with_all_its_weights(sharpening):
    kernel = restoration_tables(sharpening)[-1]
    assert len(kernel.rows) == len(kernel.columns) == 7
    middle = float(kernel.rows[3][3].replace("−", "-"))
    assert middle == pytest.approx(sharpening.kernel[3, 3], abs=1e-5)


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
    assert f"{proof.edges[0].predicted.value:.3f}" in proof_text(proof)
    told = niirs_text(ac.niirs(gsd_m=0.7, rer=0.4, snr=3))
    assert "low SNR" in told
    assert "NIIRS (GIQE 5)" in told
