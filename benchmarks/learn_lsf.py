"""Learn the priors of line spread functions from sensors drawn at random, and keep them.

Example: python benchmarks/learn_lsf.py --sensors 1700 --out lsf_families.npz --density sensors.npz
Both files lie in targets/straight: lsf_prior.py reads the first, sensor_density.py the second.
A new family comes into a density there is:
python benchmarks/learn_lsf.py --seed 31 --density sensors.npz --more peaked 800
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from acutance.targets.straight.learn_lsf import (
    DENSITY_COUNTS,
    draw_density,
    learn,
    with_more,
    write,
    write_density,
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--sensors", type=int, default=1700, help="sensors a family (--out)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="file of principal directions")
    parser.add_argument("--density", type=Path, help="file of the density of sensors")
    parser.add_argument("--more", nargs=2, metavar=("FAMILY", "COUNT"), help="into --density")
    arguments = parser.parse_args()
    if arguments.out is None and arguments.density is None:
        parser.error("give --out, --density or both: the files to write")
    if arguments.out is not None:
        directions = learn(arguments.sensors, arguments.seed)
        write(arguments.out, directions)
        for name, columns in directions.items():
            print(f"{name}: {columns.shape[1]} directions")
    if arguments.density is not None:
        if arguments.more is not None:
            family, count = arguments.more
            kept = kept_density(arguments.density)
            density = with_more(kept, family, int(count), arguments.seed)
        else:
            density = draw_density(DENSITY_COUNTS, arguments.seed)
        write_density(arguments.density, density)
        sensors = sum(len(rows) for name, rows in density.items() if name != "basis")
        print(f"{sensors} sensors, {density['basis'].shape[1]} coordinates")


def kept_density(path: Path) -> dict[str, np.ndarray]:
    """The arrays of a file of the density."""
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name].astype(float) for name in file.files}


if __name__ == "__main__":
    main()
