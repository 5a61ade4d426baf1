"""Random regions of every image of a folder, measured by every method: what becomes of them.

A draw is a file, a band, a method with random options and a region of 3 px to the whole image,
partly outside, damaged or torn by missing pixels. Measurements are counted by verdict, refusals by
the class of their error; whatever else is raised, a warning included, is a crash, as is to take
more memory or time than any target deserves; a command that repeats it is printed. A draw depends
on the seed and its number alone. Runs of any length add to one journal.
"""

from __future__ import annotations

import argparse
import json
import resource
import shlex
import signal
import sys
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from trials import command, publish, table

import acutance as ac
from acutance import report
from acutance.errors import AcutanceError
from acutance.raster import Box, Image, Region
from acutance.targets.kinds import KINDS, Kind

ENDINGS = (".tif", ".tiff", ".jp2", ".jpg", ".png", ".npy")
MIN_SIDE_PX, WHOLE_SHARE = 3, 0.01
USUAL_PX = (16, 200)
PAIR = ("08_*_20m_*", "08_*_10m_*")
MAX_SECONDS, MAX_BYTES = 120, 5_000_000_000
"""Of the processor, and of addresses, that a draw may take."""
PAGE_EVERY = 40
"""Of so many draws one is also drawn as a page: that takes longer than to measure it."""
SHARES = {
    "edge": 4, "edges": 3, "pulse": 4, "points": 3, "bars": 2, "star": 1, "biresolution": 2,
}  # fmt: skip
"""How often a kind of target is drawn; each of its methods equally often."""
VERDICTS = ("good", "usable", "doubtful", "invalid")


@dataclass(frozen=True)
class Draw:
    """One region and how it is measured.

    Attributes
    ----------
    paths : tuple of str
        The image; of a pair the finer one as well.
    band : int
    kind, method : str
        "edges" stands for all edges of a region.
    box : (row, col, height, width)
        May reach beyond the image.
    shape : str
        Of the region: "box" or "polygon".
    damage : str
        What is done to the pixels before they are measured; "none" leaves them in their file.
    arguments, options : mapping
        Of the measuring function, and of the options of its kind.
    """

    paths: tuple[str, ...]
    band: int
    kind: str
    method: str
    box: tuple[int, int, int, int]
    shape: str
    damage: str
    arguments: Mapping[str, Any]
    options: Mapping[str, Any]


@cache
def images_of(folder: str) -> tuple[str, ...]:
    """All images of a folder and its folders, in order."""
    found = sorted(Path(folder).rglob("*"))
    return tuple(str(path) for path in found if path.suffix.lower() in ENDINGS)


@cache
def opened(path: str, band: int) -> Image:
    return ac.open_image(path, band)


@lru_cache(maxsize=8)
def whole_pixels(path: str, band: int) -> np.ndarray:
    return opened(path, band).read()


def kind_of(name: str) -> Kind:
    """The kind of target of a draw."""
    return KINDS["edge" if name == "edges" else name]


def draw_number(number: int, folder: str, seed: int) -> tuple[Draw, np.random.Generator]:
    """The draw of a number, and the generator that goes on to damage its pixels."""
    rng = np.random.default_rng([seed, number])
    paths = images_of(folder)
    kind = _choice(rng, [name for name, share in SHARES.items() for _ in range(share)])
    files: tuple[str, ...] = (_choice(rng, paths),)
    if kind == "biresolution":
        files = tuple(next(p for p in paths if Path(p).match(pattern)) for pattern in PAIR)
    band = int(rng.integers(1, opened(files[0], 1).band_count + 1))
    method = _choice(rng, kind_of(kind).methods)
    arguments, options = _asked(kind, method, rng)
    box = random_box(opened(files[0], 1).shape, rng)
    shape = _choice(rng, ["box", "box", "box", "polygon"])
    damage = _choice(rng, ["none", "none", "none", *DAMAGES])
    return Draw(files, band, kind, method, box, shape, damage, arguments, options), rng


def random_box(shape: tuple[int, int], rng: np.random.Generator) -> tuple[int, int, int, int]:
    """A box of random size, mostly that of targets; one of eight reaches beyond the image."""
    if rng.random() < WHOLE_SHARE:
        return 0, 0, *shape
    usual = rng.random() < 0.7
    sides = []
    for side in shape:
        low, high = USUAL_PX if usual else (MIN_SIDE_PX, side)
        size = round(float(np.exp(rng.uniform(np.log(low), np.log(high)))))
        sides.append(min(size, side))
    beyond = rng.random() < 1 / 8
    corner = [
        int(rng.integers(-own // 2, side - own // 2 + 1) if beyond
            else rng.integers(0, side - own + 1))
        for own, side in zip(sides, shape, strict=True)
    ]  # fmt: skip
    return corner[0], corner[1], sides[0], sides[1]


def _asked(
    kind: str, method: str, rng: np.random.Generator
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Random arguments and options of a kind of target."""
    reference = method == kind_of(kind).methods[0]
    robust = {"robust": bool(rng.random() < 0.8 or not reference)}
    if kind in ("edge", "edges"):
        return {}, {**robust, "rer_centre": _choice(rng, [None, None, "half", "peak"])}
    if kind == "pulse":
        if rng.random() < 0.3:
            return {}, robust
        width_px = float(np.exp(rng.uniform(np.log(0.5), np.log(30.0))))
        return {"width_px": round(width_px, 2), "fit_width": bool(rng.random() < 0.7)}, robust
    if kind == "points":
        return {}, {**robust, "min_snr": _choice(rng, [3.0, 10.0, 30.0])}
    if kind == "bars":
        return {}, {**robust, "count": _choice(rng, [None, None, 3, 5])}
    if kind == "star":
        return {"cycles": _choice(rng, [None, 8, 36, 72])}, robust
    return {"ratio": _choice(rng, [None, None, 2.0])}, robust


def _choice(rng: np.random.Generator, of: Sequence[Any]) -> Any:
    return of[int(rng.integers(len(of)))]


def _holes(pixels: np.ndarray, rng: np.random.Generator) -> None:
    pixels[rng.random(pixels.shape) < rng.uniform(0.001, 0.6)] = np.nan


def _stripe(pixels: np.ndarray, rng: np.random.Generator) -> None:
    first = int(rng.integers(pixels.shape[0]))
    pixels[first : first + int(rng.integers(1, 6))] = np.nan


def _corner(pixels: np.ndarray, rng: np.random.Generator, value: float = np.nan) -> None:
    """Everything beyond a random straight line, as beyond the border of a warped scene."""
    rows, cols = np.indices(pixels.shape)
    angle = rng.uniform(0, 2 * np.pi)
    along = np.cos(angle) * cols + np.sin(angle) * rows
    pixels[along > np.quantile(along, rng.uniform(0.1, 0.9))] = value


def _fill(pixels: np.ndarray, rng: np.random.Generator) -> None:
    _corner(pixels, rng, _choice(rng, [0.0, -9999.0, 65535.0]))


def _clip(pixels: np.ndarray, rng: np.random.Generator) -> None:
    levels = np.nanquantile(pixels, rng.uniform(0, 1, 2)) if np.isfinite(pixels).any() else (0, 1)
    np.clip(pixels, min(levels), max(levels), out=pixels)


def _flat(pixels: np.ndarray, rng: np.random.Generator) -> None:
    pixels[np.isfinite(pixels)] = rng.uniform(0, 1e4)


def _scale(pixels: np.ndarray, rng: np.random.Generator) -> None:
    pixels *= 10.0 ** rng.uniform(-12, 12)


def _few_levels(pixels: np.ndarray, rng: np.random.Generator) -> None:
    span = float(np.nanmax(pixels) - np.nanmin(pixels)) if np.isfinite(pixels).any() else 0.0
    step = span / int(rng.integers(1, 8)) or 1.0
    np.round(pixels / step, out=pixels)


DAMAGES = {
    "holes": _holes, "stripe": _stripe, "corner": _corner, "fill": _fill, "clip": _clip,
    "flat": _flat, "scale": _scale, "few levels": _few_levels,
}  # fmt: skip


def region_of(draw: Draw, rng: np.random.Generator) -> Box | Region:
    """The box, or a random polygon about its middle."""
    box = Box(*draw.box)
    if draw.shape == "box":
        return box
    corners = int(rng.integers(3, 9))
    angle = np.sort(rng.uniform(0, 2 * np.pi, corners))
    reach = rng.uniform(0.2, 1.0, corners)
    middle = np.array([box.row + box.height / 2, box.col + box.width / 2])
    half = 0.5 * np.array([box.height, box.width])
    return Region(middle + half * reach[:, None] * np.stack([np.sin(angle), np.cos(angle)], 1))


def measured(draw: Draw, rng: np.random.Generator) -> Any:
    """What the library makes of a draw."""
    image: Any = opened(draw.paths[0], draw.band)
    roi: Any = region_of(draw, rng)
    if draw.damage != "none":
        inside = Box(*draw.box).intersection(Box.whole(image.shape))
        if inside is not None:
            pixels = whole_pixels(draw.paths[0], draw.band).copy()
            damaged = pixels[inside.slices].copy()
            DAMAGES[draw.damage](damaged, rng)
            pixels[inside.slices] = damaged
            image = Image.from_array(pixels)
    kind = kind_of(draw.kind)
    name = kind.measure_all if draw.kind == "edges" else kind.measure
    images = [image, *(opened(path, 1) for path in draw.paths[1:])]
    options = kind.load(kind.options)(**draw.options)
    return kind.load(str(name))(
        *images, roi=roi, method=draw.method, options=options, **draw.arguments
    )


def outcome(number: int, folder: str, seed: int) -> dict[str, Any]:
    """Measure a draw and write it down; nothing it raises ends the run."""
    draw, rng = draw_number(number, folder, seed)
    began = time.process_time()
    found = {"number": number, "kind": draw.kind, "method": draw.method}
    signal.setitimer(signal.ITIMER_PROF, MAX_SECONDS)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            result = measured(draw, rng)
            report.text(result)
            report.json_text(report.document(result))
            verdicts = _verdicts(draw, result)
            if verdicts and number % PAGE_EVERY == 0:
                report.page(result)
        end = {"measured": verdicts}
    except AcutanceError as error:
        end = {"refused": type(error).__name__, "reason": str(error)}
    except Exception as error:
        end = {
            "crashed": f"{type(error).__name__}: {error}",
            "place": _place(error),
            "repeat": repeating(draw, number, folder, seed),
        }
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    return {**found, **end, "seconds": round(time.process_time() - began, 2)}


def _stop(number: int, frame: Any) -> None:
    raise TimeoutError(f"it takes more than {MAX_SECONDS} s of processor time")


def _verdicts(draw: Draw, result: Any) -> list[str]:
    every = result.measurements if draw.kind == "edges" else [result]
    return [one.verdict.word for one in every]


def _place(error: Exception) -> str:
    """The line of the package in which an exception was raised."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if "acutance" in Path(frame.filename).parts] or frames
    return f"{Path(own[-1].filename).name}:{own[-1].lineno} in {own[-1].name}"


def repeating(draw: Draw, number: int, folder: str, seed: int) -> str:
    """A command that measures a draw again: of the program, where the pixels are as in the file."""
    again = f"python benchmarks/fuzz.py {shlex.quote(folder)} --seed {seed} --first {number}"
    again += " --draws 1"
    if draw.damage != "none" or draw.shape != "box":
        return again
    words = ["acutance", draw.kind, *draw.paths, "--band", str(draw.band)]
    words += ["--roi=" + ",".join(map(str, draw.box)), "--method", draw.method]
    if draw.kind == "edges":
        words[1:2] = ["edge", "--all"]
    given = {**draw.arguments, **draw.options}
    if given.pop("fit_width", True) is False:
        words.append("--hold-width")
    if given.pop("robust", True) is False:
        words.append("--no-robust")
    for name, value in given.items():
        if value is not None:
            words += [f"--{name.replace('_', '-')}", str(value)]
    return f"{shlex.join(words)}\n{again}"


def outcome_table(outcomes: Iterable[Mapping[str, Any]]) -> str:
    """How the draws of every method ended."""
    rows = []
    groups: dict[tuple[str, str], list[Mapping[str, Any]]] = {}
    for one in outcomes:
        groups.setdefault((one["kind"], one["method"]), []).append(one)
    for (kind, method), own in sorted(groups.items()):
        words = Counter(word for one in own for word in one.get("measured", ()))
        refused = sum("refused" in one for one in own)
        crashed = sum("crashed" in one for one in own)
        slowest = max(one["seconds"] for one in own)
        rows.append([
            f"{kind}, {method}", str(len(own)), *(str(words[word]) for word in VERDICTS),
            str(refused), str(crashed), f"{slowest:.1f}",
        ])  # fmt: skip
    head = ["method", "draws", *VERDICTS, "refused", "crashed", "slowest / s"]
    return table(head, rows)


def refusal_table(outcomes: Iterable[Mapping[str, Any]]) -> str:
    """Refusals by the class of their error."""
    classes = Counter(one["refused"] for one in outcomes if "refused" in one)
    return table(["refused by", "draws"], [[name, str(n)] for name, n in classes.most_common()])


def crash_list(outcomes: Iterable[Mapping[str, Any]]) -> str:
    """Every crash with a command that repeats it."""
    crashes = [one for one in outcomes if "crashed" in one]
    return "\n\n".join(
        [f"{len(crashes)} crashes."]
        + [f"{one['crashed']} ({one['place']})\n\n```\n{one['repeat']}\n```" for one in crashes]
    )


def arguments_of() -> argparse.Namespace:
    parser = command(__doc__.partition("\n")[0], draws=1000)
    parser.add_argument("folder", help="images, in this folder and those inside it")
    parser.add_argument("--first", type=int, default=0, help="number of the first draw")
    parser.add_argument(
        "--journal", type=Path, help="keep outcomes here, and go on from those it has"
    )
    return parser.parse_args()


def kept(journal: Path | None) -> dict[int, dict[str, Any]]:
    """Outcomes of earlier runs by number."""
    if journal is None or not journal.exists():
        return {}
    lines = journal.read_text(encoding="utf-8").splitlines()
    return {one["number"]: one for one in map(json.loads, lines)}


def main() -> None:
    arguments = arguments_of()
    signal.signal(signal.SIGPROF, _stop)
    resource.setrlimit(resource.RLIMIT_AS, (MAX_BYTES, MAX_BYTES))
    outcomes = kept(arguments.journal)
    numbers = range(arguments.first, arguments.first + arguments.draws)
    for number in numbers:
        if number in outcomes:
            continue
        outcomes[number] = outcome(number, arguments.folder, arguments.seed)
        if arguments.journal is not None:
            with arguments.journal.open("a", encoding="utf-8") as file:
                file.write(json.dumps(outcomes[number]) + "\n")
        if (number + 1) % 100 == 0:
            print(f"{number + 1} of {numbers.stop}", file=sys.stderr, flush=True)
    found = list(outcomes.values())
    parts = [outcome_table(found), refusal_table(found), crash_list(found)]
    publish("Random regions of real images", parts, arguments)
    sys.exit(any("crashed" in one for one in found))


if __name__ == "__main__":
    main()
