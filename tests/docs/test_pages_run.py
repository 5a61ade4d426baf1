"""A reader in an empty folder pastes the blocks of a page from top to bottom, and all of them run.

What they print is compared with nothing: last digits depend on the machine. Figures and pages are
not drawn; the tests of the report draw every kind of result. Commands that take minutes are run by
``make docs``, which sets PAGES=all: those that begin as `LONG` says, and the README's.
"""

from __future__ import annotations

import glob
import os
import shlex
import subprocess
from pathlib import Path

import pytest
from page_blocks import COMMANDS, STATEMENTS, Block, page_blocks, readme_blocks

DOCS = Path(__file__).parents[2] / "docs"
README = DOCS.parent / "README.md"
ALL = os.environ.get("PAGES") == "all"
EXAMPLES = sorted((DOCS / "examples").glob("plot_*.py"))
PAGES = sorted([*DOCS.glob("*.rst"), *DOCS.glob("studies/*.rst")])
LONG = (
    "acutance demo",
    "acutance plan",
    "acutance study",
    # The blocks of Python next to them scan the same images.
    "acutance scan land.tif --report",
    "acutance scan bands.tif",
)


@pytest.fixture
def run_command(acutance):
    """Run a line of a shell; what is wrong with it is returned."""

    def run(line: str) -> str:
        if not line.startswith("acutance "):
            done = subprocess.run(line, shell=True, check=False, capture_output=True, text=True)
            return f"exit code {done.returncode}\n{done.stderr}" if done.returncode else ""
        words, out = _words(line)
        result = acutance(*words)
        if out:
            Path(out).write_bytes(result.stdout_bytes)
        if result.exit_code == 0:
            return ""
        return f"exit code {result.exit_code}\n{result.stderr}\n{result.exception!r}"

    return run


@pytest.fixture(autouse=True)
def fast(few_forms, monkeypatch):
    """Pages of reports have no content, and sensors of scenes two forms."""
    monkeypatch.setattr("acutance.report.page", lambda *result, **how: "<!DOCTYPE html>")
    with few_forms():
        yield


@pytest.fixture(autouse=True)
def empty_folder(tmp_path, monkeypatch):
    """The folder of a reader, whose cache is empty, too."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "reader").mkdir()
    monkeypatch.chdir(tmp_path / "reader")


def _words(line: str) -> tuple[list[str], str]:
    """The arguments of a command as a shell makes them, and the file that takes its output."""
    out, words = "", []
    split = shlex.shlex(line, posix=False, punctuation_chars=False)
    split.whitespace_split = True
    for word in list(split)[1:]:
        quoted = '"' in word or "'" in word
        plain = shlex.split(word)[0]
        words.extend(sorted(glob.glob(plain)) if "*" in plain and not quoted else [plain])
    if ">" in words:
        out = words.pop()
        words.remove(">")
    return words, out


def _paste(page: Path, blocks: list[Block], run_command) -> None:
    names = {"__name__": "__main__"}
    for block in blocks:
        if block.caption:
            Path(block.caption).write_text(block.text, encoding="utf-8")
        elif block.language == STATEMENTS:
            source = "\n" * (block.first - 1) + block.text
            exec(compile(source, str(page), "exec"), names)
        for at, line in block.commands if block.language == COMMANDS else []:
            if line.startswith(LONG) and not ALL:
                continue
            wrong = run_command(line)
            assert not wrong, f"{page.name}, line {at}: {line}\n{wrong}"


@pytest.mark.parametrize(
    "page", [page for page in PAGES if page_blocks(page)], ids=lambda page: page.stem
)
def test_all_blocks_of_a_page_run_from_top_to_bottom(page, run_command):
    _paste(page, page_blocks(page), run_command)


@pytest.mark.skipif(not ALL, reason="takes minutes: make docs runs it, with PAGES=all")
def test_the_readme_runs_from_top_to_bottom(run_command):
    _paste(README, readme_blocks(README), run_command)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_python_stands_in_blocks_that_are_run(page):
    assert ">>>" not in page.read_text(encoding="utf-8"), "write a block of Python instead"


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda script: script.stem)
def test_an_example_that_is_run_alone_ends_with_its_figure_as_a_file(script):
    *_, saved, told = script.read_text(encoding="utf-8").splitlines()
    assert saved.startswith("figure.savefig(")
    assert told.startswith('print("wrote ')
