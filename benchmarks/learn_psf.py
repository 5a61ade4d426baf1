"""Learn the priors of point spread functions from sensors drawn at random, and keep them.

Example: python benchmarks/learn_psf.py --sensors 250 --out psf_families.npz
Then: python benchmarks/learn_psf.py --seed 7 --density psf_sensors.npz
Both files lie in targets/points: psf_families.py reads the first, sensor_density.py the second,
which builds on the first. More sensors of a family, or of a new one, come into a density there is:
python benchmarks/learn_psf.py --seed 21 --density psf_sensors.npz --more scatter 600
"""

from __future__ import annotations

import argparse
from pathlib import Path

from learn_lsf import kept_density

from acutance.targets.points.learn_psf import learn, write
from acutance.targets.points.learn_sensors import (
    DENSITY_COUNTS,
    density,
    draw_departures,
    with_more,
    write_density,
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--sensors", type=int, default=250, help="sensors a family (--out)")
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
        for name, rows in directions.items():
            print(f"{name}: {rows.shape[0]} directions")
    if arguments.density is not None:
        more = arguments.more is not None
        counts = {arguments.more[0]: int(arguments.more[1])} if more else DENSITY_COUNTS
        drawn = draw_departures(counts, arguments.seed)
        found = with_more(kept_density(arguments.density), drawn) if more else density(drawn)
        write_density(arguments.density, found)
        print(f"{sum(counts.values())} sensors")


if __name__ == "__main__":
    main()
