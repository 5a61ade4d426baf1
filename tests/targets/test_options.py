"""Options that are not of the kind their classes declare are refused where they are made."""

import math
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

import acutance as ac
from acutance.geometry.bar_group import Bars
from acutance.scan import ScanOptions
from acutance.scan.checks import SCENE_CHECKS
from acutance.targets.check_table import QUESTIONS
from acutance.targets.combine import CombineOptions
from acutance.targets.combine.checks import COMBINE_CHECKS
from acutance.targets.pair import BiresolutionOptions
from acutance.targets.pair.checks import PAIR_CHECKS
from acutance.targets.periodic import BarsOptions, StarOptions
from acutance.targets.periodic.bars_checks import BARS_CHECKS
from acutance.targets.periodic.star_checks import STAR_CHECKS
from acutance.targets.points import PointsOptions
from acutance.targets.points.checks import POINTS_CHECKS
from acutance.targets.points.published import SdsuMirrorsOptions
from acutance.targets.question import limit_range
from acutance.targets.straight import EdgeOptions, PulseOptions
from acutance.targets.straight.edge_checks import EDGE_CHECKS
from acutance.targets.straight.published import (
    FermiOptions,
    Iso12233Options,
    KompsatOptions,
    SdsuOptions,
    SdsuPulseOptions,
)
from acutance.targets.straight.pulse_checks import PULSE_CHECKS

CHECKS = {
    BarsOptions: BARS_CHECKS,
    BiresolutionOptions: PAIR_CHECKS,
    CombineOptions: COMBINE_CHECKS,
    EdgeOptions: EDGE_CHECKS,
    PointsOptions: POINTS_CHECKS,
    PulseOptions: PULSE_CHECKS,
    ScanOptions: SCENE_CHECKS,
    StarOptions: STAR_CHECKS,
}
METHOD_OPTIONS = (
    FermiOptions,
    Iso12233Options,
    KompsatOptions,
    SdsuMirrorsOptions,
    SdsuOptions,
    SdsuPulseOptions,
)


@pytest.mark.parametrize("of", [*CHECKS, *METHOD_OPTIONS])
def test_every_option_refuses_what_no_option_can_be(of):
    for field in fields(of):
        if field.name != "limits":
            wanted = f"{of.__name__}: {field.name} has to be .* found"
            with pytest.raises(ac.OptionError, match=wanted):
                of(**{field.name: {"rows": 3}})


@pytest.mark.parametrize("of", CHECKS)
@pytest.mark.parametrize("wrong", ["a", math.nan, True, None, (3.0,)])
def test_limits_are_numbers(of, wrong):
    name = CHECKS[of][0]
    with pytest.raises(ac.OptionError, match=f"the limit of {name} has to be a number, found"):
        of(limits={name: wrong})
    assert of(limits={name: 1}).limits[name] == 1
    assert of(limits={name: np.float32(1)}).to_dict()["limits"] == {name: 1}


@pytest.mark.parametrize("of", CHECKS)
def test_limits_are_those_of_the_same_target(of):
    with pytest.raises(ac.OptionError, match=rf"{of.__name__}: there is no check 'sharpness'"):
        of(limits={"sharpness": 3.0})
    with pytest.raises(ac.OptionError, match="limits has to be a dict"):
        of(limits=[3.0])


def test_the_readme_counts_the_questions_of_an_edge():
    readme = Path(__file__).parents[2] / "README.md"
    assert f"(of an edge {len(EDGE_CHECKS)}:" in readme.read_text(encoding="utf-8")


def test_every_question_is_asked_of_some_target():
    asked = {name for names in CHECKS.values() for name in names}
    assert asked == set(QUESTIONS)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: EdgeOptions(robust="no"), "robust has to be True or False, found 'no'"),
        (lambda: EdgeOptions(rer_centre="top"), "rer_centre has to be 'half' or 'peak' or None"),
        (lambda: PulseOptions(rer_centre="top"), "rer_centre has to be 'half' or 'peak' or None"),
        (lambda: EdgeOptions(method_options=SdsuPulseOptions()), "has to be SdsuOptions"),
        (lambda: PointsOptions(max_sources=2.5), "max_sources has to be a whole number"),
        (lambda: StarOptions(centre=5), r"centre has to be \(a number, a number\) or None"),
        (lambda: StarOptions(centre=(1.0, 2.0, 3.0)), "centre has to be"),
        (lambda: BarsOptions(groups="ab"), r"groups has to be several times Bars\(\.\.\.\)"),
        (lambda: SdsuOptions(order=3), "order has to be 2 or 4, found 3"),
    ],
)
def test_the_message_says_what_is_wanted(make, message):
    with pytest.raises(ac.OptionError, match=message):
        make()


@pytest.fixture(scope="module")
def sensor():
    return ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])


@pytest.mark.parametrize("name", ["sdsu-2005", "kompsat-2014", "iso12233", "fermi"])
def test_published_methods_refuse_what_only_the_reference_has(sensor, name):
    image, _ = ac.simulate.edge(sensor, snr=100, rng=np.random.default_rng(1))
    refusal = rf"robust=False \(--no-robust\) .*: {name} bounds no weights"
    for measure in (ac.measure_edge, ac.measure_edges):
        with pytest.raises(ac.OptionError, match=refusal):
            measure(image, method=name, options=EdgeOptions(robust=False))


def test_published_pulse_and_points_refuse_it_too(sensor):
    rng = np.random.default_rng(1)
    stripe, _ = ac.simulate.pulse(sensor, width_px=4.0, snr=100, rng=rng)
    with pytest.raises(ac.OptionError, match="sdsu-2005 bounds no weights"):
        ac.measure_pulse(
            stripe, width_px=4.0, method="sdsu-2005", options=PulseOptions(robust=False)
        )
    mirrors, _ = ac.simulate.points(sensor, snr=100, rng=rng)
    with pytest.raises(ac.OptionError, match="gaussian-2003 bounds no weights"):
        ac.measure_points(mirrors, method="gaussian-2003", options=PointsOptions(robust=False))


def test_what_means_the_same_is_taken():
    assert EdgeOptions(limits={"angle_deg": 20, "rows": math.inf}).limits["angle_deg"] == 20
    assert EdgeOptions(robust=np.bool_(False)).robust == False  # noqa: E712
    assert tuple(StarOptions(centre=np.array([3.0, 4.0])).centre) == (3.0, 4.0)
    assert BarsOptions(groups=[Bars(20.0, 20.0, 0.0, 8.0, 5, 40.0)]).groups


@pytest.mark.parametrize("name", sorted(QUESTIONS))
def test_the_limit_of_the_table_is_one_that_may_be_given(name):
    low, high = limit_range(name)
    assert low <= QUESTIONS[name].limit <= high


@pytest.mark.parametrize(
    ("name", "limit"),
    [
        ("rows", -5),
        ("saturation", 1.5),
        ("repeated_pixels", 2),
        ("blur_uniformity", 5),
        ("double_edge", 15),
        ("correlated_noise", -2),
        ("angle_deg", 720),
    ],
)
def test_limits_that_mean_nothing_are_refused(name, limit):
    with pytest.raises(ac.OptionError, match=rf"limit of {name} is {limit:g}, and what"):
        EdgeOptions(limits={name: limit})
    assert EdgeOptions(limits={name: -math.inf}).limits[name] == -math.inf


@pytest.mark.parametrize(
    ("options", "name"),
    [
        (PointsOptions, "positions"),
        (PointsOptions, "phase_gap_px"),
        (ac.ScanOptions, "halo_share"),
        (ac.ScanOptions, "scene_settled"),
    ],
)
def test_per_cent_are_no_shares(options, name):
    with pytest.raises(ac.OptionError, match=rf"limit of {name} is 50, and .* from 0 to 1 "):
        options(limits={name: 50})
