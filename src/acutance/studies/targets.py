"""One image by the published estimator and by ours."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.studies.trials import Record
from acutance.targets.straight import EdgeOptions, measure_edge, measure_pulse
from acutance.targets.straight.find_pulse import find_pulse
from acutance.targets.straight.published import (
    PublishedPulse,
    SdsuOptions,
    SdsuPulseOptions,
    sdsu_2005_pulse,
)

__all__ = [
    "ESTIMATORS",
    "ESTIMATOR_WORDS",
    "Estimator",
    "measure_both_edges",
    "measure_both_pulses",
    "measure_published_pulse",
]

Estimator = Literal["published", "ours"]
ESTIMATORS: tuple[Estimator, ...] = ("published", "ours")
ESTIMATOR_WORDS: dict[Estimator, str] = {
    "published": "the published estimator",
    "ours": "our estimator",
}

_SDSU = EdgeOptions(method_options=SdsuOptions(replicates=0))


def measure_both_edges(image: Floats) -> Record:
    """MTF at Nyquist of an edge by both estimators, with its standard deviation.

    ``nan`` where an estimator refuses the image; the refusal is in words then, otherwise empty.
    """
    found: Record = {}
    try:
        published = measure_edge(image, method="sdsu-2005", options=_SDSU)
        found |= _numbers("published", published.mtf_nyquist)
    except TargetError as error:
        found |= _refused("published", error)
    try:
        found |= _numbers("ours", measure_edge(image).mtf_nyquist)
    except TargetError as error:
        found |= _refused("ours", error)
    return found


def measure_both_pulses(image: Floats, *, width_px: float) -> Record:
    """MTF at Nyquist of a pulse by both estimators, with its standard deviation.

    Parameters
    ----------
    image : (rows, cols) array
    width_px : float
        As stated: the published estimator uses it as it is, ours as a first guess.

    Returns
    -------
    dict
        ``nan`` where an estimator refuses the image; the refusal is in words then, otherwise
        empty.
    """
    found: Record = {}
    try:
        published = measure_published_pulse(image, width_px=width_px)
        found |= _numbers("published", published.response.mtf_nyquist)
    except TargetError as error:
        found |= _refused("published", error)
    try:
        found |= _numbers("ours", measure_pulse(image, width_px=width_px).mtf_nyquist)
    except TargetError as error:
        found |= _refused("ours", error)
    return found


def measure_published_pulse(
    image: Floats,
    *,
    width_px: float,
    order: Literal[2, 4] = 2,
    distance: Literal["row", "normal"] = "row",
    width: Literal["stated", "axis"] = "stated",
) -> PublishedPulse:
    """A pulse by the published pipeline, without its standard deviations.

    Parameters
    ----------
    image : (rows, cols) array
    width_px : float
    order : {2, 4}, optional
    distance : {"row", "normal"}, optional
    width : {"stated", "axis"}, optional
        As in `acutance.targets.straight.published.SdsuPulseOptions`.
    """
    trimmed, _ = find_pulse(image, width_px)
    options = SdsuPulseOptions(order=order, distance=distance, width=width, replicates=0)
    return sdsu_2005_pulse(replace(trimmed, pulse_width_px=width_px), options)


def _refused(name: str, error: TargetError) -> Record:
    return {**_numbers(name, Estimate(math.nan, math.nan)), f"{name}_refusal": str(error)}


def _numbers(name: str, nyquist: Estimate) -> Record:
    return {
        f"{name}_mtf_nyquist": nyquist.value,
        f"{name}_mtf_nyquist_std": nyquist.std,
        f"{name}_refusal": "",
    }
