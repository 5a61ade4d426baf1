"""Comparisons of simulated archives whose true difference is known.

Example: python benchmarks/comparisons.py --draws 1000
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from trials import command, publish, table

from acutance.archive.columns import Columns
from acutance.archive.comparisons import Difference, compare_groups

LEVEL = 0.16
YEARS = 3.0


@dataclass(frozen=True)
class Case:
    """How two groups are simulated; all but numbers and times relative to the level.

    `images` of both groups, the same ones if the second number is 0. `targets` of each group at
    each of `sites`, one of which an image shows; the same ones for methods. All but the first
    target are in the first `seldom` images only, if that is more than 0. `air` is what an image
    has of its own, `own` what it does to one group only, `noise` the error of a measurement, of
    which `common` is the part of the variance that methods on the same pixels share. `target` is
    what a target has of its own, `site` what a site has. `later`: how many years the second group
    begins after the first. `together`: one measurement has both directions. `target_of_both`:
    methods see the same of a target, else each its own; `target_of_one` is what each sees alone.
    """

    images: tuple[int, int] = (20, 0)
    targets: int = 1
    sites: int = 1
    seldom: int = 0
    by: str = "orientation"
    difference: float = 0.0
    air: float = 0.04
    own: float = 0.01
    noise: float = 0.02
    common: float = 0.0
    target: float = 0.0
    target_of_one: float = 0.0
    site: float = 0.0
    drift: float = 0.0
    later: float = 0.0
    together: bool = False
    target_of_both: bool = True


CASES = {
    "edges, 40 images": Case(images=(40, 0)),
    "edges, 20 images": Case(),
    "edges, 5 images": Case(images=(5, 0)),
    "edges, 3 images": Case(images=(3, 0)),
    "edges, 40 images, across 3 % sharper": Case(images=(40, 0), difference=0.03),
    "points, both directions at once, 20 images": Case(together=True, common=0.5),
    "points, both directions at once, 5 images": Case(images=(5, 0), together=True, common=0.5),
    "3 targets each": Case(targets=3),
    "3 targets each, which differ by 2 %": Case(targets=3, target=0.02),
    "6 targets each, which differ by 2 %": Case(targets=6, target=0.02),
    "10 targets each, which differ by 5 %, 40 images": Case(
        images=(40, 0), targets=10, target=0.05
    ),
    "4 sites of one target each, 10 images of each": Case(images=(40, 0), sites=4),
    "4 sites of one target each, which differ by 2 %": Case(
        images=(40, 0), sites=4, target=0.02
    ),
    "4 sites of one target each, 3 images of each, which differ by 2 %": Case(
        images=(12, 0), sites=4, target=0.02
    ),
    "2 sites of one target each, 20 images of each, which differ by 2 %": Case(
        images=(40, 0), sites=2, target=0.02
    ),
    "3 sites of 2 targets each, which differ by 2 % both": Case(
        images=(18, 0), sites=3, targets=2, target=0.02, site=0.02
    ),
    "5 sites of 4 targets each, which differ by 2 % both": Case(
        images=(40, 0), sites=5, targets=4, target=0.02, site=0.02
    ),
    "one target in 20 images, another in 2, which differ by 3 %": Case(
        targets=2, seldom=2, target=0.03
    ),
    "one target in 20 images, 5 others in 8, which differ by 3 %": Case(
        targets=6, seldom=8, target=0.03
    ),
    "methods, 4 sites of one target each, which differ by 2 %": Case(
        images=(40, 0), sites=4, target=0.02, by="method", target_of_both=False
    ),
    "methods, 3 targets, .8 of the noise common": Case(
        by="method", targets=3, common=0.8, own=0.0
    ),
    "methods, 2 targets, 5 images": Case(images=(5, 0), by="method", targets=2, common=0.5),
    "methods, 20 targets of one image": Case(
        images=(1, 0), by="method", targets=20, common=0.5, own=0.0
    ),
    "methods, 20 targets of one image, each image its own 1 %": Case(
        images=(1, 0), by="method", targets=20, common=0.5
    ),
    "methods, 20 targets of two images, each image its own 1 %": Case(
        images=(2, 0), by="method", targets=20, common=0.5
    ),
    "other images, same years": Case(images=(20, 20), by="method"),
    "other images, 5 and 5": Case(images=(5, 5), by="method"),
    "other images, 3 and 10": Case(images=(3, 10), by="method"),
    "other images, 1 and 10": Case(images=(1, 10), by="method"),
    "other images, 3 sites of one target each, which differ by 2 %": Case(
        images=(36, 36), sites=3, target=0.02, by="method", target_of_both=False
    ),
    "other images, the same 4 sites of one target each, which differ by 5 %": Case(
        images=(40, 40), sites=4, target=0.05, by="method"
    ),
    "the same, by 1 % in what one method sees too": Case(
        images=(40, 40), sites=4, target=0.05, target_of_one=0.01, by="method"
    ),
    "other images, the same 3 sites of one target each, which differ by 5 %, 9 and 6": Case(
        images=(9, 6), sites=3, target=0.05, by="method"
    ),
    "other images, the same 10 targets in each, which differ by 5 %, 5 and 12": Case(
        images=(5, 12), targets=10, target=0.05, by="method"
    ),
    "other images, the same 5 sites of 4 targets each, which differ by 5 % both": Case(
        images=(40, 20), sites=5, targets=4, target=0.05, site=0.05, by="method"
    ),
    "other images, the same 4 sites, which differ by 5 %, drift 2 %, 2 years later": Case(
        images=(40, 40), sites=4, target=0.05, drift=0.02, later=2.0, by="method"
    ),
    "other images, drift 2 %, 2 years later": Case(
        images=(20, 20), by="method", drift=0.02, later=2.0
    ),
    "other images, drift 5 %, 4 years later": Case(
        images=(20, 20), by="method", drift=0.05, later=4.0
    ),
    "other images, drift 2 %, 4 years later, 6 each": Case(
        images=(6, 6), by="method", drift=0.02, later=4.0
    ),
    "other images, drift 2 %, 2 years later, 2 and 5": Case(
        images=(2, 5), by="method", drift=0.02, later=2.0
    ),
    "other images, drift 2 %, 2 years later, 2 and 2": Case(
        images=(2, 2), by="method", drift=0.02, later=2.0
    ),
    "other images, no drift, 4 years later, 12 each": Case(
        images=(12, 12), by="method", later=4.0
    ),
}  # fmt: skip


def simulate(case: Case, rng: np.random.Generator) -> Columns:
    """Rows of an archive: two groups, "across" and "along" or two methods."""
    apart = case.images[1] > 0
    one_size = case.images[0]
    other_size = case.images[1] or one_size
    year = 2021 + np.sort(YEARS * rng.random(one_size))
    air = case.air * rng.standard_normal(one_size)
    peculiar = _peculiar(case, rng)
    noise = rng.standard_normal((one_size, case.targets))
    parts = []
    for number, size in enumerate((one_size, other_size)):
        if number and apart:
            year = 2021 + case.later + np.sort(YEARS * rng.random(size))
            air = case.air * rng.standard_normal(size)
            noise = rng.standard_normal((size, case.targets))
        if number and not case.together and (case.by == "orientation" or not case.target_of_both):
            peculiar = _peculiar(case, rng)
        common = np.sqrt(case.common) * noise
        alone = np.sqrt(1 - case.common) * rng.standard_normal(noise.shape)
        value = 1 + case.difference * (number == 0) + case.drift * (year - 2022.5)
        value = value + air + case.own * rng.standard_normal(size)
        site = np.arange(size) % case.sites
        alone_seen = case.target_of_one * rng.standard_normal(peculiar.shape)
        relative = value[:, None] + (peculiar + alone_seen)[site] + case.noise * (common + alone)
        parts.append(_columns(case, number, apart, year, LEVEL * relative))
    return Columns({name: np.concatenate([part[name] for part in parts]) for name in parts[0]})


def _peculiar(case: Case, rng: np.random.Generator) -> np.ndarray:
    """What the targets of every site have of their own (sites, targets)."""
    own = case.target * rng.standard_normal((case.sites, case.targets))
    return own + case.site * rng.standard_normal((case.sites, 1))


def _columns(
    case: Case, number: int, apart: bool, year: np.ndarray, value: np.ndarray
) -> dict[str, np.ndarray]:
    size = value.size
    is_own_target = case.by == "orientation" and not case.together
    names = [f"{'ab'[number * is_own_target]}{at}" for at in range(case.targets)]
    sites = [f"S{at % case.sites}" for at in range(year.size)]
    microseconds = (31_557_600e6 * (year - 2020)).astype("m8[us]")
    words = {
        "sensor": "S", "band": "pan", "level": None, "kind": "edge",
        "orientation": ("across", "along")[number] if case.by == "orientation" else "across",
        "method": ("one", "other")[number] if case.by == "method" else "spline",
    }  # fmt: skip
    images = np.arange(year.size) + 10_000 * (number and apart)
    first = 0 if case.together else 10**6 * number
    columns = {
        **{name: np.full(size, word, object) for name, word in words.items()},
        "target": np.array(names * year.size, object),
        "site": np.repeat(np.array(sites, object), case.targets),
        "gsd_m": np.full(size, 0.6),
        "image_id": np.repeat(images, case.targets),
        "id": first + np.arange(size),
        "acquired": np.repeat(np.datetime64("2020-01-01", "us") + microseconds, case.targets),
        "mtf_nyquist": value.ravel(),
        "mtf_nyquist_std": np.full(size, case.noise * LEVEL),
        "mtf_nyquist_systematic_std": np.zeros(size),
    }
    at = np.arange(size)
    seen = (at % case.targets == 0) | (at // case.targets < (case.seldom or year.size))
    return {name: column[seen] for name, column in columns.items()}


def case_rows(draws: int, seed: int) -> Iterator[tuple[str, ...]]:
    """How often intervals hold, groups are said to differ and to agree; the typical deviation."""
    for name, case in CASES.items():
        rng = np.random.default_rng(seed)
        found: list[Difference] = []
        for _ in range(draws):
            compared = compare_groups(simulate(case, rng), "mtf_nyquist", case.by)
            found += compared.differences
        true = LEVEL * case.difference
        low, high = np.array([one.difference.interval() for one in found]).T
        held = np.mean((low <= true) & (true <= high))
        answers = [one.answer for one in found]
        shares = [answers.count(one) / draws for one in ("differ", "agree")]
        std = np.median([one.relative.std for one in found])
        bases = ", ".join(sorted({one.basis for one in found}))
        print(name, file=sys.stderr, flush=True)
        yield (
            name, bases, f"{100 * held:.1f}", *(f"{100 * share:.1f}" for share in shares),
            f"{100 * std:.2f}",
        )  # fmt: skip


def main() -> None:
    arguments = command(__doc__ or "", 1000).parse_args()
    parts = [
        f"{arguments.draws} archives each. What an image has of its own 4 % (to both groups) and "
        "1 % (to each), error of a measurement 2 %, images over 3 years, where nothing else is "
        "said. Of one or two images that hold both groups the interval is that of these images, "
        "and the answer that it cannot be told. Held: how often 95 % intervals hold the true "
        "difference, which is none except where it is stated. Agree: within 5 %.",
        table(["groups", "pairs", "held / %", "said to differ / %", "said to agree / %",
               "median std / %"], case_rows(arguments.draws, arguments.seed), 2),
    ]  # fmt: skip
    publish("Comparisons", parts, arguments)


if __name__ == "__main__":
    main()
