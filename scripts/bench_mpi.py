#!/usr/bin/env python3
"""Measures ghostspace-mpi: strong and weak scaling, memory of each rank, messages. Prints Markdown tables.

usage: bench_mpi.py [--size X,Y,Z | --mesh FACETS | --grid CELLS | --splats COUNT | --input FILE] [--ranks 1,2,4]
                    [--memory SIZE] [--weak] [--folder FOLDER] [-o OPTION]... [PROGRAM]

The volume has noise and blobs, 16 bits per voxel. With --weak, each number of ranks gets as many times Z slices. --mesh
encodes a wavy ball as binary STL instead, --grid warped hexahedra with holes as VTU, and --splats Gaussian splats on a
wavy ball as PLY; with --weak, each number of ranks gets as many times the facets, cells or splats. --input encodes a file. Checks that all ranks write the bytes of `ghostspace encode`. -o passes an option to both programs, as in
-o=--lossless. Bytes read are those of storage: the input leaves the page cache before each run.
"""

import argparse
import hashlib
import json
import os
import resource
import subprocess
import tempfile
import threading
import time

import numpy

options = argparse.ArgumentParser(usage=__doc__)
options.add_argument("--size", default="256,256,512")
options.add_argument("--mesh", type=int)
options.add_argument("--grid", type=int)
options.add_argument("--splats", type=int)
options.add_argument("--input")
options.add_argument("--ranks", default="1,2,3,4")
options.add_argument("--memory")
options.add_argument("--weak", action="store_true")
options.add_argument("--folder", default=tempfile.gettempdir())
options.add_argument("-o", "--option", action="append", default=[])
options.add_argument("program", nargs="?", default=os.environ.get("GHOSTSPACE", "build/release/ghostspace"))
options = options.parse_args()
PROGRAM = os.path.abspath(options.program)
ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                   OMPI_MCA_btl_vader_single_copy_mechanism="none", OMPI_MCA_btl="self,vader",
                   OMPI_MCA_mpi_yield_when_idle="1")


def write_volume(path, size):
    nx, ny, nz = size
    random = numpy.random.default_rng(1)
    x, y = numpy.meshgrid(numpy.arange(nx), numpy.arange(ny))
    with open(path, "wb") as file:
        file.write(("NRRD0004\ntype: ushort\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\n\n" %
                    (nx, ny, nz)).encode())
        for z in range(nz):
            blobs = numpy.sin(x / 40.0) * numpy.sin(y / 33.0) * numpy.sin(z / 47.0)
            slice_ = 2000 + 1500 * numpy.maximum(blobs, 0) + random.normal(0, 12, (ny, nx))
            file.write(slice_.astype("<u2").tobytes())


def write_mesh(path, facets):
    rows = int((facets / 4) ** 0.5)
    columns = 2 * rows
    facet = numpy.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    longitude = numpy.arange(columns + 1) % columns * (2 * numpy.pi / columns)

    def ring(i):
        latitude = numpy.pi * i / rows
        out = numpy.sin(latitude)
        radius = 1 + out ** 2 * (0.02 * numpy.sin(21 * longitude) * numpy.sin(17 * latitude) + 0.0004 * numpy.sin(389 * longitude))
        parts = (radius * out * numpy.cos(longitude), radius * out * numpy.sin(longitude), radius * numpy.cos(latitude))
        return numpy.stack(parts, axis=1)

    with open(path, "wb") as file:
        file.write(b" " * 80 + numpy.uint32(2 * rows * columns).tobytes())
        above = ring(0)
        for i in range(rows):
            below = ring(i + 1)
            row = numpy.zeros(2 * columns, facet)
            row["corners"][0::2] = numpy.stack([above[:-1], below[:-1], below[1:]], axis=1)
            row["corners"][1::2] = numpy.stack([above[:-1], below[1:], above[1:]], axis=1)
            file.write(row.tobytes())
            above = below


def write_grid(path, cells):
    n = round(cells ** (1 / 3))
    layers = cells // (n * n)
    x, y = (one.ravel() for one in numpy.meshgrid(numpy.arange(n + 1), numpy.arange(n + 1)))
    row, layer = n + 1, (n + 1) ** 2
    first = (numpy.arange(n)[:, None] * row + numpy.arange(n)[None, :]).ravel()
    hexahedron = numpy.array([0, 1, row + 1, row, layer, layer + 1, layer + row + 1, layer + row])
    holes = [((first % row) // 5 + (first // row) // 7 + z // 3) % 13 != 0 for z in range(layers)]
    kept, points = sum(int(one.sum()) for one in holes), layer * (layers + 1)
    sizes = (("PointData", "Float32", "heat", 1, 4 * points), ("Points", "Float32", "Points", 3, 12 * points),
             ("Cells", "Int64", "connectivity", 1, 64 * kept), ("Cells", "Int64", "offsets", 1, 8 * kept),
             ("Cells", "UInt8", "types", 1, kept))
    text, offset, section = "", 0, ""
    for owner, kind, name, components, size in sizes:
        if owner != section:
            text += ("</%s>" % section if section else "") + "<%s>" % owner
            section = owner
        text += '<DataArray type="%s" Name="%s" NumberOfComponents="%d" format="appended" offset="%d"/>' % (
            kind, name, components, offset)
        offset += 8 + size
    with open(path, "wb") as file:
        file.write(('<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">'
                    '<UnstructuredGrid><Piece NumberOfPoints="%d" NumberOfCells="%d">%s</Cells></Piece></UnstructuredGrid>'
                    '<AppendedData encoding="raw">_' % (points, kept, text)).encode())
        head = lambda size: file.write(numpy.uint64(size).tobytes())
        head(sizes[0][4])
        for z in range(layers + 1):
            file.write((numpy.sin(x / 9) * numpy.cos(z / 7) + y / 50).astype("<f4").tobytes())
        head(sizes[1][4])
        for z in range(layers + 1):
            file.write(numpy.stack([x + 0.2 * numpy.sin(y), y, z + 0.001 * x * x], axis=1).astype("<f4").tobytes())
        head(sizes[2][4])
        for z, some in enumerate(holes):
            file.write((first[some][:, None] + hexahedron + z * layer).astype("<i8").tobytes())
        head(sizes[3][4])
        file.write((8 * numpy.arange(1, kept + 1)).astype("<i8").tobytes())
        head(sizes[4][4])
        file.write(numpy.full(kept, 12, "u1").tobytes())
        file.write(b"</AppendedData></VTKFile>")


def write_splats(path, count):
    names = ("x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3").split()
    random = numpy.random.default_rng(1)
    with open(path, "wb") as file:
        file.write(("ply\nformat binary_little_endian 1.0\nelement vertex %d\n%send_header\n" %
                    (count, "".join("property float %s\n" % name for name in names))).encode())
        for at in range(0, count, 1 << 18):
            some = min(1 << 18, count - at)
            normal = random.normal(0, 1, (some, 3))
            normal /= numpy.linalg.norm(normal, axis=1)[:, None]
            radius = 1 + 0.05 * numpy.sin(9 * normal[:, 0]) * numpy.sin(7 * normal[:, 1])
            colors = numpy.sin(normal @ random.normal(0, 0.1, (3, 3)) + 5 * normal)
            rest = numpy.stack([random.uniform(-2, 4, some), *(random.uniform(-7, -5, (3, some)))], axis=1)
            rows = numpy.concatenate([normal * radius[:, None], colors, rest, random.normal(0, 1, (some, 4))], axis=1)
            file.write(rows.astype("<f4").tobytes())


class Reads(threading.Thread):
    """Notes the bytes that each rank and its children read from storage, until most()."""

    def __init__(self, program):
        super().__init__(daemon=True)
        self.program, self.bytes, self.ended = os.path.realpath(program), {}, threading.Event()

    def run(self):
        while not self.ended.wait(0.02):
            now = {}
            for pid in filter(str.isdigit, os.listdir("/proc")):
                try:
                    if os.readlink("/proc/%s/exe" % pid) != self.program:
                        continue
                    with open("/proc/%s/stat" % pid) as file:
                        parent = file.read().rsplit(")", 1)[1].split()[1]
                    with open("/proc/%s/io" % pid) as file:
                        now[pid] = (parent, int(file.read().split("read_bytes: ")[1].split()[0]))
                except (OSError, IndexError):
                    pass
            # The bytes of a process include those of its children that have ended.
            ranks = {}
            for pid, (parent, read) in now.items():
                rank = parent if parent in now else pid
                ranks[rank] = ranks.get(rank, 0) + read
            for rank, read in ranks.items():
                self.bytes[rank] = max(self.bytes.get(rank, 0), read)

    def most(self):
        self.ended.set()
        self.join()
        return max(self.bytes.values(), default=0)


def forget(path):
    """Removes a file from the page cache."""
    with open(path, "rb") as file:
        os.fsync(file.fileno())
        os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def sum_of(path):
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        for piece in iter(lambda: file.read(1 << 22), b""):
            digest.update(piece)
    return digest.hexdigest()


def encode(command, source, out):
    memory = ["--memory", options.memory] if options.memory else []
    forget(source)
    reads = Reads(command[-1])
    reads.start()
    begin = time.time()
    made = subprocess.run(command + ["encode", source, out, "--json"] + memory + options.option, env=ENVIRONMENT,
                          capture_output=True, text=True)
    if made.returncode != 0:
        raise SystemExit(made.stderr)
    return json.loads(made.stdout), time.time() - begin, reads.most()


def main():
    nx, ny, nz = (int(one) for one in options.size.split(","))
    alone, out = (os.path.join(options.folder, "ghostspace-bench-mpi." + end) for end in ("alone.qnv", "qnv"))
    ending = "stl" if options.mesh else "vtu" if options.grid else "ply" if options.splats else "nrrd"
    source = options.input or os.path.join(options.folder, "ghostspace-bench-mpi." + ending)
    load = os.getloadavg()[0]
    what = ("a file of %d bytes" % os.path.getsize(source) if options.input else "mesh of %d facets" % options.mesh
            if options.mesh else "grid of %d cells" % options.grid if options.grid else "%d splats" % options.splats
            if options.splats else "volume %d x %d x %d" % (nx, ny, nz))
    print("%d cores, load %.1f before, %s%s\n" % (os.cpu_count(), load, what, " per rank" if options.weak else ""))
    print("| program | time, s | most CPU time of a rank, s | bytes | most memory of a rank, MB | most read by a rank, MB | "
          "messages of a rank | sent by a rank, kB | largest, kB |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    made_for = None
    for ranks in (int(one) for one in options.ranks.split(",")):
        times = ranks if options.weak else 1
        if times != made_for:
            if options.mesh:
                write_mesh(source, options.mesh * times)
            elif options.grid:
                write_grid(source, options.grid * times)
            elif options.splats:
                write_splats(source, options.splats * times)
            elif not options.input:
                write_volume(source, (nx, ny, nz * times))
            made_for = times
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            facts, seconds, read = encode([PROGRAM], source, alone)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            peak = after.ru_maxrss * 1024
            print("| `ghostspace`%s | %.1f | %.1f | %d | %.0f | %.0f | | | |" %
                  (", %d times the input" % times if options.weak else "", seconds, used, facts["bytes"], peak / 1e6, read / 1e6),
                  flush=True)
        facts, seconds, read = encode(["mpirun", "--quiet", "--oversubscribe", "--bind-to", "none", "-n", str(ranks),
                                       PROGRAM + "-mpi"], source, out)
        most = {key: max(one[key] for one in facts["ranks"]) for key in facts["ranks"][0]}
        print("| %d ranks | %.1f | %.1f | %d | %.0f | %.0f | %d | %.1f | %.1f |" %
              (ranks, seconds, most["cpu_seconds"], facts["bytes"], most["peak_memory"] / 1e6, read / 1e6, most["messages"],
               most["sent_bytes"] / 1e3, most["largest_message"] / 1e3), flush=True)
        if sum_of(out) != sum_of(alone):
            raise SystemExit("%d ranks wrote other bytes" % ranks)
    for path in (alone, out) if options.input else (source, alone, out):
        os.unlink(path)


main()
