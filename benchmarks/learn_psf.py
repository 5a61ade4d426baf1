"""Learn the prior of point spread functions from sensors drawn at random, and keep it.

Example: python benchmarks/learn_psf.py --sensors 250 --out psf_families.npz
The file lies beside targets/points/psf_families.py.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from acutance.targets.points.learn_psf import learn, write


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--sensors", type=int, default=250, help="sensors a family")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    directions = learn(arguments.sensors, arguments.seed)
    write(arguments.out, directions)
    for name, rows in directions.items():
        print(f"{name}: {rows.shape[0]} directions")


if __name__ == "__main__":
    main()
