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
    ArchiveError,
    FewEdgesError,
    ImageError,
    ModelError,
    NoBarsError,
    NoDataError,
    NoEdgeError,
    NoStarError,
    NothingSelectedError,
    OptionError,
    PhaseError,
    RegionError,
    SupportError,
    TargetError,
    WorkerError,
)

if TYPE_CHECKING:
    from acutance import (
        archive,
        batch,
        curves,
        execution,
        geometry,
        optics,
        raster,
        report,
        restoration,
        scan,
        simulate,
        studies,
        targets,
    )
    from acutance.archive import Archive
    from acutance.batch import BatchPlan, BatchSummary, read_plan, run_batch
    from acutance.curves import Esf, Estimate, Estimates, Lsf, Mtf, Response
    from acutance.geometry import Line
    from acutance.optics import Sensor
    from acutance.raster import Box, Gsd, Image, Region, open_image, sites
    from acutance.raster.metadata import ImageStatement, read_statement
    from acutance.restoration import (
        NaturalScene,
        Niirs,
        RestorationFilter,
        RestorationProof,
        RestoredImage,
        design_restoration,
        niirs,
        restore,
        verify_restoration,
    )
    from acutance.scan import (
        BandScenes,
        BandShift,
        ScanOptions,
        SceneEdges,
        SceneMeasurement,
        scan_bands,
        scan_scene,
    )
    from acutance.targets import (
        Check,
        ImageInfo,
        Measurement,
        Record,
        Rejected,
        TargetResult,
        Verdict,
    )
    from acutance.targets.combine import CombinedMeasurement, CombineOptions, combine
    from acutance.targets.pair import (
        BiresolutionMeasurement,
        BiresolutionOptions,
        measure_biresolution,
    )
    from acutance.targets.periodic import (
        BarsMeasurement,
        BarsOptions,
        StarMeasurement,
        StarOptions,
        measure_bars,
        measure_star,
    )
    from acutance.targets.points import PointsMeasurement, PointsOptions, measure_points
    from acutance.targets.straight import (
        EdgeOptions,
        PulseOptions,
        StraightMeasurement,
        each_edge,
        each_pulse,
        measure_edge,
        measure_edges,
        measure_pulse,
        measure_pulses,
    )

__version__ = "0.1.0"

# Where a public name lives. Modules are loaded when a name is first used, so that
# `import acutance` stays quick.
_HOMES = {
    "Archive": "acutance.archive",
    "BandScenes": "acutance.scan",
    "BandShift": "acutance.scan",
    "BarsMeasurement": "acutance.targets.periodic",
    "BarsOptions": "acutance.targets.periodic",
    "BatchPlan": "acutance.batch",
    "BatchSummary": "acutance.batch",
    "BiresolutionMeasurement": "acutance.targets.pair",
    "BiresolutionOptions": "acutance.targets.pair",
    "Box": "acutance.raster",
    "Check": "acutance.targets",
    "CombineOptions": "acutance.targets.combine",
    "CombinedMeasurement": "acutance.targets.combine",
    "EdgeOptions": "acutance.targets.straight",
    "Esf": "acutance.curves",
    "Estimate": "acutance.curves",
    "Estimates": "acutance.curves",
    "Gsd": "acutance.raster",
    "Image": "acutance.raster",
    "ImageInfo": "acutance.targets",
    "ImageStatement": "acutance.raster.metadata",
    "Line": "acutance.geometry",
    "Lsf": "acutance.curves",
    "Measurement": "acutance.targets",
    "Mtf": "acutance.curves",
    "NaturalScene": "acutance.restoration",
    "Niirs": "acutance.restoration",
    "PointsMeasurement": "acutance.targets.points",
    "PointsOptions": "acutance.targets.points",
    "PulseOptions": "acutance.targets.straight",
    "Record": "acutance.targets",
    "Region": "acutance.raster",
    "Rejected": "acutance.targets",
    "Response": "acutance.curves",
    "RestorationFilter": "acutance.restoration",
    "RestorationProof": "acutance.restoration",
    "RestoredImage": "acutance.restoration",
    "ScanOptions": "acutance.scan",
    "SceneEdges": "acutance.scan",
    "SceneMeasurement": "acutance.scan",
    "Sensor": "acutance.optics",
    "StarMeasurement": "acutance.targets.periodic",
    "StarOptions": "acutance.targets.periodic",
    "StraightMeasurement": "acutance.targets.straight",
    "TargetResult": "acutance.targets",
    "Verdict": "acutance.targets",
    "combine": "acutance.targets.combine",
    "design_restoration": "acutance.restoration",
    "each_edge": "acutance.targets.straight",
    "each_pulse": "acutance.targets.straight",
    "measure_bars": "acutance.targets.periodic",
    "measure_biresolution": "acutance.targets.pair",
    "measure_edge": "acutance.targets.straight",
    "measure_edges": "acutance.targets.straight",
    "measure_points": "acutance.targets.points",
    "measure_pulse": "acutance.targets.straight",
    "measure_pulses": "acutance.targets.straight",
    "measure_star": "acutance.targets.periodic",
    "niirs": "acutance.restoration",
    "open_image": "acutance.raster",
    "read_plan": "acutance.batch",
    "read_statement": "acutance.raster.metadata",
    "run_batch": "acutance.batch",
    "restore": "acutance.restoration",
    "scan_bands": "acutance.scan",
    "scan_scene": "acutance.scan",
    "sites": "acutance.raster",
    "verify_restoration": "acutance.restoration",
}
_MODULES = (
    "archive",
    "batch",
    "curves",
    "errors",
    "execution",
    "geometry",
    "optics",
    "raster",
    "report",
    "restoration",
    "scan",
    "simulate",
    "studies",
    "targets",
)

__all__ = [
    "AcutanceError",
    "Archive",
    "ArchiveError",
    "BandScenes",
    "BandShift",
    "BarsMeasurement",
    "BarsOptions",
    "BatchPlan",
    "BatchSummary",
    "BiresolutionMeasurement",
    "BiresolutionOptions",
    "Box",
    "Check",
    "CombineOptions",
    "CombinedMeasurement",
    "EdgeOptions",
    "Esf",
    "Estimate",
    "Estimates",
    "FewEdgesError",
    "Gsd",
    "Image",
    "ImageError",
    "ImageInfo",
    "ImageStatement",
    "Line",
    "Lsf",
    "Measurement",
    "ModelError",
    "Mtf",
    "NaturalScene",
    "Niirs",
    "NoBarsError",
    "NoDataError",
    "NoEdgeError",
    "NoStarError",
    "NothingSelectedError",
    "OptionError",
    "PhaseError",
    "PointsMeasurement",
    "PointsOptions",
    "PulseOptions",
    "Record",
    "Region",
    "RegionError",
    "Rejected",
    "Response",
    "RestorationFilter",
    "RestorationProof",
    "RestoredImage",
    "ScanOptions",
    "SceneEdges",
    "SceneMeasurement",
    "Sensor",
    "StarMeasurement",
    "StarOptions",
    "StraightMeasurement",
    "SupportError",
    "TargetError",
    "TargetResult",
    "Verdict",
    "WorkerError",
    "__version__",
    "archive",
    "batch",
    "combine",
    "curves",
    "design_restoration",
    "each_edge",
    "each_pulse",
    "errors",
    "execution",
    "geometry",
    "measure_bars",
    "measure_biresolution",
    "measure_edge",
    "measure_edges",
    "measure_points",
    "measure_pulse",
    "measure_pulses",
    "measure_star",
    "niirs",
    "open_image",
    "optics",
    "raster",
    "read_plan",
    "read_statement",
    "report",
    "restoration",
    "restore",
    "run_batch",
    "scan",
    "scan_bands",
    "scan_scene",
    "simulate",
    "sites",
    "studies",
    "targets",
    "verify_restoration",
]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(_HOMES[name]), name)
    if name in _MODULES:
        return importlib.import_module(f"acutance.{name}")
    raise AttributeError(f"module 'acutance' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
