"""Options that are not of the kind their classes declare are refused where they are made."""

import math
from dataclasses import fields

import numpy as np
import pytest

import acutance as ac
from acutance.geometry.bar_group import Bars
from acutance.targets.combine import CombineLimits, CombineOptions
from acutance.targets.pair import BiresolutionLimits, BiresolutionOptions
from acutance.targets.periodic import BarsLimits, BarsOptions, StarLimits, StarOptions
from acutance.targets.points import PointsLimits, PointsOptions
from acutance.targets.points.published import SdsuMirrorsOptions
from acutance.targets.straight import EdgeLimits, EdgeOptions, PulseLimits, PulseOptions
from acutance.targets.straight.published import (
    FermiOptions,
    Iso12233Options,
    KompsatOptions,
    SdsuOptions,
    SdsuPulseOptions,
)

LIMITS = {
    BarsOptions: BarsLimits,
    BiresolutionOptions: BiresolutionLimits,
    CombineOptions: CombineLimits,
    EdgeOptions: EdgeLimits,
    PointsOptions: PointsLimits,
    PulseOptions: PulseLimits,
    StarOptions: StarLimits,
}
METHOD_OPTIONS = (
    FermiOptions,
    Iso12233Options,
    KompsatOptions,
    SdsuMirrorsOptions,
    SdsuOptions,
    SdsuPulseOptions,
)


@pytest.mark.parametrize("of", [*LIMITS, *LIMITS.values(), *METHOD_OPTIONS])
def test_every_option_refuses_what_no_option_can_be(of):
    for field in fields(of):
        with pytest.raises(ac.OptionError, match=f"{of.__name__}: {field.name} has to be .* found"):
            of(**{field.name: {"rows": 3}})


@pytest.mark.parametrize("of", LIMITS.values())
@pytest.mark.parametrize("wrong", ["a", math.nan, True, None, (3.0,)])
def test_limits_are_numbers(of, wrong):
    name = fields(of)[0].name
    with pytest.raises(ac.OptionError, match=f"{name} has to be a number, found"):
        of(**{name: wrong})
    assert getattr(of(**{name: 3}), name) == 3
    assert getattr(of(**{name: np.float32(3)}), name) == 3


@pytest.mark.parametrize("of", LIMITS)
def test_limits_are_those_of_the_same_target(of):
    other = StarLimits() if of is not StarOptions else EdgeLimits()
    with pytest.raises(ac.OptionError, match=rf"limits has to be {LIMITS[of].__name__}\(\.\.\.\)"):
        of(limits=other)


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
    assert EdgeLimits(angle_deg=20, rows=math.inf).angle_deg == 20
    assert EdgeOptions(robust=np.bool_(False)).robust == False  # noqa: E712
    assert tuple(StarOptions(centre=np.array([3.0, 4.0])).centre) == (3.0, 4.0)
    assert BarsOptions(groups=[Bars(20.0, 20.0, 0.0, 8.0, 5, 40.0)]).groups
