#!/usr/bin/env python3
"""Checks ghostspace-mpi: equal bytes for every number of ranks, ends of ranks at any moment, and --resume.

usage: mpi_check.py [--kills N] [--seed S] [--volume FILE] [--mesh FILE] [--grid FILE] [--splats COUNT] [--late]
                    [PROGRAM]

PROGRAM is ghostspace, or $GHOSTSPACE, or build/release/ghostspace; ghostspace-mpi is beside it. --kills ends a random
rank at N random moments (usually 2) of encoding a volume, a mesh and a grid each. --volume, --mesh and --grid encode
these files instead of small ones in these runs. --splats also encodes that many Gaussian splats, which takes minutes:
more than 500,000 are divided. --late ends ranks only in the last third of a run, which shows the time that --resume
saves. Skips all checks, with a message, if mpirun or ghostspace-mpi is missing.
"""

import argparse
import array
import base64
import hashlib
import json
import math
import os
import random
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib

options = argparse.ArgumentParser(usage=__doc__)
options.add_argument("--kills", type=int, default=2)
options.add_argument("--seed", type=int, default=1)
options.add_argument("--splats", type=int, default=0)
options.add_argument("--late", action="store_true")
for kind in ("volume", "mesh", "grid"):
    options.add_argument("--" + kind)
options.add_argument("program", nargs="?", default=os.environ.get("GHOSTSPACE", "build/release/ghostspace"))
options = options.parse_args()
PROGRAM = os.path.abspath(options.program)
TOGETHER = os.path.join(os.path.dirname(PROGRAM), "ghostspace-mpi")
# Containers may forbid reading the memory of other processes, and tests may run as root.
ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                   OMPI_MCA_btl_vader_single_copy_mechanism="none", OMPI_MCA_mpi_yield_when_idle="1",
                   OMPI_MCA_btl="self,vader", OMPI_MCA_orte_base_help_aggregate="1")
failures = 0
interrupted = 0
hanging = 0  # ends after which mpirun did not end
resumed = []  # processor seconds of the busiest rank of each run with --resume


def check(name, good, detail=""):
    global failures
    print(("ok      " if good else "FAILED  ") + name + ("" if good else ": " + str(detail)[-1500:]), flush=True)
    failures += not good


def mpirun(ranks, arguments):
    return ["mpirun", "--quiet", "--oversubscribe", "--bind-to", "none", "-n", str(ranks), TOGETHER] + arguments


def run(command, **more):
    return subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, timeout=600, **more)


def sum_of(path):
    if not os.path.exists(path):
        return "missing"
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def write_volume(path, size, kind, gaps=False):
    nx, ny, nz = size
    values = array.array("f" if kind == "float" else "h")
    for z in range(nz):
        for y in range(ny):
            for x in range(nx):
                value = 900 * math.sin(x * y / 37) + 500 * math.cos(z / 9) + (x * 7 + y * 13 + z * 29) % 31
                values.append(float("nan") if gaps and (x + y + z) % 50 < 20 else value if kind == "float" else int(value))
    with open(path, "wb") as file:
        file.write(("NRRD0004\ntype: %s\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\n\n" %
                    (kind, nx, ny, nz)).encode())
        file.write(values.tobytes())


def write_mesh(path, steps=24, rough=0.0):
    """Writes a ball of 2 * steps * steps triangles. `rough` moves its vertices."""
    def place(i, k):
        k %= steps
        radius = 1 + rough * math.sin(12.9898 * i + 78.233 * k)
        return (radius * math.sin(math.pi * i / steps) * math.cos(2 * math.pi * k / steps),
                radius * math.sin(math.pi * i / steps) * math.sin(2 * math.pi * k / steps),
                radius * math.cos(math.pi * i / steps))

    facet = struct.Struct("<12fH")
    with open(path, "wb") as file:
        file.write(b" " * 80 + struct.pack("<I", 2 * steps * steps))
        above = [place(0, k) for k in range(steps + 1)]
        for i in range(steps):
            below = [place(i + 1, k) for k in range(steps + 1)]
            for k in range(steps):
                a, b, c, d = above[k], below[k], below[k + 1], above[k + 1]
                file.write(facet.pack(0, 0, 0, *a, *b, *c, 0) + facet.pack(0, 0, 0, *a, *c, *d, 0))
            above = below


def write_grid(path, n=6):
    points = [(x + 0.2 * math.sin(y), y, z + 0.1 * x * x) for z in range(n + 1) for y in range(n + 1) for x in range(n + 1)]
    at = lambda x, y, z: (z * (n + 1) + y) * (n + 1) + x
    cells = [(at(x, y, z), at(x + 1, y, z), at(x + 1, y + 1, z), at(x, y + 1, z), at(x, y, z + 1), at(x + 1, y, z + 1),
              at(x + 1, y + 1, z + 1), at(x, y + 1, z + 1)) for z in range(n) for y in range(n) for x in range(n)]
    numbers = lambda rows: " ".join(str(value) for row in rows for value in row)
    with open(path, "w") as file:
        file.write('<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>'
                   '<Piece NumberOfPoints="%d" NumberOfCells="%d"><Points><DataArray type="Float32" '
                   'NumberOfComponents="3" format="ascii">%s</DataArray></Points><Cells><DataArray type="Int32" '
                   'Name="connectivity" format="ascii">%s</DataArray><DataArray type="Int32" Name="offsets" '
                   'format="ascii">%s</DataArray><DataArray type="UInt8" Name="types" format="ascii">%s</DataArray>'
                   '</Cells></Piece></UnstructuredGrid></VTKFile>' %
                   (len(points), len(cells), numbers(points), numbers(cells),
                    " ".join(str(8 * (i + 1)) for i in range(len(cells))), " ".join("12" for _ in cells)))


def write_large_grid(path, size, first_layer=0, packed=False):
    """Writes warped hexahedra with holes: raw appended data, or blocks of zlib in base64."""
    nx, ny, nz = size
    points, heat = array.array("f"), array.array("f")
    for z in range(first_layer, first_layer + nz + 1):
        for y in range(ny + 1):
            for x in range(nx + 1):
                points.extend((x + 0.2 * math.sin(y), y, z + 0.001 * x * x))
                heat.append(math.sin(x / 9) * math.cos(z / 7) + y / 50)
    corners, cells = array.array("q"), 0
    row, layer = nx + 1, (nx + 1) * (ny + 1)
    for z in range(nz):
        for y in range(ny):
            for x in range(nx):
                if (x // 5 + y // 7 + z // 3) % 13 == 0:
                    continue
                at = z * layer + y * row + x
                corners.extend((at, at + 1, at + row + 1, at + row, at + layer, at + layer + 1, at + layer + row + 1,
                                at + layer + row))
                cells += 1
    arrays = [("PointData", "Float32", "heat", 1, heat.tobytes()), ("Points", "Float32", "Points", 3, points.tobytes()),
              ("Cells", "Int64", "connectivity", 1, corners.tobytes()),
              ("Cells", "Int64", "offsets", 1, array.array("q", range(8, 8 * cells + 1, 8)).tobytes()),
              ("Cells", "UInt8", "types", 1, bytes([12]) * cells)]
    text, data, section = "", bytearray(), ""
    for owner, kind, name, components, values in arrays:
        if owner != section:
            text += ("</%s>" % section if section else "") + "<%s>" % owner
            section = owner
        text += '<DataArray type="%s" Name="%s" NumberOfComponents="%d" format="appended" offset="%d"/>' % (
            kind, name, components, len(data))
        if packed:
            block = 1 << 15
            parts = [zlib.compress(values[i:i + block], 1) for i in range(0, len(values), block)]
            table = struct.pack("<%dQ" % (3 + len(parts)), len(parts), block, len(values) % block, *map(len, parts))
            data += base64.b64encode(table) + base64.b64encode(b"".join(parts))
        else:
            data += struct.pack("<Q", len(values)) + values
    with open(path, "wb") as file:
        file.write(('<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64"%s>'
                    '<UnstructuredGrid><Piece NumberOfPoints="%d" NumberOfCells="%d">%s</%s></Piece></UnstructuredGrid>'
                    '<AppendedData encoding="%s">_' %
                    (' compressor="vtkZLibDataCompressor"' if packed else "", len(heat), cells, text, section,
                     "base64" if packed else "raw")).encode())
        file.write(data)
        file.write(b"</AppendedData></VTKFile>")


def write_pieces(path, size, pieces):
    """Writes a grid in pieces, each in a file of its own."""
    names = []
    for i in range(pieces):
        names.append("%s-%d.vtu" % (os.path.basename(path)[:-5], i))
        write_large_grid(os.path.join(os.path.dirname(path), names[-1]), size, i * size[2])
    with open(path, "w") as file:
        file.write('<VTKFile type="PUnstructuredGrid" version="0.1"><PUnstructuredGrid GhostLevel="0"><PPointData>'
                   '<PDataArray type="Float32" Name="heat"/></PPointData><PPoints><PDataArray type="Float32" '
                   'NumberOfComponents="3"/></PPoints>%s</PUnstructuredGrid></VTKFile>' %
                   "".join('<Piece Source="%s"/>' % name for name in names))


def write_exodus(path, size):
    """Writes two blocks of hexahedra with a variable at nodes as Exodus II, in a classic NetCDF file."""
    nx, ny, nz = size
    axes, heat = (array.array("d"), array.array("d"), array.array("d")), array.array("d")
    for z in range(nz + 1):
        for y in range(ny + 1):
            for x in range(nx + 1):
                for axis, place in zip(axes, (x + 0.2 * math.sin(y), y, z + 0.001 * x * x)):
                    axis.append(place)
                heat.append(math.sin(x / 9) * math.cos(z / 7) + y / 50)
    row, layer = nx + 1, (nx + 1) * (ny + 1)
    blocks = (array.array("i"), array.array("i"))
    for z in range(nz):
        for y in range(ny):
            for x in range(nx):
                if (x // 5 + y // 7 + z // 3) % 13:
                    at = 1 + z * layer + y * row + x
                    blocks[2 * z // nz].extend((at, at + 1, at + row + 1, at + row, at + layer, at + layer + 1,
                                                at + layer + row + 1, at + layer + row))
    char, integer, real, double = 2, 4, 5, 6
    text = lambda name: struct.pack(">I", len(name)) + name.encode() + bytes(-len(name) % 4)
    attribute = lambda name, kind, count, values: text(name) + struct.pack(">II", kind, count) + values + bytes(-len(values) % 4)
    lists = lambda tag, items: struct.pack(">II", tag if items else 0, len(items)) + b"".join(items)
    dimensions = [("nodes", len(heat)), ("corners", 8), ("name", 33), ("variables", 1), ("steps", 1),
                  ("cells1", len(blocks[0]) // 8), ("cells2", len(blocks[1]) // 8)]
    element = [attribute("elem_type", char, 4, b"HEX8")]
    arrays = [("coord" + name, double, [0], [], axis) for name, axis in zip("xyz", axes)]
    arrays += [("connect%d" % (i + 1), integer, [5 + i, 1], element, block) for i, block in enumerate(blocks)]
    arrays += [("name_nod_var", char, [3, 2], [], b"heat".ljust(33, b"\0")), ("vals_nod_var1", double, [4, 0], [], heat),
               ("time_whole", double, [4], [], array.array("d", [0]))]
    data = []
    for _, _, _, _, values in arrays:
        if isinstance(values, array.array) and sys.byteorder == "little":
            values.byteswap()
        data.append(bytes(values) + bytes(-len(bytes(values)) % 4))

    def header(begin):
        out = b"CDF\x02" + struct.pack(">I", 0) + lists(10, [text(name) + struct.pack(">I", n) for name, n in dimensions])
        out += lists(12, [attribute("api_version", real, 1, struct.pack(">f", 4.9))])
        items = []
        for (name, kind, dims, own, _), values in zip(arrays, data):
            items.append(text(name) + struct.pack(">%dI" % (1 + len(dims)), len(dims), *dims) + lists(12, own) +
                         struct.pack(">IIQ", kind, len(values), begin))
            begin += len(values)
        return out + lists(11, items)

    with open(path, "wb") as file:
        file.write(header(len(header(0))) + b"".join(data))


def write_vtkhdf(path, size, parts):
    """Writes warped hexahedra with holes in several parts. Returns False without h5py."""
    try:
        import h5py
        import numpy
    except ImportError:
        return False
    nx, ny, nz = size
    z, y, x = (a.ravel() for a in numpy.mgrid[:nz + 1, :ny + 1, :nx + 1])
    heat = numpy.sin(x / 9) * numpy.cos(z / 7) + y / 50
    k, j, i = (a.ravel() for a in numpy.mgrid[:nz, :ny, :nx])
    row, layer = nx + 1, (nx + 1) * (ny + 1)
    at = (k * layer + j * row + i)[(i // 5 + j // 7 + k // 3) % 13 != 0]
    cells = at[:, None] + numpy.array([0, 1, row + 1, row, layer, layer + 1, layer + row + 1, layer + row])
    with h5py.File(path, "w") as file:
        grid = file.create_group("VTKHDF")
        grid.attrs["Version"] = [2, 0]
        grid.attrs["Type"] = numpy.bytes_("UnstructuredGrid")
        for name, number in (("Points", len(heat)), ("Cells", len(cells)), ("ConnectivityIds", cells.size)):
            grid["NumberOf" + name] = [number] * parts
        points = numpy.stack([x + 0.2 * numpy.sin(y), y, z + 0.001 * x * x], -1)
        grid.create_dataset("Points", data=numpy.concatenate([points + (0, 0, nz * p) for p in range(parts)]).astype("f4"),
                            chunks=(4096, 3), compression="gzip")
        grid["Connectivity"] = numpy.tile(cells.ravel(), parts)
        grid["Offsets"] = numpy.tile(numpy.arange(0, cells.size + 1, 8), parts)
        grid["Types"] = numpy.full(len(cells) * parts, 12, "u1")
        grid["PointData/heat"] = numpy.tile(heat, parts)
    return True


def write_splats(path, count):
    names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1",
             "rot_2", "rot_3"]
    chance = random.Random(1)
    with open(path, "wb") as file:
        file.write(("ply\nformat binary_little_endian 1.0\nelement vertex %d\n%send_header\n" %
                    (count, "".join("property float %s\n" % name for name in names))).encode())
        for i in range(count):
            u, v = chance.random() * 6.28, chance.random() * 3.14
            row = array.array("f", (math.sin(v) * math.cos(u), math.sin(v) * math.sin(u), math.cos(v),
                                    math.sin(3 * u), math.cos(5 * v), math.sin(7 * u * v), 2 - 4 * chance.random(),
                                    -5 - chance.random(), -5.5, -7, 1, chance.random(), chance.random(), 0))
            file.write(row.tobytes())


def equal_bytes(folder, name, source, extra, counts):
    alone, out = folder + "/alone.qnv", folder + "/together.qnv"
    made = run([PROGRAM, "encode", source, alone] + extra)
    check(name + ": ghostspace encode", made.returncode == 0, made.stderr)
    for ranks in counts:
        if os.path.exists(out):
            os.unlink(out)
        made = run(mpirun(ranks, ["encode", source, out] + extra))
        check("%s: %d ranks write the same bytes" % (name, ranks), made.returncode == 0 and sum_of(out) == sum_of(alone),
              made.stderr + made.stdout)
        check("%s: %d ranks leave no other file" % (name, ranks), not os.path.exists(out + ".parts"))


def processor_seconds(output):
    """Returns the processor time of the busiest rank, as --json states it."""
    return max(rank["cpu_seconds"] for rank in json.loads(output)["ranks"])


def ranks_of(launcher):
    found = []
    for pid in os.listdir("/proc"):
        try:
            with open("/proc/%s/stat" % pid) as file:
                parent = int(file.read().rsplit(")", 1)[1].split()[1])
            if parent == launcher and os.readlink("/proc/%s/exe" % pid) == os.path.realpath(TOGETHER):
                found.append(int(pid))
        except (OSError, ValueError, IndexError):
            pass
    return found


def end_a_rank(folder, source, extra, expected, longest, chance):
    """Ends one rank at a random moment. Then --resume continues, sometimes with another number of ranks."""
    global interrupted
    out = folder + "/killed.qnv"
    shutil.rmtree(out + ".parts", ignore_errors=True)
    with open(out, "wb") as file:
        file.write(b"")
    os.unlink(out)
    running = subprocess.Popen(mpirun(3, ["encode", source, out] + extra), env=ENVIRONMENT, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    time.sleep(chance.uniform(longest * 2 / 3 if options.late else 0, longest))
    ranks = ranks_of(running.pid)
    if ranks and running.poll() is None:
        try:
            os.kill(chance.choice(ranks), signal.SIGKILL)
        except ProcessLookupError:
            pass
    try:
        _, errors = running.communicate(timeout=30)
    except subprocess.TimeoutExpired:
        end = time.time() + 270
        while ranks_of(running.pid) and time.time() < end:
            time.sleep(1)
        alive = len(ranks_of(running.pid))
        # mpirun of Open MPI 4.1 sometimes waits for itself in PMIx_server_finalize when all ranks have ended.
        running.kill()
        _, errors = running.communicate()
        if alive:
            return "%d other ranks did not end" % alive
        global hanging
        hanging += 1
    lines = [line for line in errors.splitlines() if "error" in line]
    if running.returncode != 0 and len(lines) > 1:
        return "several errors: " + errors
    whole = os.path.exists(out)
    if whole and sum_of(out) != expected:
        return "half a file has the final name"
    if whole and running.returncode == 0:
        return None
    interrupted += 1
    made = run(mpirun(3 if options.late else chance.choice((2, 3, 4)), ["encode", source, out, "--resume"] + extra))
    if made.returncode != 0:
        return "the second run failed: " + made.stderr + errors
    resumed.append(processor_seconds(made.stdout))
    if sum_of(out) != expected:
        return "--resume gave other bytes"
    return "the folder of the parts is left" if os.path.exists(out + ".parts") else None


def full_disk(folder, source):
    """Encodes onto file systems that are too small for the parts, and for the stream."""
    alone, small = folder + "/alone.qnv", folder + "/small"
    run([PROGRAM, "encode", source, alone, "--lossless"])
    os.makedirs(small)
    # The parts alone take up to twice the bytes of the stream, so that either the parts or the stream fills the disk.
    for size in (0.5, 1.5, 2, 2.5):
        pages = int(os.path.getsize(alone) * size / 4096)
        if run(["mount", "-t", "tmpfs", "-o", "size=%d" % (4096 * pages), "tmpfs", small]).returncode != 0:
            print("skipped: a full disk; only root may mount a small one")
            return
        try:
            made = run(mpirun(3, ["encode", source, small + "/out.qnv", "--lossless"]))
            lines = [line for line in made.stderr.splitlines() if "error" in line]
            out = small + "/out.qnv"
            refused = made.returncode in (1, 3) and len(lines) == 1 and not os.path.exists(out)
            check("a disk of %g times the stream gives one line and no file, or the whole stream" % size,
                  refused or (made.returncode == 0 and sum_of(out) == sum_of(alone)),
                  "%d: %s" % (made.returncode, made.stderr))
        finally:
            run(["umount", small])


def end_ranks(folder, name, source, extra, chance):
    global interrupted
    expected_file = folder + "/expected.qnv"
    extra = extra + ["--json"]
    begin = time.time()
    made = run(mpirun(3, ["encode", source, expected_file] + extra))
    longest = time.time() - begin
    expected = sum_of(expected_file)
    check(name + ": encode without an end", made.returncode == 0, made.stderr)
    interrupted = 0
    resumed.clear()
    problems = []
    for i in range(options.kills):
        problem = end_a_rank(folder, source, extra, expected, longest, chance)
        if problem:
            problems.append("end %d: %s" % (i, problem))
    check("%s: %d ends of a rank (%d before the end of the run) leave no half file, and --resume gives the same bytes" %
          (name, options.kills, interrupted), not problems, "; ".join(problems))
    if resumed:
        print("note    %s: processor time of the busiest rank %.1f s; with --resume %.1f s on average (%.1f to %.1f s)" %
              (name, processor_seconds(made.stdout), sum(resumed) / len(resumed), min(resumed), max(resumed)), flush=True)


def main():
    if not shutil.which("mpirun") or not os.path.exists(TOGETHER):
        print("skipped: mpirun or %s is missing (scripts/install-dependencies.sh --cluster)" % TOGETHER)
        return
    folder = tempfile.mkdtemp(prefix="ghostspace-mpi-")
    try:
        volume, floats, flat, mesh, grid, large, rough, large_grid, packed_grid, pieces, exodus, vtkhdf, splats = (
            folder + "/" + name for name in ("v.nrrd", "f.nrrd", "flat.nrrd", "m.stl", "g.vtu", "large.stl", "rough.stl",
                                             "large.vtu", "packed.vtu", "pieces.pvtu", "grid.e", "grid.vtkhdf",
                                             "splats.ply"))
        write_volume(volume, (40, 36, 140), "short")
        write_volume(floats, (24, 30, 75), "float", gaps=True)
        write_volume(flat, (2112, 520, 2), "short")
        write_mesh(mesh)
        write_grid(grid)
        write_mesh(large, 260)
        write_mesh(rough, 260, 0.05)
        write_large_grid(large_grid, (60, 60, 60))
        write_large_grid(packed_grid, (60, 60, 60), packed=True)
        write_pieces(pieces, (60, 60, 30), 3)
        write_exodus(exodus, (60, 60, 50))
        # These meshes and grids have three runs or more, and exceed the memory of a process.
        little = ["--memory", "64M"]
        equal_bytes(folder, "volume", volume, [], (1, 2, 3, 4))
        equal_bytes(folder, "volume of two slices", flat, [], (3,))
        equal_bytes(folder, "lossless floats with missing voxels", floats, ["--lossless"], (3,))
        equal_bytes(folder, "limited size", volume, ["--max-bytes", "30000"], (3,))
        equal_bytes(folder, "mesh", mesh, [], (3,))
        equal_bytes(folder, "mesh that exceeds memory", large, little, (1, 2, 3, 4))
        equal_bytes(folder, "rough mesh that exceeds memory", rough, little, (3,))
        equal_bytes(folder, "octree of a mesh that exceeds memory", large, little + ["--method", "octree"], (4,))
        equal_bytes(folder, "unstructured grid", grid, [], (3,))
        equal_bytes(folder, "grid that exceeds memory", large_grid, little, (1, 2, 3, 4))
        octree = little + ["--method", "octree"]  # takes a fifth of the time
        equal_bytes(folder, "octree of a grid that exceeds memory", large_grid, octree, (2,))
        equal_bytes(folder, "compressed grid that exceeds memory", packed_grid, octree, (3,))
        equal_bytes(folder, "grid in pieces that exceeds memory", pieces, octree, (2, 4))
        equal_bytes(folder, "Exodus grid that exceeds memory", exodus, octree, (1, 3))
        if write_vtkhdf(vtkhdf, (60, 60, 25), 2):
            equal_bytes(folder, "VTKHDF grid that exceeds memory", vtkhdf, octree, (1, 3))
        else:
            print("skipped: a VTKHDF grid; this Python has no h5py")
        if options.splats > 0:
            write_splats(splats, options.splats)
            equal_bytes(folder, "%d splats" % options.splats, splats, [], (1, 2, 3, 4))
        out = folder + "/out.qnv"
        missing = run(mpirun(3, ["encode", folder + "/missing.nrrd", out]))
        lines = [line for line in missing.stderr.splitlines() if line.strip()]
        check("a missing input gives one line", missing.returncode == 1 and len(lines) == 1 and "missing.nrrd" in lines[0],
              missing.stderr)
        os.makedirs(out + ".parts")
        with open(out + ".parts/key", "w") as key:
            key.write("another task")
        wrong = run(mpirun(2, ["encode", volume, out, "--resume"]))
        check("--resume needs the same task", wrong.returncode == 1 and "other options" in wrong.stderr, wrong.stderr)
        wrong = run(mpirun(2, ["info", volume]))
        check("other commands are refused", wrong.returncode == 2 and "expected 'encode" in wrong.stderr, wrong.stderr)
        wrong = run([PROGRAM, "encode", volume, out, "--resume"])
        check("ghostspace has no --resume", wrong.returncode == 2 and "ghostspace-mpi" in wrong.stderr, wrong.stderr)

        full_disk(folder, floats)
        chance = random.Random(options.seed)
        for name, source, extra in (("volume", options.volume or volume, []), ("mesh", options.mesh or large, little),
                                    ("grid", options.grid or large_grid, little)):
            end_ranks(folder, name, source, extra if source in (large, volume, large_grid) else [], chance)
        if options.splats > 0:
            end_ranks(folder, "splats", splats, [], chance)
        if hanging:
            print("note    mpirun itself did not end %d times, although all ranks had ended" % hanging)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    sys.exit(failures != 0)


main()
