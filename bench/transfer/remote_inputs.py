#!/usr/bin/env python3
"""Writes inputs for remote_session.py and remote_peers.py, always with the same bytes.

usage: remote_inputs.py FOLDER [--side 640] [--image-side 768]

  simulation.h5    float32, SIDE voxels per axis, one contiguous dataset `density` (640: 1.05 GB)
  simulation.nrrd  the same voxels
  simulation.vti   the same voxels as VTK XML with raw appended data, for ParaView
  image.zarr       OME-Zarr 0.4 with four levels of 16 bits, chunks of 64 voxels per axis, Zstandard

The field of the simulation has six octaves of noise with the spectrum of turbulence, a wrinkled shock front and 40 bubbles with
sharp borders. Needs python3-numpy, python3-h5py and python3-zarr.
"""
import argparse
import json
import os
import pathlib

import numpy as np

SEED = 20260639
SLAB = 16


def spline_matrix(side, cells):
    """Returns the weights of a uniform cubic B-spline with `cells` intervals at `side` positions."""
    at = np.arange(side) * cells / side
    first = np.minimum(at.astype(int), cells - 1)
    t = at - first
    weights = np.stack([(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3]) / 6
    matrix = np.zeros((side, cells + 3), np.float32)
    for k in range(4):
        matrix[np.arange(side), first + k] = weights[k]
    return matrix


class Field:
    """Scalar field in the unit cube, evaluated in slabs of planes of z."""

    def __init__(self, side):
        random = np.random.default_rng(SEED)
        self.side = side
        self.octaves = []
        for cells in (4, 8, 16, 32, 64, 128):
            noise = random.standard_normal((cells + 3,) * 3).astype(np.float32)
            self.octaves.append((spline_matrix(side, cells), noise * np.float32(0.35 * (4 / cells) ** (1 / 3) * 1.6)))
        self.front = spline_matrix(side, 12), random.standard_normal((15, 15)).astype(np.float32) * 0.06
        self.bubbles = [(random.uniform(0.1, 0.9, 3), random.uniform(0.02, 0.07), random.uniform(-0.6, 0.9))
                        for _ in range(40)]

    def slab(self, start, stop):
        total = np.zeros((stop - start, self.side, self.side), np.float32)
        for matrix, noise in self.octaves:
            planes = np.tensordot(matrix[start:stop], noise, 1)
            for i, plane in enumerate(planes):
                total[i] += matrix @ plane @ matrix.T
        axis = (np.arange(self.side, dtype=np.float32) + 0.5) / self.side
        matrix, noise = self.front
        front = 0.55 + matrix @ noise @ matrix.T
        depth = axis[start:stop, None, None] - front[None]
        # Density rises by a step at the front and falls off slowly behind it.
        total *= np.where(depth < 0, np.float32(1), np.float32(0.4))
        total += np.where(depth < 0, 1.4 * np.exp(depth * 2.5), 0).astype(np.float32)
        for centre, radius, change in self.bubbles:
            z = axis[start:stop] - centre[0]
            if abs(z).min() > radius:
                continue
            square = (z**2)[:, None, None] + ((axis - centre[1]) ** 2)[None, :, None] + ((axis - centre[2]) ** 2)[None, None]
            total[square < radius**2] += np.float32(change)
        return total


def write_simulation(folder, side):
    import h5py

    field = Field(side)
    # FOLDER/NAME is complete or absent.
    paths = [folder / ("simulation." + end) for end in ("h5", "nrrd", "vti")]
    if all(path.exists() for path in paths):
        return
    parts = [path.with_suffix(path.suffix + ".part") for path in paths]
    with h5py.File(parts[0], "w") as h5, open(parts[1], "wb") as nrrd, open(parts[2], "wb") as vti:
        dataset = h5.create_dataset("density", (side,) * 3, "<f4")
        nrrd.write(f"NRRD0004\ntype: float\ndimension: 3\nsizes: {side} {side} {side}\nendian: little\n"
                   "encoding: raw\n\n".encode())
        extent = f"0 {side - 1} 0 {side - 1} 0 {side - 1}"
        vti.write(f"""<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<ImageData WholeExtent="{extent}" Origin="0 0 0" Spacing="1 1 1"><Piece Extent="{extent}"><PointData Scalars="density">
<DataArray type="Float32" Name="density" format="appended" offset="0"/></PointData></Piece></ImageData>
<AppendedData encoding="raw">_""".encode())
        vti.write(np.uint64(4 * side**3).tobytes())
        for start in range(0, side, SLAB):
            values = field.slab(start, min(side, start + SLAB))
            dataset[start:start + len(values)] = values
            nrrd.write(values.tobytes())
            vti.write(values.tobytes())
        vti.write(b"</AppendedData></VTKFile>\n")
    for part, path in zip(parts, paths):
        os.rename(part, path)


def write_image(folder, side):
    """Writes an image of cells: the field in 16 bits, with means of 2 x 2 x 2 voxels in coarser levels."""
    import numcodecs
    import zarr

    path = folder / "image.zarr"
    if path.exists():
        return
    part = folder / "image.zarr.part"
    field = Field(side)
    group = zarr.open_group(str(part), mode="w")
    levels = []
    for level in range(4):
        size = side >> level
        levels.append(group.create_dataset(str(level), shape=(size,) * 3, chunks=(64,) * 3, dtype="<u2",
                                           compressor=numcodecs.Zstd(3), dimension_separator="/"))
    for start in range(0, side, 64):
        values = np.concatenate([field.slab(at, min(side, at + SLAB)) for at in range(start, min(side, start + 64), SLAB)])
        values = np.clip((values + 1.5) * 12000, 0, 65535)
        # Voxels below the threshold are background, as in light-sheet microscopy.
        values = np.where(values < 20000, 0, values)
        for level in range(4):
            at = start >> level
            levels[level][at:at + len(values)] = values.astype(np.uint16)
            if level < 3:
                n = [size // 2 for size in values.shape]
                values = values.reshape(n[0], 2, n[1], 2, n[2], 2).mean((1, 3, 5))
    scales = [{"path": str(level), "coordinateTransformations": [{"type": "scale", "scale": [float(1 << level)] * 3}]}
              for level in range(4)]
    axes = [{"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"]
    group.attrs["multiscales"] = [{"version": "0.4", "name": "image", "axes": axes, "datasets": scales}]
    os.rename(part, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--side", type=int, default=640)
    parser.add_argument("--image-side", type=int, default=768)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    write_simulation(options.folder, options.side)
    write_image(options.folder, options.image_side)
    sizes = {}
    for path in sorted(options.folder.iterdir()):
        files = [path] if path.is_file() else [each for each in path.rglob("*") if each.is_file()]
        sizes[path.name] = sum(each.stat().st_size for each in files)
    print(json.dumps(sizes))


main()
