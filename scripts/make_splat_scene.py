#!/usr/bin/env python3
"""Writes a large 3DGS PLY file: copies of a small one on a square lattice, with jitter and shades.

    ghostspace export biker.compressed.ply biker.3dgs.ply
    scripts/make_splat_scene.py biker.3dgs.ply 10000000 large.ply [--degree 3]

The input must be binary and have only float properties, as the exports have. With --degree, splats get random
coefficients of spherical harmonics. Equal arguments give equal files.
"""
import argparse
import array
import math
import random


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("input")
    parser.add_argument("splats", type=int)
    parser.add_argument("output")
    parser.add_argument("--degree", type=int, default=0, choices=range(4))
    options = parser.parse_args()
    data = open(options.input, "rb").read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    lines = data[:end].decode().splitlines()
    names = [line.split()[2] for line in lines if line.startswith("property float ")]
    count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex "))
    assert "format binary_little_endian 1.0" in lines and len(data) - end == 4 * len(names) * count
    rows = array.array("f", data[end:])
    columns = {name: rows[i::len(names)] for i, name in enumerate(names) if not name.startswith("f_rest_")}
    more = ["f_rest_%d" % i for i in range(3 * ((options.degree + 1) ** 2 - 1))]
    order = list(columns) + more
    place = {name: i for i, name in enumerate(order)}
    extent = {}
    for name in "xyz":
        values = sorted(columns[name])
        extent[name] = values[-1 - count // 100] - values[count // 100]
    step = 0.8 * max(extent["x"], extent["z"])
    copies = -(-options.splats // count)
    edge = math.ceil(math.sqrt(copies))
    numbers = random.Random(1)
    harmonics = {name: array.array("f", [numbers.gauss(0, 0.05) for _ in range(count)]) for name in more}
    with open(options.output, "wb") as out:
        out.write(("ply\nformat binary_little_endian 1.0\nelement vertex %d\n%send_header\n" %
                   (options.splats, "".join("property float %s\n" % name for name in order))).encode())
        for copy in range(copies):
            part = array.array("f", bytes(4 * len(order) * count))
            shift = {"x": (copy % edge) * step, "z": (copy // edge) * step, "y": 0.0}
            for name in order:
                source = columns.get(name) or harmonics[name]
                if name in shift:
                    jitter, offset = 0.001 * extent[name], shift[name]
                    source = array.array("f", [v + offset + jitter * (numbers.random() - 0.5) for v in source])
                elif name.startswith("f_dc_"):
                    shade = 0.3 * (numbers.random() - 0.5)
                    source = array.array("f", [v + shade for v in source])
                part[place[name]::len(order)] = source
            left = min(count, options.splats - copy * count)
            out.write(part[:left * len(order)].tobytes())


main()
