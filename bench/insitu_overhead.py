#!/usr/bin/env python3
"""Measures the cost of libghostspace-insitu for the heat equation: insitu_overhead.py BUILD [--ranks N] [--pairs N]

Runs build/.../examples/insitu_heat with and without the library, in turn, and prints medians of processor times and of the
largest resident memory. BUILD is a folder such as build/release. Under MPI (--ranks), times are those of all ranks.
"""
import argparse
import os
import re
import resource
import statistics
import subprocess
import tempfile

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("build")
parser.add_argument("--ranks", type=int, default=1)
parser.add_argument("--pairs", type=int, default=3)
parser.add_argument("--size", type=int, default=128)
parser.add_argument("--steps", type=int, default=500)
parser.add_argument("--every", type=int, default=100)
parser.add_argument("--share", type=float, default=0.0)
parser.add_argument("--thin", action="store_true")
options = parser.parse_args()


def run(arguments):
    """Returns processor seconds, the largest resident memory of a rank in MB, and the output."""
    program = os.path.join(options.build, "examples", "insitu_heat" + ("_mpi" if options.ranks > 1 else ""))
    line = [program, "--size", str(options.size), "--steps", str(options.steps)] + arguments
    # A shell per rank reports its own memory.
    if options.ranks > 1:
        line = ["mpirun", "--oversubscribe", "-n", str(options.ranks)] + line
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_btl_vader_single_copy_mechanism="none", OMPI_MCA_mpi_yield_when_idle="1")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(["/usr/bin/env", "python3", "-c", """
import resource, subprocess, sys
code = subprocess.run(sys.argv[1:]).returncode
print("rss", resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
sys.exit(code)"""] + line, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return seconds, int(re.search(r"rss (\d+)", done.stdout).group(1)) / 1024, done.stdout


plain, library = [], []
with tempfile.TemporaryDirectory() as folder:
    for _ in range(options.pairs):
        plain.append(run([]))
        library.append(run(["--every", str(options.every), "--share", str(options.share), "--folder", folder]
                           + ["--thin"] * options.thin))
for name, runs in (("without", plain), ("with", library)):
    print("%-8s %.2f s of processor time, %.1f MB" % (name, statistics.median(one[0] for one in runs),
                                                       statistics.median(one[1] for one in runs)))
base = statistics.median(one[0] for one in plain)
ratios = [with_library[0] / without[0] for with_library, without in zip(library, plain)]
print("ratio of each pair:", " ".join("%.4f" % one for one in ratios), "median %.4f" % statistics.median(ratios))
print(library[-1][2].strip())
