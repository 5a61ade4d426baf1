"""Places of faults in documents are those that their authors count."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, ValidationError

from acutance.raster.document_faults import document_faults


class _Item(BaseModel):
    model_config = ConfigDict(extra="forbid")
    name: str | None = None
    sides: float | list[float] | None = None


class _Document(BaseModel):
    names: str | list[str] = ""
    item: list[_Item] = []


def faults_of(document):
    try:
        _Document.model_validate(document)
    except ValidationError as error:
        return [(one.place, one.message) for one in document_faults(error, document)]
    return []


def test_entries_count_from_one_and_have_their_names():
    places = [place for place, _ in faults_of({
        "item": [{"name": "first"}, {"name": "tarp", "colour": 1}, {"sides": [1, 2, "x"]}]
    })]  # fmt: skip
    assert places == ["item 2 (tarp), colour", "item 3, sides 3"]


def test_types_that_were_tried_are_no_places():
    """A list with a wrong entry is not said to be no text; a wrong value is named once."""
    assert [place for place, _ in faults_of({"names": ["a", 5]})] == ["names 2"]
    ((place, message),) = faults_of({"names": 5})
    assert place == "names"
    assert "string, or Input should be a valid list" in message
