"""Records to keep, and an archive of either database."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
import pytest

import acutance as ac
from acutance.archive import Archive, Entry, ImageEntry, TargetEntry

SENSOR = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()], gsd_m=0.7)


@pytest.fixture(scope="session")
def edge_record() -> ac.Record:
    """An edge at 6 degrees, SNR 100, 0.7 m, measured across track."""
    pixels, _ = ac.simulate.edge(
        SENSOR, angle_deg=6.0, shape=(60, 44), snr=100, rng=np.random.default_rng(3)
    )
    return ac.measure_edge(pixels, gsd_m=0.7).record


@pytest.fixture(scope="session")
def bars_record() -> ac.Record:
    """A star: both directions in one measurement."""
    pixels, _ = ac.simulate.star(
        SENSOR, cycles=36, radius_px=60, snr=100, rng=np.random.default_rng(3)
    )
    return ac.measure_star(pixels, cycles=36, gsd_m=0.7).record


@pytest.fixture
def entry_of(edge_record: ac.Record) -> Any:
    """Makes the entry of number i: image i // 2, target i % 2, MTF at Nyquist .1 + .001 i."""

    def make(i: int, **changes: Any) -> Entry:
        number = edge_record.document["mtf_nyquist"]
        changed = {"mtf_nyquist": {**number, "value": 0.1 + 0.001 * i}}
        image = ImageEntry(
            path=f"/images/{i // 2}.tif",
            content=f"{i // 2:064x}",
            sensor="QB02" if i // 2 % 2 else "K3",
            acquired=datetime(2026, 1, 1, 10, tzinfo=UTC) + timedelta(days=i // 2),
        )
        target = TargetEntry(name=f"tarp {i % 2}", kind="edge", site="Stennis")
        record = ac.Record({**edge_record.document, **changed})
        return Entry(
            **{"record": record, "image": image, "target": target, "band": "pan"} | changes
        )

    return make


@pytest.fixture(params=["sqlite", "postgresql"])
def place(request: pytest.FixtureRequest, tmp_path: Any) -> str:
    """Where an archive may be made, in either database."""
    if request.param == "sqlite":
        return str(tmp_path / "kept.db")
    return str(request.getfixturevalue("postgres_url"))


@pytest.fixture
def archive(place: str) -> Iterator[Archive]:
    """An empty archive of either database."""
    with Archive(place) as opened:
        yield opened
