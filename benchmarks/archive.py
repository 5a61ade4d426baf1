"""Time, size and memory of an archive of 100,000 measurements, in SQLite and in PostgreSQL.

Every entry is the record of one simulated edge with other numbers, a place and a date of its own:
six sensors, 25 targets in every image, an image a day. Making them is measured apart and taken
off. Lists are columns of all numbers (`acutance.Archive.measurements`). Seconds are those of the
clock, and of the processor for what this process did: where other programs run, the clock shows
more. The server's own processor time is not counted.
"""

from __future__ import annotations

import os
import resource
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
from trials import command, publish, table

import acutance as ac
from acutance.archive import Archive, Entry, ImageEntry, TargetEntry

SENSOR = ac.simulate.reference_systems()["gaussian"]
SENSORS = ("QB02", "K3", "K3A", "S2A", "GF2", "PHR1A")
TARGETS = 25
NUMBERS = ("mtf_nyquist", "rer", "fwhm_px", "mtf50_cpp", "mtf_area")
BARS = {"add all": 20.0, "list of one sensor and year": 0.3}


@dataclass(frozen=True)
class Timed:
    """How long something took.

    Attributes
    ----------
    clock_s, processor_s : float
    found : object
        What it gave.
    """

    clock_s: float
    processor_s: float
    found: Any


def timed(work: Callable[[], Any]) -> Timed:
    """Do something once."""
    clock, processor = time.perf_counter(), time.process_time()
    found = work()
    return Timed(time.perf_counter() - clock, time.process_time() - processor, found)


def measured_edge(seed: int) -> ac.Record:
    """The record of an edge of 60 x 40 px at SNR 100."""
    pixels, _ = ac.simulate.edge(SENSOR, angle_deg=6, snr=100, rng=np.random.default_rng(seed))
    return ac.measure_edge(pixels).record


def entries(record: ac.Record, count: int, seed: int) -> Iterator[Entry]:
    """Entries of images of consecutive days, with numbers that scatter by 4 %."""
    rng = np.random.default_rng(seed)
    document, line = record.document, record.document["line"]
    targets = [TargetEntry(name=f"target {i}", kind="edge", site="field") for i in range(TARGETS)]
    for number in range(count):
        day, place = divmod(number, TARGETS)
        if place == 0:
            image = ImageEntry(
                path=f"/images/{day}.tif",
                content=f"{day:064x}",
                sensor=SENSORS[day % len(SENSORS)],
                acquired=datetime(2015, 1, 1, 10, 30, tzinfo=UTC) + timedelta(days=day),
            )
        scale = 1.0 + 0.04 * rng.standard_normal(len(NUMBERS))
        changed = {
            name: {**document[name], "value": document[name]["value"] * factor}
            for name, factor in zip(NUMBERS, scale.tolist(), strict=True)
        }
        changed["line"] = {**line, "row": float(number)}
        yield Entry(
            record=ac.Record({**document, **changed}),
            image=image, target=targets[place], band="pan",
        )  # fmt: skip


def measure_archive(place: str, record: ac.Record, count: int, seed: int) -> dict[str, Timed]:
    """What is asked of an archive, each once, but lists as the best of three."""
    made = timed(lambda: sum(1 for _ in entries(record, count, seed)))
    with Archive(place) as archive:
        added = timed(lambda: archive.add_entries(entries(record, count, seed)))
        assert added.found == count
        again = timed(lambda: archive.add_entries(entries(record, count // 10, seed)))
        assert again.found == 0
        year = {"sensor": "K3", "since": "2016-01-01", "until": "2016-12-31"}
        one = [timed(lambda: archive.measurements(**year)) for _ in range(3)]
        every = timed(lambda: archive.measurements(sensor="K3"))
        everything = timed(archive.measurements)
        records = timed(lambda: one[0].found.records())
    making = (made.clock_s, made.processor_s)
    return {
        "add all": less(added, *making),
        "add a tenth of them again": less(again, *(one / 10 for one in making)),
        "list of one sensor and year": min(one, key=lambda one: one.clock_s),
        "list of one sensor": every,
        "list of everything": everything,
        "documents of that sensor and year": records,
    }


def less(one: Timed, clock_s: float, processor_s: float) -> Timed:
    """A time without what was measured apart."""
    return Timed(one.clock_s - clock_s, one.processor_s - processor_s, one.found)


def rows_of(name: str, found: dict[str, Timed]) -> list[list[str]]:
    """Rows of the table of one database."""
    return [
        [
            name, what, f"{BARS[what]:g}" if what in BARS else "",
            f"{one.clock_s:.2f}", f"{one.processor_s:.2f}", amount(one.found),
        ]
        for what, one in found.items()
    ]  # fmt: skip


def amount(found: Any) -> str:
    """How many were added, or how many rows there are."""
    return f"{found}" if isinstance(found, int) else f"{len(found)}"


def main() -> None:
    """Measure an archive in a new file, and one on a server if there is one."""
    parser = command(__doc__.splitlines()[0], draws=100_000)
    parser.add_argument("--postgresql", help="URL of an empty database")
    arguments = parser.parse_args()
    record = measured_edge(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "campaign.db"
        found = measure_archive(str(path), record, arguments.draws, arguments.seed)
        size_mb = path.stat().st_size / 1e6
    rows = rows_of("SQLite", found)
    memory_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    if arguments.postgresql is not None:
        served = measure_archive(arguments.postgresql, record, arguments.draws, arguments.seed)
        rows += rows_of("PostgreSQL", served)
    document_kb = len(record.to_bytes()) / 1e3
    parts = [
        f"{arguments.draws} measurements of {len(SENSORS)} sensors in "
        f"{arguments.draws // TARGETS} images. A document is "
        f"{len(ac.report.json_text(record.document)) / 1e3:.0f} kB of JSON "
        f"({document_kb:.0f} kB by LZMA).",
        table(["database", "what", "bar / s", "clock / s", "processor / s", "rows"], rows, texts=2),
        table(
            ["", "found"],
            [
                ["file of SQLite, a measurement / kB", f"{1e3 * size_mb / arguments.draws:.1f}"],
                ["memory of the process, at most / MB", f"{memory_mb:.0f}"],
                ["load of the machine's two cores", f"{os.getloadavg()[2]:.1f}"],
            ],
        ),
    ]
    publish("An archive of many measurements", parts, arguments)


if __name__ == "__main__":
    main()
