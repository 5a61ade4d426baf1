"""The first start compiles loops for half a minute: commands say so once, and later ones do not."""

import subprocess
import sys

PROGRAM = """
import numpy as np

from acutance.cli.terminal import log_said
from acutance.numerics.scalar_product import scalar_product

with log_said():
    for kind in {kinds}:
        scalar_product(np.ones(3, kind), np.ones(3, kind))
print("done")
"""
LINE = "acutance: compiling loops once, some 30 s; later starts load them"


def test_the_first_compilation_is_told_once(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    told = []
    # Other types of a loop that is there are compiled in a moment.
    for kinds in (["f8", "f4"], ["f8"], ["i8"]):
        words = [sys.executable, "-c", PROGRAM.format(kinds=kinds)]
        done = subprocess.run(words, capture_output=True, text=True, check=True)
        assert done.stdout == "done\n"
        told.append(done.stderr.splitlines())
    assert told == [[LINE], [], []]
