"""Learn the prior of line spread functions from sensors drawn at random, and keep it.

Example: python benchmarks/learn_lsf.py --sensors 1700 --out lsf_families.npz
The file lies beside targets/straight/lsf_prior.py.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from acutance.targets.straight.learn_lsf import learn, write


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--sensors", type=int, default=1700, help="sensors a family")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    directions = learn(arguments.sensors, arguments.seed)
    write(arguments.out, directions)
    for name, columns in directions.items():
        print(f"{name}: {columns.shape[1]} directions")


if __name__ == "__main__":
    main()
