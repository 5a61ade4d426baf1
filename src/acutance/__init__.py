"""acutance: how sharp an Earth-observation satellite really sees.

Measures MTF, RER and FWHM of an imaging sensor from the images it took in orbit, each with a
standard deviation that is true, and simulates sensor and target to prove it.

>>> import acutance as ac
>>> m = ac.measure_edge(ac.open_image("scene.tif"), (120, 340, 40, 40))  # doctest: +SKIP
>>> print(m.mtf_nyquist, m.rer, m.fwhm_px)  # doctest: +SKIP
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from acutance.errors import (
    AcutanceError,
    ImageError,
    ModelError,
    NoBarsError,
    NoEdgeError,
    NoStarError,
    OptionError,
    PhaseError,
    RegionError,
    SupportError,
    TargetError,
)

if TYPE_CHECKING:
    from acutance import optics, report, simulate
    from acutance.curves import Esf, Estimate, Lsf, Mtf, Response
    from acutance.measure import (
        BarsLimits,
        BarsMeasurement,
        BarsOptions,
        BiresolutionLimits,
        BiresolutionMeasurement,
        BiresolutionOptions,
        CombinedMeasurement,
        CombineLimits,
        CombineOptions,
        EdgeLimits,
        EdgeOptions,
        Measurement,
        PointsLimits,
        PointsMeasurement,
        PointsOptions,
        PulseLimits,
        PulseOptions,
        StarLimits,
        StarMeasurement,
        StarOptions,
        TargetResult,
        combine,
        measure_bars,
        measure_biresolution,
        measure_edge,
        measure_edges,
        measure_points,
        measure_pulse,
        measure_star,
    )
    from acutance.optics import Sensor
    from acutance.raster import Box, Gsd, Image, Region, open_image, sites

__version__ = "0.1.0"

# Where a public name lives. Modules are loaded when a name is first used, so that
# `import acutance` stays quick.
_HOMES = {
    "BarsLimits": "acutance.measure",
    "BarsMeasurement": "acutance.measure",
    "BarsOptions": "acutance.measure",
    "BiresolutionLimits": "acutance.measure",
    "BiresolutionMeasurement": "acutance.measure",
    "BiresolutionOptions": "acutance.measure",
    "Box": "acutance.raster",
    "CombineLimits": "acutance.measure",
    "CombineOptions": "acutance.measure",
    "CombinedMeasurement": "acutance.measure",
    "EdgeLimits": "acutance.measure",
    "EdgeOptions": "acutance.measure",
    "Esf": "acutance.curves",
    "Estimate": "acutance.curves",
    "Gsd": "acutance.raster",
    "Image": "acutance.raster",
    "Lsf": "acutance.curves",
    "Measurement": "acutance.measure",
    "Mtf": "acutance.curves",
    "PointsLimits": "acutance.measure",
    "PointsMeasurement": "acutance.measure",
    "PointsOptions": "acutance.measure",
    "PulseLimits": "acutance.measure",
    "PulseOptions": "acutance.measure",
    "Region": "acutance.raster",
    "Response": "acutance.curves",
    "Sensor": "acutance.optics",
    "StarLimits": "acutance.measure",
    "StarMeasurement": "acutance.measure",
    "StarOptions": "acutance.measure",
    "TargetResult": "acutance.measure",
    "combine": "acutance.measure",
    "measure_bars": "acutance.measure",
    "measure_biresolution": "acutance.measure",
    "measure_edge": "acutance.measure",
    "measure_edges": "acutance.measure",
    "measure_points": "acutance.measure",
    "measure_pulse": "acutance.measure",
    "measure_star": "acutance.measure",
    "open_image": "acutance.raster",
    "sites": "acutance.raster",
}
_MODULES = ("optics", "report", "simulate")

__all__ = [
    "AcutanceError",
    "BarsLimits",
    "BarsMeasurement",
    "BarsOptions",
    "BiresolutionLimits",
    "BiresolutionMeasurement",
    "BiresolutionOptions",
    "Box",
    "CombineLimits",
    "CombineOptions",
    "CombinedMeasurement",
    "EdgeLimits",
    "EdgeOptions",
    "Esf",
    "Estimate",
    "Gsd",
    "Image",
    "ImageError",
    "Lsf",
    "Measurement",
    "ModelError",
    "Mtf",
    "NoBarsError",
    "NoEdgeError",
    "NoStarError",
    "OptionError",
    "PhaseError",
    "PointsLimits",
    "PointsMeasurement",
    "PointsOptions",
    "PulseLimits",
    "PulseOptions",
    "Region",
    "RegionError",
    "Response",
    "Sensor",
    "StarLimits",
    "StarMeasurement",
    "StarOptions",
    "SupportError",
    "TargetError",
    "TargetResult",
    "__version__",
    "combine",
    "measure_bars",
    "measure_biresolution",
    "measure_edge",
    "measure_edges",
    "measure_points",
    "measure_pulse",
    "measure_star",
    "open_image",
    "optics",
    "report",
    "simulate",
    "sites",
]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(_HOMES[name]), name)
    if name in _MODULES:
        return importlib.import_module(f"acutance.{name}")
    raise AttributeError(f"module 'acutance' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
