"""A campaign through `acutance batch`: what it costs beside the measurements, what a kill costs.

Images of 512 x 512 px show ten targets (seven edges, two pulses, twenty mirrors), with maps that
are off by 2 m (benchmarks/batch_campaign.py). The first run is timed against what its workers spent
measuring; the second finds everything done. Then two batches work on one archive at once, over
and over, and are killed at random moments: keys that were reported as kept (--log) are compared
with the rows there are. The same with PostgreSQL stopped and started under a batch, where Debian's
package is installed. Times are of the processor, which other work on the machine changes least, and
of the clock; the start of Python is included.
"""

from __future__ import annotations

import importlib.util
import json
import os
import resource
import signal
import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from batch_campaign import make_campaign
from trials import command, publish, table

from acutance.archive import Archive

TARGETS, EDGES = 10, 7
KILL_IMAGES = 8


@dataclass(frozen=True)
class Run:
    """One call of the command.

    Attributes
    ----------
    found : dict
        Its document.
    wall_s, processor_s : float
    """

    found: dict[str, Any]
    wall_s: float
    processor_s: float


def words(images: list[str], targets: str, archive: str, workers: int) -> list[str]:
    """The command line of a batch."""
    return [
        sys.executable, "-m", "acutance", "batch", *images, "--targets", targets,
        "--archive", archive, "--workers", str(workers), "--json",
    ]  # fmt: skip


def run(line: list[str]) -> Run:
    """Run a batch to its end."""
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(line, capture_output=True, text=True, check=True)
    wall_s, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    processor_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Run(json.loads(done.stdout), wall_s, processor_s)


def campaign_rows(folder: Path, count: int, workers: int, rng: Any) -> list[list[str]]:
    """First and second run of the whole campaign."""
    pattern, targets = make_campaign(folder, count, rng)
    line = words([pattern], targets, str(folder / "campaign.db"), workers)
    first, second = run(line), run(line)
    assert first.found["kept"] == count * TARGETS == second.found["done_before"]
    measuring_s = first.found["measuring_s"]
    above_s = first.processor_s - measuring_s
    verdicts = ", ".join(f"{many} {word}" for word, many in first.found["verdicts"].items())
    return [
        ["images x targets", f"{count} x {TARGETS}"],
        ["measured, rejected", f"{first.found['measured']}, {first.found['rejected']}"],
        ["verdicts", verdicts],
        ["first run, clock / s", f"{first.wall_s:.1f}"],
        ["first run, processor / s", f"{first.processor_s:.1f}"],
        ["its measurements alone, processor / s", f"{measuring_s:.1f}"],
        ["above them, processor / s", f"{above_s:.1f}"],
        [f"above them, over {workers} cores / s", f"{above_s / workers:.1f}"],
        ["second run, clock / s", f"{second.wall_s:.1f}"],
        ["second run, processor / s", f"{second.processor_s:.1f}"],
    ]


def reported(log: Path) -> list[str]:
    """Keys of whole lines: the last one may have been cut by the kill."""
    text = log.read_text(encoding="utf-8") if log.exists() else ""
    return [json.loads(one)["key"] for one in text.splitlines(keepends=True) if one[-1] == "\n"]


def kill_rows(folder: Path, place: str, kills: int, rng: Any) -> list[list[str]]:
    """Two batches at once on one archive, one of them killed at a random moment, over and over."""
    pattern, targets = make_campaign(folder, KILL_IMAGES, rng)
    document = json.loads(Path(targets).read_text(encoding="utf-8"))
    document["features"] = document["features"][:EDGES]
    Path(targets).write_text(json.dumps(document), encoding="utf-8")
    lost, twice, failed, done, rounds = 0, 0, 0, 0, 0
    while done < kills:
        rounds += 1
        archive = place.format(rounds)
        log = folder / f"log-{rounds}.jsonl"
        line = [*words([pattern], targets, archive, 1), "--log", str(log)]
        finished = False
        while not finished and done < kills:
            both = [subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                    for _ in range(2)]  # fmt: skip
            time.sleep(float(rng.uniform(0.5, 4.0)))
            if both[0].poll() is None:
                both[0].send_signal(signal.SIGKILL)
                done += 1
            for one in both:
                one.communicate()
            failed += both[1].returncode != 0
            finished = both[0].returncode == 0 or both[1].returncode == 0
        last = run(line)
        with Archive(archive, read_only=True) as kept:
            keys, measured = kept.keys(), kept.measurements()
        lost += len(set(reported(log)) - keys)
        twice += len(measured) - len(keys)
        assert last.found["measured"] == KILL_IMAGES * EDGES == len(keys)
    return [
        ["kills", str(done)],
        ["reported as kept and not there", str(lost)],
        ["there twice", str(twice)],
        ["other batches of the pair that failed", str(failed)],
    ]


def server_rows(folder: Path, rng: Any) -> list[list[str]]:
    """PostgreSQL stopped and started again under a batch."""
    server = postgres(folder)
    if server is None:
        return [["PostgreSQL", "not installed"]]
    pattern, targets = make_campaign(folder, KILL_IMAGES, rng)
    place = server.empty_database("campaign")
    stops: list[float] = []
    try:
        line = words([pattern], targets, place, 1)
        running = subprocess.Popen(line, stdout=subprocess.PIPE, text=True)
        for _ in range(3):
            threading.Event().wait(3.0)
            if running.poll() is None:
                server.stop()
                threading.Event().wait(2.0)
                server.start()
                stops.append(2.0)
        output, _ = running.communicate()
        measured = json.loads(output)["measured"] if running.returncode == 0 else "none"
        with Archive(place) as kept:
            keys = kept.keys()
    finally:
        server.stop()
    return [
        ["PostgreSQL stopped for 2 s under a batch, times", str(len(stops))],
        ["exit code of the batch", str(running.returncode)],
        ["rows of the archive, of the campaign", f"{len(keys)}, {measured}"],
    ]


def postgres(folder: Path) -> Any:
    """The private server of the tests; None where PostgreSQL is not installed."""
    path = Path(__file__).parents[1] / "tests" / "conftest.py"
    spec = importlib.util.spec_from_file_location("private_server", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["private_server"] = module
    spec.loader.exec_module(module)
    if not module.BINARIES:
        return None
    import shutil
    import tempfile

    own = Path(tempfile.mkdtemp(prefix="pg-"))
    user = module.UNPRIVILEGED[0]
    if os.geteuid() == 0:
        shutil.chown(own, user)
    server = module.PostgresServer(own, module.BINARIES[-1], user)
    server.make()
    server.start()
    return server


def main() -> None:
    """Run the benchmark."""
    parser = command(__doc__ or "", draws=200)
    parser.add_argument("--kills", type=int, default=50)
    arguments = parser.parse_args()
    rng = np.random.default_rng(arguments.seed)
    with TemporaryDirectory() as name:
        folder = Path(name)
        os.environ["XDG_CACHE_HOME"] = str(folder / "cache")
        parts = [
            f"{arguments.draws} images of 512 x 512 px with ten targets each: seven edges, two "
            "pulses and twenty mirrors, surveyed positions and maps off by 2 m (1 standard "
            "deviation), GSD 0.7 m. The start of Python and of the workers is included.",
            table(["", "found"],
                  campaign_rows(folder / "whole", arguments.draws, arguments.processes, rng)),
            f"Two batches of {KILL_IMAGES} images and seven edges at once on one archive, one of "
            "them killed (SIGKILL) after .5 to 4 s, and begun again until all is done:",
            table(["", "found"],
                  kill_rows(folder / "kills", str(folder / "kills-{}.db"), arguments.kills, rng)),
            table(["", "found"], server_rows(folder / "server", rng)),
        ]  # fmt: skip
    publish("Batches", parts, arguments)


if __name__ == "__main__":
    main()
