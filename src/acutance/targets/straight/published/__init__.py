"""Published edge and pulse methods, faithful to their papers, biases included.

Every method takes an `EdgePixels` (a `PulsePixels`) and a frozen dataclass of options and gives an
`EdgeFit`, like the reference method, so that they can be compared curve by curve.
"""

from __future__ import annotations

from collections.abc import Callable

from acutance.targets.straight.pixels import EdgeFit
from acutance.targets.straight.published.fermi import FermiOptions, fermi
from acutance.targets.straight.published.iso12233 import Iso12233Options, iso12233
from acutance.targets.straight.published.kompsat import KompsatOptions, kompsat_2014
from acutance.targets.straight.published.sdsu import SdsuOptions, sdsu_2005
from acutance.targets.straight.published.sdsu_pulse import (
    PublishedPulse,
    SdsuPulseOptions,
    sdsu_2005_pulse,
)

__all__ = [
    "BY_ROWS",
    "PUBLISHED",
    "PUBLISHED_OPTIONS",
    "PUBLISHED_PULSE",
    "PUBLISHED_PULSE_OPTIONS",
    "FermiOptions",
    "Iso12233Options",
    "KompsatOptions",
    "PublishedPulse",
    "SdsuOptions",
    "SdsuPulseOptions",
    "fermi",
    "iso12233",
    "kompsat_2014",
    "sdsu_2005",
    "sdsu_2005_pulse",
]

PUBLISHED: dict[str, Callable[..., EdgeFit]] = {
    "sdsu-2005": sdsu_2005,
    "kompsat-2014": kompsat_2014,
    "iso12233": iso12233,
    "fermi": fermi,
}

BY_ROWS = frozenset(PUBLISHED) - {"fermi"}
"""Methods that find the edge in every row (or column) by itself: they need it nearly upright."""

PUBLISHED_OPTIONS: dict[str, type] = {
    "sdsu-2005": SdsuOptions,
    "kompsat-2014": KompsatOptions,
    "iso12233": Iso12233Options,
    "fermi": FermiOptions,
}

PUBLISHED_PULSE: dict[str, Callable[..., PublishedPulse]] = {"sdsu-2005": sdsu_2005_pulse}

PUBLISHED_PULSE_OPTIONS: dict[str, type] = {"sdsu-2005": SdsuPulseOptions}
