"""The answers to the requirements of a specification, each in a sentence."""

from __future__ import annotations

import datetime
from dataclasses import dataclass
from typing import Any

from acutance.archive.counted import counted
from acutance.archive.specification import Requirement
from acutance.curves import Estimate
from acutance.targets.conformity import MET, NOT_MET, OPEN, written_probability

__all__ = ["Answer", "SpecificationCheck"]


@dataclass(frozen=True)
class Answer:
    """What is known of a requirement.

    Attributes
    ----------
    requirement : Requirement
    what : str
        Whose it is: "QB02, pan, across".
    word : {"met", "not met", "cannot be told yet"}
    probability : float or None
        That it is met; ``None`` where nothing can be said.
    mean : Estimate or None
        The sensor's mean on the day.
    day : date or None
    images : int
    more_images : int or None
        How many more would tell, if the mean is what it is now; 0 where it is told, ``None`` where
        none of a reasonable number would, or where the day asked is before or after all images.
    nearest : date or None
        Where the day asked is before the first or after the last image: the day of that image.
    reason : str
        Why it cannot be told, or what to know of it.
    notes : tuple of str
        What to know of the images that were judged; other answers may have the same.
    """

    requirement: Requirement
    what: str
    word: str
    probability: float | None
    mean: Estimate | None
    day: datetime.date | None
    images: int
    more_images: int | None
    reason: str = ""
    nearest: datetime.date | None = None
    notes: tuple[str, ...] = ()

    @property
    def summary(self) -> str:
        """The answer, and what to know of the images that were judged."""
        return " ".join((self.judgement, *self.notes))

    @property
    def judgement(self) -> str:
        """The answer alone, where the notes of several answers stand elsewhere."""
        what = f"{self.what}: " if self.what else ""
        asked = self.requirement.sentence
        if self.mean is None or self.probability is None:
            return f"{what}{asked} {self.word}: {self.reason}."
        text = (
            f"{what}{asked} is {self.word}" if self.word != OPEN else f"{what}{asked} {self.word}"
        )
        chance = written_probability(self.probability)
        text += f" (probability of being met {chance}): {_interval(self.mean)}"
        if self.day is not None:
            text += f" on {self.day}"
        text += f", {counted(self.images, 'image')}."
        if self.word == OPEN:
            text += f" {self.advice}"
        return f"{text} {self.reason}".rstrip()

    @property
    def advice(self) -> str:
        """How many more images would tell."""
        if self.nearest is not None:
            return (
                f"The nearest image is of {self.nearest}: until there are some of about "
                f"{self.day}, the drift is continued, and the deviation grows with it."
            )
        if self.more_images is None:
            return "More images alone would not tell: the mean is too near the limit."
        count = self.more_images
        return f"About {counted(count, 'more image')} would tell."

    @property
    def name(self) -> str:
        """Whose requirement it is, and of which number: "QB02, across, mtf_nyquist"."""
        return ", ".join(filter(None, (self.what, self.requirement.metric)))

    def to_dict(self) -> dict[str, Any]:
        """All fields for JSON; the requirement as it was written."""
        return {
            "requirement": self.requirement.model_dump(mode="json", exclude_none=True),
            "what": self.what,
            "word": self.word,
            "probability": self.probability,
            "mean": None if self.mean is None else self.mean.to_dict(),
            "day": None if self.day is None else self.day.isoformat(),
            "images": self.images,
            "more_images": self.more_images,
            "nearest": None if self.nearest is None else self.nearest.isoformat(),
            "notes": list(self.notes),
            "summary": self.summary,
        }


@dataclass(frozen=True)
class SpecificationCheck:
    """The answers to all requirements of a specification.

    Attributes
    ----------
    title : str
    answers : tuple of Answer
        In the order of the requirements; one for each sensor, band, level and direction that a
        requirement does not choose between. A direction that was not measured has one, too.
    """

    title: str
    answers: tuple[Answer, ...]

    @property
    def word(self) -> str:
        """Of the whole: not met if one is not met, met if all are, else it cannot be told yet."""
        words = {answer.word for answer in self.answers}
        if NOT_MET in words:
            return NOT_MET
        return MET if words == {MET} else OPEN

    @property
    def notes(self) -> tuple[str, ...]:
        """The notes of all answers, each once, with whose it is unless it is of all."""
        judged = [answer for answer in self.answers if answer.mean is not None]
        whose: dict[str, list[str]] = {}
        for answer in judged:
            for note in answer.notes:
                whose.setdefault(note, []).append(answer.name)
        return tuple(
            note if len(names) == len(judged) else f"{'; '.join(names)}: {note}"
            for note, names in whose.items()
        )

    @property
    def summary(self) -> str:
        """The word, and how many answers are of each."""
        counts = {word: sum(answer.word == word for answer in self.answers)
                  for word in (MET, NOT_MET, OPEN)}  # fmt: skip
        listed = ", ".join(f"{count} {word}" for word, count in counts.items() if count)
        return f"{self.title or 'The specification'}: {self.word} ({listed})"

    def to_dict(self) -> dict[str, Any]:
        """Title, word and all answers for JSON."""
        return {
            "schema": "acutance/specification-check/1",
            "title": self.title,
            "word": self.word,
            "summary": self.summary,
            "answers": [answer.to_dict() for answer in self.answers],
        }


def _interval(mean: Estimate) -> str:
    """A mean with its 95 % interval, which is that of the density the probability is of.

    A deviation would be read with a normal density, whose tails are shorter than Student's.
    """
    value, _, std = str(mean).partition(" ± ")
    if not std:
        return value
    digits = len(value.partition(".")[2])
    low, high = mean.interval(0.95)
    return f"{value} (95 %: {low:.{digits}f} to {high:.{digits}f})"
