"""Which share of a scene's measured edges is good or usable, of sensors and of decimated images.

Landscapes with all that lies beside objects (`acutance.simulate.landscape`), 800 x 800 px, seen by
a sensor drawn from each of the families of `acutance.optics`, at SNR 25, 60 and 150 in turn; then
landscapes of the Gaussian reference system at SNR 60 of which every second, third or fourth pixel
is taken, without a filter. The limit of the check `trusted_share` of a scan stands on this.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from trials import command, publish, table, work_through

import acutance as ac
from acutance.scan.checks import judged_edges

SNR = (25.0, 60.0, 150.0)
SIZE_PX = 800
DECIMATED = {"every second pixel": 2, "every third pixel": 3, "every fourth pixel": 4}
DECIMATED_SNR = 60.0


@dataclass(frozen=True)
class Trusted:
    """Edges of one scene that were measured and are not faint; those that are good or usable."""

    measured: int
    used: int
    verdict: str

    @property
    def share(self) -> float:
        return self.used / max(self.measured, 1)


def image_of(kind: str, seed: int) -> np.ndarray:
    """The pixels of one scene."""
    rng = np.random.default_rng((seed, 7))
    step = DECIMATED.get(kind, 1)
    if step > 1:
        sensor, snr = ac.simulate.reference_systems()["gaussian"], DECIMATED_SNR
    else:
        sensor, snr = ac.optics.draw_sensor(kind, rng), SNR[seed % len(SNR)]
    shape = (min(step * SIZE_PX, 2400),) * 2
    return ac.simulate.landscape(sensor, shape=shape, snr=snr, rng=rng)[0][::step, ::step]


def scanned(job: tuple[str, int]) -> Trusted:
    """Scan one scene."""
    try:
        scene = ac.scan_scene(image_of(*job))
        edges, verdict = scene.edges, scene.verdict.word
    except ac.FewEdgesError as error:
        edges, verdict = error.edges, "refused"
    return Trusted(judged_edges(edges), int(edges.used.sum()), verdict)


def main() -> None:
    arguments = command(__doc__.partition("\n")[0], draws=len(SNR)).parse_args()
    kinds = (*ac.optics.FAMILIES, *DECIMATED)
    jobs = [(kind, arguments.seed + draw) for kind in kinds for draw in range(arguments.draws)]
    found = work_through(scanned, jobs, arguments.processes, "scenes")
    rows = []
    for kind in kinds:
        own = [one for (name, _), one in zip(jobs, found, strict=True) if name == kind]
        shares = [one.share for one in own]
        verdicts = ", ".join(one.verdict for one in own)
        edges = f"{np.mean([one.measured for one in own]):.0f}"
        rows.append([kind, verdicts, edges, f"{min(shares):.2f}", f"{max(shares):.2f}"])
    head = ["sensor, or what is taken of the image", "verdicts", "edges measured", "least share",
            "largest"]  # fmt: skip
    text = __doc__.partition("\n\n")[2].strip()
    publish("Trusted edges of scenes", [text, table(head, rows, texts=2)], arguments)


if __name__ == "__main__":
    main()
