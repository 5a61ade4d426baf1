"""What is no result is drawn, written and tabulated by no report, and said so in words."""

import numpy as np
import pytest

import acutance as ac
from acutance import report

SENSOR = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
WRONG = ["x", None, 3, [], {"a": 1}, list, object(), np.zeros((3, 3))]


@pytest.fixture(scope="module")
def edge():
    pixels, _ = ac.simulate.edge(SENSOR, snr=100, rng=np.random.default_rng(1))
    return ac.measure_edge(pixels)


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize(
    "write",
    [
        report.bands_document,
        report.bands_page,
        report.bands_tables,
        report.bands_text,
        report.budget_document,
        report.budget_figure,
        report.budget_text,
        report.compare,
        report.csv,
        report.document,
        report.draw,
        report.landscape_document,
        report.mirror_plan_figure,
        report.mirror_plan_text,
        report.niirs_text,
        report.notebook_html,
        report.page,
        report.panel_figure,
        report.panels,
        report.plan_text,
        report.proof_text,
        report.restoration_figure,
        report.restoration_page,
        report.restoration_tables,
        report.restoration_text,
        report.scene_document,
        report.sensor_document,
        report.sources_csv,
        report.study_figure,
        report.study_text,
        report.tables,
        report.text,
    ],
)
def test_what_is_no_result_is_refused(write, wrong):
    with pytest.raises(ac.OptionError, match=r"give|there is no|no measurement|nothing"):
        write(wrong)


@pytest.mark.parametrize("wrong", [None, 3, object(), True])
def test_what_belongs_to_a_result_is_refused(edge, wrong):
    for call in (
        lambda: report.compare([edge], truth=wrong if wrong is not None else 3),
        lambda: report.text(edge, required=wrong),
        lambda: report.document(edge, covariance=wrong if wrong is not True else 1),
        lambda: report.save_figure(report.budget_figure(ac.optics.budget(SENSOR)), wrong),
        lambda: report.figure_bytes(wrong, ".png"),
        lambda: report.figure_bytes(report.budget_figure(ac.optics.budget(SENSOR)), wrong),
    ):
        with pytest.raises(ac.OptionError, match=r"give|has to be|choose"):
            call()
