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
    from acutance.curves import Esf, Estimate, Estimates, Lsf, Mtf, Response
    from acutance.optics import Sensor
    from acutance.raster import Box, Gsd, Image, Region, open_image, sites
    from acutance.targets import Measurement
    from acutance.targets.combine import CombinedMeasurement, CombineLimits, CombineOptions, combine
    from acutance.targets.pair import (
        BiresolutionLimits,
        BiresolutionMeasurement,
        BiresolutionOptions,
        measure_biresolution,
    )
    from acutance.targets.periodic import (
        BarsLimits,
        BarsMeasurement,
        BarsOptions,
        StarLimits,
        StarMeasurement,
        StarOptions,
        measure_bars,
        measure_star,
    )
    from acutance.targets.points import (
        PointsLimits,
        PointsMeasurement,
        PointsOptions,
        measure_points,
    )
    from acutance.targets.straight import (
        EdgeLimits,
        EdgeOptions,
        PulseLimits,
        PulseOptions,
        TargetResult,
        measure_edge,
        measure_edges,
        measure_pulse,
    )

__version__ = "0.1.0"

# Where a public name lives. Modules are loaded when a name is first used, so that
# `import acutance` stays quick.
_HOMES = {
    "BarsLimits": "acutance.targets.periodic",
    "BarsMeasurement": "acutance.targets.periodic",
    "BarsOptions": "acutance.targets.periodic",
    "BiresolutionLimits": "acutance.targets.pair",
    "BiresolutionMeasurement": "acutance.targets.pair",
    "BiresolutionOptions": "acutance.targets.pair",
    "Box": "acutance.raster",
    "CombineLimits": "acutance.targets.combine",
    "CombineOptions": "acutance.targets.combine",
    "CombinedMeasurement": "acutance.targets.combine",
    "EdgeLimits": "acutance.targets.straight",
    "EdgeOptions": "acutance.targets.straight",
    "Esf": "acutance.curves",
    "Estimate": "acutance.curves",
    "Estimates": "acutance.curves",
    "Gsd": "acutance.raster",
    "Image": "acutance.raster",
    "Lsf": "acutance.curves",
    "Measurement": "acutance.targets",
    "Mtf": "acutance.curves",
    "PointsLimits": "acutance.targets.points",
    "PointsMeasurement": "acutance.targets.points",
    "PointsOptions": "acutance.targets.points",
    "PulseLimits": "acutance.targets.straight",
    "PulseOptions": "acutance.targets.straight",
    "Region": "acutance.raster",
    "Response": "acutance.curves",
    "Sensor": "acutance.optics",
    "StarLimits": "acutance.targets.periodic",
    "StarMeasurement": "acutance.targets.periodic",
    "StarOptions": "acutance.targets.periodic",
    "TargetResult": "acutance.targets.straight",
    "combine": "acutance.targets.combine",
    "measure_bars": "acutance.targets.periodic",
    "measure_biresolution": "acutance.targets.pair",
    "measure_edge": "acutance.targets.straight",
    "measure_edges": "acutance.targets.straight",
    "measure_points": "acutance.targets.points",
    "measure_pulse": "acutance.targets.straight",
    "measure_star": "acutance.targets.periodic",
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
    "Estimates",
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
