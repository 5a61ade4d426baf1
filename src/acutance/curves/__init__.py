"""Curves and their metrics: the lowest layer, which imports numpy only."""

from acutance.curves.estimate import Estimate
from acutance.curves.estimates import Estimates
from acutance.curves.otf2d import Otf2d, OtfModel
from acutance.curves.response import MAIN_NUMBERS, METRICS, HasResponse, Response
from acutance.curves.spread import Esf, Lsf
from acutance.curves.transfer import Mtf

__all__ = [
    "MAIN_NUMBERS",
    "METRICS",
    "Esf",
    "Estimate",
    "Estimates",
    "HasResponse",
    "Lsf",
    "Mtf",
    "Otf2d",
    "OtfModel",
    "Response",
]
