"""What the verdict of an edge predicts: edges of landscapes in loose regions, and clean ones.

Landscapes (`acutance.simulate.landscape`): fields, roofs, roads and discs beside one another, with
rims, gutters, shadows, roads and neighbours along their borders, texture of 1 to 4 % of the
contrast, soft and curved borders; every one behind another sensor of the families that the prior
was learned from, SNR 50 to 200 of the middle contrast. Every border of 12 px and more and of 5 % of
the highest contrast is measured in a region of its own length and 20 px to either side, whatever
lies there. An edge is wrong where MTF at Nyquist or RER is more than 4 deviations from the truth.

Clean edges: squares of 30 to 60 px, SNR 50 to 150, nothing but the edge (`trials.random_edge`):
how many the checks call doubtful or invalid.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from trials import METRICS, Ranges, command, publish, random_edge, table, work_through

import acutance as ac
from acutance.optics import FAMILIES, draw_sensor
from acutance.raster import Region
from acutance.simulate import LandscapeEdge

WORDS = ("good", "usable", "doubtful", "invalid")
SIZE_PX = 400
HALF_WIDTH_PX = 20.0
MIN_LENGTH_PX = 12.0
MIN_CONTRAST_SHARE = 0.05
OTHER_PX, OTHER_DEG = 2.0, 3.0
"""A fitted line farther than that from a border is another one."""
TOUCHING_PX = 0.25
"""A strip nearer than that touches the border."""
FAR, WRONG = 3.0, 4.0
"""Errors in deviations."""
JUDGED: Final = ("MTF(0.5)", "RER")


@dataclass(frozen=True)
class Finding:
    """One edge: `refused` names an error; `sigmas` is the larger error of `JUDGED`."""

    group: str
    refused: str = ""
    other: bool = False
    sigmas: float = 0.0
    verdict: str = ""
    failed: tuple[tuple[str, str], ...] = ()
    """Checks that failed, each with its severity."""


def judged(group: str, found: ac.EdgeMeasurement, truth: object, other: bool = False) -> Finding:
    """The error of a measurement beside its verdict."""
    sigmas = 0.0
    for name in JUDGED:
        value, true = METRICS[name](found.response), METRICS[name](truth.response).value
        sigmas = max(sigmas, abs(value.value - true) / value.std)
    failed = tuple((check.name, check.severity) for check in found.failed_checks)
    return Finding(group, "", other, sigmas, found.verdict.word, failed)


def is_other(edge: LandscapeEdge, found: ac.EdgeMeasurement) -> bool:
    """Whether the fitted line is not the border."""
    away_px = abs(float(edge.line.normal_distance(found.line.row, found.line.col)))
    turn_deg = abs((found.line.normal_deg - edge.line.normal_deg + 90) % 180 - 90)
    return away_px > OTHER_PX or turn_deg > OTHER_DEG


def neighbourhood(edge: LandscapeEdge) -> str:
    """What disturbs an edge most; strips that touch the border apart from those that do not."""
    kind = edge.kind(HALF_WIDTH_PX)
    if kind not in ("rim", "gutter"):
        return kind
    nearest = min(one.near_px for one in edge.beside if one.kind == kind)
    return f"{kind} {'at' if nearest < TOUCHING_PX else 'off'} the border"


def landscape_edges(seed: tuple[int, ...]) -> list[Finding]:
    """All edges of one landscape; the last number of the seed chooses the family."""
    rng = np.random.default_rng(seed)
    sensor = draw_sensor(list(FAMILIES)[seed[-1] % len(FAMILIES)], rng)
    snr = 100 * float(rng.uniform(0.5, 2))
    image, truth = ac.simulate.landscape(sensor, shape=(SIZE_PX, SIZE_PX), snr=snr, rng=rng)
    highest = max(edge.contrast for edge in truth.edges)
    findings = []
    for edge in truth.edges:
        if edge.length_px < MIN_LENGTH_PX or edge.contrast < MIN_CONTRAST_SHARE * highest:
            continue
        kind = neighbourhood(edge)
        try:
            found = ac.measure_edge(image, roi=Region(edge.region(HALF_WIDTH_PX)))
        except ac.AcutanceError as error:
            findings.append(Finding(kind, type(error).__name__))
            continue
        findings.append(judged(kind, found, edge, is_other(edge, found)))
    return findings


def clean_edge(job: tuple[str, tuple[int, ...]]) -> Finding:
    """One clean edge: of a reference system, or of a sensor drawn from a family."""
    group, seed = job
    rng = np.random.default_rng(seed)
    systems = ac.simulate.reference_systems()
    sensor = systems[group] if group in systems else draw_sensor(group.split()[0], rng)
    image, truth = random_edge(rng, sensor, Ranges())
    try:
        found = ac.measure_edge(image)
    except ac.AcutanceError as error:
        return Finding(group, type(error).__name__)
    return judged(group, found, truth)


def per_cent(count: int, of: int) -> str:
    """A share, or a dash of nothing."""
    return f"{100 * count / of:.1f}" if of else "-"


def shares(findings: list[Finding]) -> list[str]:
    """Number, and per cent beyond 3 and 4 deviations."""
    beyond = [sum(one.sigmas > limit for one in findings) for limit in (FAR, WRONG)]
    return [f"{len(findings)}", *(per_cent(count, len(findings)) for count in beyond)]


def bad(one: Finding) -> bool:
    """Whether the verdict warns."""
    return one.verdict in ("doubtful", "invalid")


def by_verdict(findings: list[Finding]) -> str:
    """Error rates by verdict."""
    rows = [[word, *shares([one for one in findings if one.verdict == word])] for word in WORDS]
    return table(["verdict", "edges", "> 3 / %", "> 4 / %"], rows)


def by_kind(findings: list[Finding]) -> str:
    """Error rates and verdicts by what lies beside the edge."""
    rows = []
    for kind in sorted({one.group for one in findings}):
        own = [one for one in findings if one.group == kind]
        wrong = [one for one in own if one.sigmas > WRONG]
        found = [per_cent(sum(one.verdict == word for one in own), len(own)) for word in WORDS]
        rows.append([kind, *shares(own), f"{sum(map(bad, wrong))} of {len(wrong)}", *found])
    head = ["beside the edge", "edges", "> 3 / %", "> 4 / %", "> 4 and warned"]
    return table([*head, *(f"{word} / %" for word in WORDS)], rows)


def by_check(findings: list[Finding]) -> str:
    """How often every check fails, and the error rate then."""
    graver = {
        "note": lambda failed: False,
        "caution": lambda failed: any(severity != "note" for _, severity in failed),
        "fail": lambda failed: any(severity == "fail" for _, severity in failed),
    }
    rows = []
    for name, severity in sorted({pair for one in findings for pair in one.failed}):
        pair = (name, severity)
        own = [one for one in findings if pair in one.failed]
        rest = [(one, [other for other in one.failed if other != pair]) for one in own]
        alone = [one for one, others in rest if not graver[severity](others)]
        many = per_cent(len(own), len(findings))
        rows.append([name, severity, many, *shares(own), *shares(alone)[:2]])
    head = ["check", "severity", "fails / %", "edges", "> 3 / %", "> 4 / %"]
    return table([*head, "as the gravest", "> 3 / %"], rows, texts=2)


def clean(findings: list[Finding]) -> str:
    """False warnings by system."""
    rows = []
    for group in dict.fromkeys(one.group for one in findings):
        own = [one for one in findings if one.group == group and not one.refused]
        warned = [one for one in own if bad(one)]
        names = [name for one in warned for name, severity in one.failed if severity != "note"]
        told = ", ".join(f"{name} {names.count(name)}" for name in sorted(set(names))) or "-"
        found = [per_cent(sum(one.verdict == word for one in own), len(own)) for word in WORDS]
        rows.append([group, told, *shares(own), *found])
    head = ["system", "warnings", "edges", "> 3 / %", "> 4 / %", *(f"{w} / %" for w in WORDS)]
    return table(head, rows, texts=2)


def main() -> None:
    parser = command(__doc__.partition("\n")[0], draws=60)
    parser.add_argument("--landscapes", type=int, default=90, help="of 400 x 400 px")
    arguments = parser.parse_args()
    seeds = [(arguments.seed, 0, number) for number in range(arguments.landscapes)]
    landscapes = work_through(landscape_edges, seeds, arguments.processes, "landscapes")
    every = [one for findings in landscapes for one in findings]
    found = [one for one in every if not (one.refused or one.other)]
    wrong = [one for one in found if one.sigmas > WRONG]
    groups = [*ac.simulate.reference_systems(), *(f"{name} (drawn)" for name in FAMILIES)]
    jobs = [
        (group, (arguments.seed, 1, number, draw))
        for number, group in enumerate(groups)
        for draw in range(arguments.draws)
    ]
    alone = work_through(clean_edge, jobs, arguments.processes, "clean edges")
    parts = [
        f"{len(every)} edges: {len(found)} measured, {sum(bool(one.refused) for one in every)} "
        f"refused; in {sum(one.other for one in every)} regions another edge was measured, which "
        "the tables leave out. > 3, > 4: per cent with an error of MTF at Nyquist or RER beyond so "
        "many deviations. Warned: doubtful or invalid.",
        "## By verdict",
        by_verdict(found),
        f"Of {len(wrong)} wrong ones {sum(map(bad, wrong))} are doubtful or invalid.",
        "## By what lies beside the edge",
        by_kind(found),
        "## By check",
        "As the gravest: edges where no other check that failed has this severity or a graver one.",
        by_check(found),
        "## Clean edges",
        clean(alone),
    ]
    publish("What the verdict of an edge predicts", parts, arguments)


if __name__ == "__main__":
    main()
