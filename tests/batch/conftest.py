"""A field with an edge and a pulse, in several images on a map that is some metres off."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from surveyed_field import EDGE, GSD_M, NORTH_M, PULSE, SENSOR, SHAPE, WEST_M, survey

import acutance as ac
from acutance.archive import Archive
from acutance.raster import write_geotiff
from acutance.simulate.campaign import render_site


@pytest.fixture(autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is remembered of images stays inside the test."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))


@pytest.fixture(scope="session")
def field_pixels() -> NDArray[np.float32]:
    """The field without noise."""
    return np.asarray(render_site(SENSOR, (EDGE, PULSE), SHAPE).image)


WriteField = Callable[..., Path]


@pytest.fixture
def write_field(field_pixels: NDArray[np.float32], tmp_path: Path) -> WriteField:
    """Write an image of the field: number, how far its map is off, and what else differs."""

    def write(
        number: int,
        off_m: tuple[float, float] = (0.0, 0.0),
        edit: Callable[[NDArray[Any]], NDArray[Any]] | None = None,
        **how: Any,
    ) -> Path:
        rng = np.random.default_rng(number)
        pixels = np.rint(field_pixels + rng.normal(0.0, 8.0, SHAPE)).astype(np.uint16)
        place = (GSD_M, 0.0, WEST_M + off_m[0], 0.0, -GSD_M, NORTH_M + off_m[1])
        path = tmp_path / f"field-{number}.tif"
        tags = {"SENSOR": "SIM-1", "ACQUISITION_DATETIME": f"2026-01-{1 + number:02d}T10:00:00Z"}
        given = {"crs": "EPSG:32631", "transform": place, "tags": tags, **how}
        write_geotiff(path, pixels if edit is None else edit(pixels), **given)
        return path

    return write


@pytest.fixture
def run(tmp_path: Path) -> Callable[..., Any]:
    """Run a batch of images in this process, by default with the survey of the field."""

    def run_with(*images: Any, targets: Any = None, **how: Any) -> Any:
        given = {"archive": tmp_path / "kept.db", "workers": 1, **how}
        return ac.run_batch(
            images=[str(one) for one in images], targets=targets or survey(), **given
        )

    return run_with


@pytest.fixture
def rows(tmp_path: Path) -> Callable[[], tuple[Any, Any]]:
    """Measurements and rejections of the archive."""

    def read() -> tuple[Any, Any]:
        with Archive(tmp_path / "kept.db", read_only=True) as archive:
            return archive.measurements(), archive.rejected()

    return read
