"""Requirements: read from TOML, judged with probabilities that are true."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import acutance as ac
from acutance.archive.requirement_answers import Answer, SpecificationCheck
from acutance.archive.specification import Requirement, Specification, read_specification
from acutance.archive.specification_check import check_requirement
from acutance.archive.trends import Series
from acutance.archive.trends.fit_trend import fit_trend
from acutance.archive.trends.series import date_of

DRAWS = 120


def series(
    seed: int, *, images: int = 10, scatter: float = 0.03, std: float = 0.01, days: bool = True
) -> Series:
    """A steady sensor whose MTF at Nyquist is .1."""
    rng = np.random.default_rng(seed)
    when = 2022 + np.sort(rng.uniform(0, 2, images)) if days else np.full(images, np.nan)
    value = 0.1 * (1 + scatter * rng.normal(size=images) + std * rng.normal(size=images))
    return Series(
        metric="mtf_nyquist", name="S1", when=when, value=value,
        std=np.full(images, 0.1 * std), image=np.arange(images),
    )  # fmt: skip


def stepped(made: Series, size: float) -> Series:
    """The same with a step before its last seven images."""
    value = made.value + size * (np.arange(made.size) >= made.size - 7)
    return replace(made, value=value)


def at_least(limit: float, **changes: object) -> Requirement:
    return Requirement(metric="mtf_nyquist", minimum=limit, **changes)  # type: ignore[arg-type]


def test_probabilities_are_true() -> None:
    """Deviations 0.8 or 1.25 times the true ones leave these bounds."""
    rng = np.random.default_rng(5)
    squares, said, right = [], 0, 0
    for seed in range(DRAWS):
        limit = 0.1 * (1 + rng.uniform(-0.04, 0.04))
        found = check_requirement(at_least(limit), series(seed))
        assert found.mean is not None
        squares.append(((found.mean.value - 0.1) / found.mean.std) ** 2)
        if found.word != "cannot be told yet":
            said += 1
            right += (found.word == "met") == (limit <= 0.1)
    scatter = np.sqrt(np.mean(squares))
    assert 0.84 < scatter < 1.08
    assert scatter / 0.8 > 1.08
    assert scatter / 1.25 < 0.84
    assert said > DRAWS / 4
    assert right / said > 0.95


def test_the_three_words() -> None:
    made = series(1, images=20)
    met, missed, near = (check_requirement(at_least(one), made) for one in (0.09, 0.11, 0.1))
    assert (met.word, missed.word, near.word) == ("met", "not met", "cannot be told yet")
    assert met.more_images == 0
    assert met.probability is not None
    assert met.probability > 0.99
    below = check_requirement(Requirement(metric="mtf_nyquist", maximum=0.09), made)
    assert below.word == "not met"
    assert below.probability == pytest.approx(1 - met.probability)
    assert "is met (probability of being met > 0.999)" in met.summary
    json.dumps([one.to_dict() for one in (met, missed, near, below)], allow_nan=False)


@pytest.mark.parametrize(
    ("made", "why"),
    [
        # Among so few images no step is sought.
        (series(1, images=3), "leave open how much they scatter"),
        (series(1, images=12), "leave open how much they scatter"),
        (stepped(series(3, images=24), 0.006), "a step is probable"),
    ],
    ids=["3", "12", "step"],
)
def test_a_probability_that_seems_to_contradict_the_mean_is_explained(
    made: Series, why: str
) -> None:
    density = fit_trend(made).mean(float(made.when[-1]), season=False)
    middle, median = density.estimate(0.0).value, density.quantile(0.5)
    assert abs(middle - median) > 1e-9
    between = check_requirement(at_least(0.5 * (middle + median)), made)
    assert between.probability is not None
    assert (between.probability > 0.5) == (median > middle)
    assert "the density is skewed" in between.summary
    assert why in between.summary
    beside = check_requirement(at_least(0.5 * (middle + median) - 0.01), made)
    assert "skewed" not in beside.summary


def test_so_many_more_images_would_tell() -> None:
    few = series(3, images=8, scatter=0.04)
    found = check_requirement(at_least(0.097), few)
    assert found.word == "cannot be told yet"
    assert found.more_images is not None
    assert 3 <= found.more_images <= 500
    assert f"About {found.more_images} more images would tell." in found.summary


def test_what_is_shared_cannot_be_averaged_out() -> None:
    made = series(3, images=40)
    shared = Series(**{**vars(made), "systematic_std": np.full(made.size, 0.005)})
    found = check_requirement(at_least(0.098), shared)
    assert found.word == "cannot be told yet"
    assert found.more_images is None
    assert "More images alone would not tell" in found.summary


def test_without_dates_the_mean_stands_in() -> None:
    found = check_requirement(at_least(0.09), series(1, days=False))
    assert found.word == "met"
    assert found.day is None
    assert "the mean of the images stands in" in found.summary


def test_the_interval_written_is_that_of_the_probability() -> None:
    """A deviation would be read with a normal density; of three images the tails are longer."""
    made = series(1, images=3, days=False)
    found = check_requirement(at_least(0.09), made)
    assert found.mean is not None
    low, high = found.mean.interval(0.95)
    edge = check_requirement(at_least(low), made)
    assert edge.probability == pytest.approx(0.975, abs=0.002)
    assert "±" not in found.summary
    words = re.search(r"\(95 %: ([\d.]+) to ([\d.]+)\)", found.summary)
    assert words is not None
    assert [float(one) for one in words.groups()] == pytest.approx([low, high], abs=0.0006)


def test_a_level_without_its_season_says_so() -> None:
    made = series(1, images=40)
    seasonal = replace(made, value=made.value + 0.01 * np.cos(2 * np.pi * made.when))
    assert "of which the level is free" in check_requirement(at_least(0.09), seasonal).summary
    assert "season" not in check_requirement(at_least(0.09), made).summary


def test_one_image_tells_nothing() -> None:
    found = check_requirement(at_least(0.01), series(1, images=1))
    assert (found.word, found.probability) == ("cannot be told yet", None)
    assert "there is one image with a measurement that is usable or better" in found.summary


def test_a_window_leaves_out_what_is_older() -> None:
    made = series(1, images=40)
    found = check_requirement(at_least(0.09, window_days=180), made)
    inside = np.count_nonzero(made.when >= made.when.max() - 180 / 365.25)
    assert found.images == inside < 40


def test_the_day_asked_is_the_day_of_the_answer() -> None:
    found = check_requirement(at_least(0.09, on="2023-06-01"), series(1))
    assert str(found.day) == "2023-06-01"


def test_a_file_of_requirements(tmp_path: Path) -> None:
    path = tmp_path / "spec.toml"
    path.write_text(
        'title = "T"\n[[requirement]]\nmetric = "rer"\nminimum = 0.4\nband = ["pan", "blue"]\n'
        'orientation = "across"\nconfidence = 0.9\nsince = 2023-01-01\n'
    )
    (found,) = read_specification(path).requirement
    assert found.sentence == "rer >= 0.4"
    assert found.selection["band"] == ["pan", "blue"]
    assert found.selection["verdict"] == "usable"
    assert str(found.selection["since"]) == "2023-01-01"


def test_all_that_is_wrong_is_named_at_once(tmp_path: Path) -> None:
    path = tmp_path / "spec.toml"
    path.write_text(
        'titel = "T"\n[[requirement]]\nmetric = "mtf"\nminimum = 1\nlimits = 2\n'
        '[[requirement]]\nname = "second"\nmetric = "rer"\n'
    )
    with pytest.raises(ac.OptionError) as error:
        read_specification(path)
    for part in ("titel: is no key", "requirement 1, limits: is no key", "'mtf' is none of",
                 "requirement 2 (second): give a minimum or a maximum"):  # fmt: skip
        assert part in str(error.value)


def test_files_that_are_no_specification(tmp_path: Path) -> None:
    with pytest.raises(ac.OptionError, match="cannot be read"):
        read_specification(tmp_path / "missing.toml")
    with pytest.raises(ac.OptionError, match=r"of type dict: .*Specification\.of\(document\)"):
        ac.Archive(tmp_path / "kept.db").check({"requirement": []})  # type: ignore[arg-type]
    path = tmp_path / "spec.toml"
    path.write_text("requirement = [")
    with pytest.raises(ac.OptionError, match="is no TOML"):
        read_specification(path)
    for empty in ({}, {"title": "T"}, {"requirement": []}):
        with pytest.raises(ac.OptionError, match=r"there is no requirement in it: write \[\[req"):
            Specification.of(empty)
    path.write_text("")
    with pytest.raises(ac.OptionError, match=r"spec\.toml: there is no requirement in it: .*0\.09"):
        read_specification(path)
    with pytest.raises(ac.OptionError, match=r"requirement 1, metric: is missing: write metric ="):
        Specification.of({"requirement": [{"minimum": 0.3}]})
    with pytest.raises(ac.OptionError, match=r"write \[\[requirement\]\]"):
        Specification.of({"requirement": {"metric": "rer", "minimum": 0.3}})


def test_on_a_day_far_from_the_images_no_number_of_images_is_told() -> None:
    """It would depend on when they are taken."""
    made = series(1, scatter=0.05)
    found = check_requirement(at_least(0.08, on="2040-01-01"), made)
    assert found.word == "cannot be told yet"
    assert found.more_images is None
    assert found.nearest == date_of(float(made.when.max()))
    assert f"The nearest image is of {found.nearest}" in found.summary
    assert "would tell" not in found.summary
    inside = check_requirement(at_least(0.1, on="2023-01-01"), made)
    assert (inside.word, inside.nearest) == ("cannot be told yet", None)


@pytest.mark.parametrize(
    ("key", "value"),
    [("minimum", '"0.2"'), ("minimum", "true"), ("minimum", "nan"), ("window_days", '"365"'),
     ("confidence", '"0.9"')],
)  # fmt: skip
def test_a_number_is_no_text(tmp_path: Path, key: str, value: str) -> None:
    lines = {"metric": '"rer"', "minimum": "0.4"} | {key: value}
    path = tmp_path / "spec.toml"
    path.write_text("\n".join(["[[requirement]]", *map(" = ".join, lines.items())]))
    with pytest.raises(ac.OptionError, match=rf"requirement 1, {key}: input should be a .*number"):
        read_specification(path)


def test_a_note_that_several_answers_have_stands_once() -> None:
    across, along = (
        Answer(at_least(0.09), f"S1, {name}", "met", 0.99, ac.Estimate(0.1, 0.001), None, 9, 0,
               reason="A season.", notes=("No band is named.", f"Only {name}."))
        for name in ("across", "along")
    )  # fmt: skip
    assert across.summary.endswith("9 images. A season. No band is named. Only across.")
    assert across.judgement.endswith("9 images. A season.")
    assert across.to_dict()["notes"] == ["No band is named.", "Only across."]
    unread = Answer(at_least(0.09), "S1", "cannot be told yet", None, None, None, 0, 3, "no image")
    assert SpecificationCheck("", (across, along, unread)).notes == (
        "No band is named.",
        "S1, across, mtf_nyquist: Only across.",
        "S1, along, mtf_nyquist: Only along.",
    )
