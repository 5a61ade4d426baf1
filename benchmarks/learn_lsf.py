"""Learn the priors of line spread functions from sensors drawn at random, and keep them.

Example: python benchmarks/learn_lsf.py --sensors 1700 --out lsf_families.npz --density sensors.npz
Both files lie in targets/straight: lsf_prior.py reads the first, sensor_density.py the second.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from acutance.targets.straight.learn_lsf import (
    DENSITY_COUNTS,
    draw_density,
    learn,
    write,
    write_density,
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--sensors", type=int, default=1700, help="sensors a family (--out)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="file of principal directions")
    parser.add_argument("--density", type=Path, help="file of the density of sensors")
    arguments = parser.parse_args()
    if arguments.out is None and arguments.density is None:
        parser.error("give --out, --density or both: the files to write")
    if arguments.out is not None:
        directions = learn(arguments.sensors, arguments.seed)
        write(arguments.out, directions)
        for name, columns in directions.items():
            print(f"{name}: {columns.shape[1]} directions")
    if arguments.density is not None:
        density = draw_density(DENSITY_COUNTS, arguments.seed)
        write_density(arguments.density, density)
        print(f"{sum(DENSITY_COUNTS.values())} sensors, {density['basis'].shape[1]} coordinates")


if __name__ == "__main__":
    main()
