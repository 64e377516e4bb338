#!/usr/bin/env python3
"""Measures the cost of libghostspace-insitu for an example: insitu_overhead.py BUILD [--example NAME] [--ranks N] [--viewer] [...]

Runs BUILD/examples/insitu_NAME with and without the library, in turn, and prints medians of processor times and of the
largest resident memory. Then follows the processor time of the library on all of its threads, as it measures itself, which
varies less than the difference of two runs. BUILD is a folder such as build/release. Under MPI (--ranks), times are those of all ranks. By default
the example serves its steps; --files lets it write streams instead. --viewer reads the world four times a second, and all chunks
of each new step with the finest level, as a window does.
"""
import argparse
import concurrent.futures
import http.client
import json
import os
import re
import resource
import statistics
import subprocess
import tempfile
import threading
import time
import urllib.request

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("build")
parser.add_argument("--example", default="heat")
parser.add_argument("--ranks", type=int, default=1)
parser.add_argument("--pairs", type=int, default=3)
parser.add_argument("--size", type=int, default=128)
parser.add_argument("--steps", type=int, default=500)
parser.add_argument("--every", type=int, default=100)
parser.add_argument("--share", type=float, default=-1.0, help="-1: the default of the library; 0: unlimited")
parser.add_argument("--port", type=int, default=8127)
parser.add_argument("--thin", action="store_true")
parser.add_argument("--files", action="store_true")
parser.add_argument("--viewer", action="store_true")
parser.add_argument("--coarse", action="store_true", help="the viewer reads the coarsest level only")
parser.add_argument("--poll", type=float, default=0.25, help="seconds between two requests of the world")
options = parser.parse_args()


def run(arguments):
    """Returns processor seconds, the largest resident memory of a rank in MB, and the output."""
    program = os.path.join(options.build, "examples", "insitu_" + options.example + ("_mpi" if options.ranks > 1 else ""))
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


class Viewer:
    """Viewer without a window, on threads of this process, which the measured times leave out."""

    def __init__(self):
        self.stop, self.pictures, self.bytes, self.failures, self.first, self.full = False, 0, 0, 0, [], []
        self.thread = threading.Thread(target=self.watch)
        self.thread.start()

    def get(self, path):
        with urllib.request.urlopen("http://127.0.0.1:%d/%s" % (options.port, path), timeout=30) as answer:
            body = answer.read()
        self.bytes += len(body)
        return body

    def show(self, container):
        begun = time.monotonic()
        group = json.loads(self.get(container + "/zarr.json"))
        levels = group["consolidated_metadata"]["metadata"]
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            for level in [str(len(levels) - 1)] + ["0"] * (not options.coarse):
                counts = [-(-size // chunk) for size, chunk in
                          zip(levels[level]["shape"], levels[level]["chunk_grid"]["configuration"]["chunk_shape"])]
                names = ["%s/%s/c.%d.%d.%d" % (container, level, z, y, x)
                         for z in range(counts[0]) for y in range(counts[1]) for x in range(counts[2])]
                list(pool.map(self.get, names))
                (self.full if level == "0" else self.first).append(time.monotonic() - begun)
        self.pictures += 1

    def watch(self):
        shown = None
        while not self.stop:
            try:
                found = re.search(r'url "([^"]*\.zarr)/', self.get("").decode())
                if found and found.group(1) != shown:
                    shown = found.group(1)
                    self.show(shown)
            except (OSError, http.client.HTTPException):
                self.failures += 1
            time.sleep(options.poll)


plain, library, viewers = [], [], []
with tempfile.TemporaryDirectory() as folder:
    output = ["--folder", folder] if options.files else ["--serve", "--port", str(options.port)]
    for _ in range(options.pairs):
        plain.append(run([]))
        viewer = Viewer() if options.viewer else None
        library.append(run(["--every", str(options.every), "--share", str(options.share)] + output
                           + ["--thin"] * options.thin))
        if viewer:
            viewer.stop = True
            viewer.thread.join()
            viewers.append(viewer)
for name, runs in (("without", plain), ("with", library)):
    print("%-8s %.2f s of processor time, %.1f MB" % (name, statistics.median(one[0] for one in runs),
                                                       statistics.median(one[1] for one in runs)))
ratios = [with_library[0] / without[0] for with_library, without in zip(library, plain)]
print("ratio of each pair:", " ".join("%.4f" % one for one in ratios), "median %.4f" % statistics.median(ratios))
for one, without in zip(library, plain):
    used = [float(seconds) for seconds in re.findall(r"([\d.]+) s of processor time", one[2])]
    print("share of each rank (%):", " ".join(re.findall(r"\(([\d.]+) %\)", one[2])),
          "- processor time of the library: %.3f s, %.2f %% of the run without it" % (sum(used), 100 * sum(used) / without[0]))
for viewer in viewers:
    print("viewer: %d pictures, %.2f MB, first level after %.3f s, all levels after %.3f s (medians)" % (
        viewer.pictures, viewer.bytes / 1e6, statistics.median(viewer.first or [0]), statistics.median(viewer.full or [0])))
print(library[-1][2].strip())
