#!/usr/bin/env python3
"""Measures ghostspace-mpi: strong and weak scaling, memory of each rank, messages. Prints Markdown tables.

usage: bench_mpi.py [--size X,Y,Z] [--ranks 1,2,4] [--memory SIZE] [--weak] [--folder FOLDER] [-o OPTION]... [PROGRAM]

The volume has noise and blobs, 16 bits per voxel. With --weak, each number of ranks gets as many times Z slices.
Checks that all ranks write the bytes of `ghostspace encode`. -o passes an option to both programs, as in -o=--lossless.
"""

import argparse
import hashlib
import json
import os
import resource
import subprocess
import tempfile
import time

import numpy

options = argparse.ArgumentParser(usage=__doc__)
options.add_argument("--size", default="256,256,512")
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


def sum_of(path):
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        for piece in iter(lambda: file.read(1 << 22), b""):
            digest.update(piece)
    return digest.hexdigest()


def encode(command, source, out):
    memory = ["--memory", options.memory] if options.memory else []
    begin = time.time()
    made = subprocess.run(command + ["encode", source, out, "--json"] + memory + options.option, env=ENVIRONMENT,
                          capture_output=True, text=True)
    if made.returncode != 0:
        raise SystemExit(made.stderr)
    return json.loads(made.stdout), time.time() - begin


def main():
    nx, ny, nz = (int(one) for one in options.size.split(","))
    source, alone, out = (os.path.join(options.folder, "ghostspace-bench-mpi." + end) for end in ("nrrd", "alone.qnv", "qnv"))
    load = os.getloadavg()[0]
    print("%d cores, load %.1f before, volume %d x %d x %d%s\n" % (os.cpu_count(), load, nx, ny, nz, " per rank" if options.weak else ""))
    print("| program | time, s | most CPU time of a rank, s | bytes | most memory of a rank, MB | messages of a rank | sent by a "
          "rank, kB | largest, kB |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    made_for = None
    for ranks in (int(one) for one in options.ranks.split(",")):
        size = (nx, ny, nz * ranks if options.weak else nz)
        if size != made_for:
            write_volume(source, size)
            made_for = size
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            facts, seconds = encode([PROGRAM], source, alone)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            peak = after.ru_maxrss * 1024
            print("| `ghostspace`%s | %.1f | %.1f | %d | %.0f | | | |" %
                  (", %d slices" % size[2] if options.weak else "", seconds, used, facts["bytes"], peak / 1e6), flush=True)
        facts, seconds = encode(["mpirun", "--quiet", "--oversubscribe", "--bind-to", "none", "-n", str(ranks),
                                 PROGRAM + "-mpi"], source, out)
        most = {key: max(one[key] for one in facts["ranks"]) for key in facts["ranks"][0]}
        print("| %d ranks | %.1f | %.1f | %d | %.0f | %d | %.1f | %.1f |" %
              (ranks, seconds, most["cpu_seconds"], facts["bytes"], most["peak_memory"] / 1e6, most["messages"], most["sent_bytes"] / 1e3,
               most["largest_message"] / 1e3), flush=True)
        if sum_of(out) != sum_of(alone):
            raise SystemExit("%d ranks wrote other bytes" % ranks)
    for path in (source, alone, out):
        os.unlink(path)


main()
