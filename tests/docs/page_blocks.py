"""What a page has a reader paste: its blocks, in the order in which they stand.

- ``.. code-block:: console``: lines that begin with ``$`` are commands, all others what they print.
- ``.. code-block:: python``: statements; all of a page have one set of names.
- A block with ``:caption: NAME``: the file that the reader writes under that name.
- A block below the comment ``.. not run: REASON`` is for reading only.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Block", "page_blocks", "readme_blocks"]

DIRECTIVE = re.compile(r"\.\. code-block:: (?P<language>\w+)$")
NOT_RUN = re.compile(r"\.\. not run: \w")
FENCE = re.compile(r"```(?P<language>\w*)$")
COMMANDS, STATEMENTS = "console", "python"


@dataclass(frozen=True)
class Block:
    """A block to be pasted.

    Parameters
    ----------
    language : str
    first : int
        The line of the page, from 1, where `lines` begin.
    lines : tuple of str
        Without the indentation of the block.
    caption : str
        The name of the file that the block is; else empty.
    """

    language: str
    first: int
    lines: tuple[str, ...]
    caption: str = ""

    @property
    def text(self) -> str:
        """The lines as one text."""
        return "\n".join(self.lines) + "\n"

    @property
    def commands(self) -> list[tuple[int, str]]:
        """The commands of a console, each with its line of the page."""
        numbered = enumerate(self.lines, self.first)
        return [(at, line[2:]) for at, line in numbered if line.startswith("$ ")]


def page_blocks(path: Path) -> list[Block]:
    """The blocks of a page that are to be run, or written to a file."""
    lines = path.read_text(encoding="utf-8").splitlines()
    found = []
    for at, line in enumerate(lines):
        directive = DIRECTIVE.match(line)
        if directive and not any(NOT_RUN.match(above) for above in lines[max(at - 2, 0) : at]):
            found.append(_block(directive["language"], lines, at + 1))
    runs = (COMMANDS, STATEMENTS)
    return [block for block in found if block.language in runs or block.caption]


def readme_blocks(path: Path) -> list[Block]:
    """The blocks of the README: of commands without a prompt, and of Python."""
    lines = path.read_text(encoding="utf-8").splitlines()
    fences = [at for at, line in enumerate(lines) if line.startswith("```")]
    found = []
    for begin, end in zip(fences[::2], fences[1::2], strict=True):
        language = FENCE.match(lines[begin])["language"] or COMMANDS
        inside = lines[begin + 1 : end]
        if language == COMMANDS:
            inside = [f"$ {line}" if line else line for line in inside]
        # A clone of the repository is not what a reader has.
        if not any(line.startswith(("$ make ", "$ python ")) for line in inside):
            found.append(Block(language, begin + 2, tuple(inside)))
    return found


def _block(language: str, lines: list[str], after: int) -> Block:
    """The indented lines below a directive, and its option ``:caption:``."""
    end = after
    while end < len(lines) and (not lines[end] or lines[end].startswith("   ")):
        end += 1
    caption, first = "", after
    while first < end and (not lines[first] or lines[first].lstrip().startswith(":")):
        if lines[first].lstrip().startswith(":caption:"):
            caption = lines[first].split(":caption:")[1].strip()
        first += 1
    inside = [line[3:] for line in lines[first:end]]
    while inside and not inside[-1]:
        inside.pop()
    return Block(language, first + 1, tuple(inside), caption)
