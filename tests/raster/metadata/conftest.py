"""A product's folder: an image of a name with documents beside it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from acutance.raster import write_geotiff
from acutance.raster.metadata import ImageStatement, read_statement


@pytest.fixture
def product(tmp_path: Path) -> Callable[..., ImageStatement]:
    """Writes an image and documents by their names, and reads what they say."""

    def read(image: str, documents: dict[str, str | bytes], bands: int = 1, **how: object):
        path = tmp_path / image
        path.parent.mkdir(parents=True, exist_ok=True)
        write_geotiff(path, np.ones((bands, 16, 16), np.uint16), **how)
        for name, text in documents.items():
            place = tmp_path / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_statement(path)

    return read
