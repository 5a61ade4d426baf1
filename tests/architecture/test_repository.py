"""What the repository holds at its root."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXPECTED = {".gitignore", "CHANGELOG.md", "LICENSE", "Makefile", "README.md", "pyproject.toml"}
"""Files at the root, beside folders."""


def test_no_leftovers_of_a_run_are_kept() -> None:
    """Pickles and scratch files of one's own session do not belong to a clone."""
    try:
        found = subprocess.run(
            ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
        ).stdout.splitlines()
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a clone: there is nothing to list")
    assert {name for name in found if "/" not in name} <= EXPECTED
    assert not [name for name in found if name.endswith((".pkl", ".pickle", ".pyc", ".orig"))]
