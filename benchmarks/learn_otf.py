"""Learn the prior of two-dimensional transfer functions from sensors drawn at random, and keep it.

Example: python benchmarks/learn_otf.py --sensors 400 --out otf_families.npz
The file lies beside numerics/otf_families.py.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from acutance.numerics.learn_kernels import learn_kernels
from acutance.numerics.learn_otf import learn_families, write_families


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--sensors", type=int, default=400, help="sensors a family")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    directions = learn_families(arguments.sensors, arguments.seed)
    kernels = learn_kernels(arguments.sensors, arguments.seed)
    write_families(arguments.out, directions, kernels)
    for name, columns in directions.items():
        print(f"{name}: {columns.shape[1]} directions")
    print(f"kernels: {kernels.shape[2]} directions")


if __name__ == "__main__":
    main()
