#!/usr/bin/env python3
"""fault_check.py [-n RUNS] [-k KIND] [-s SCENARIO] [-j JOBS] [--seed S]: makes single calls of the program fail.

For each scenario (a command on small files) and each kind of call (allocate, read, write, open, connect), counts the
calls, then runs the scenario with call 1, 2, 3, ... failing: all if there are at most RUNS (40), else the first quarter
of RUNS, the last call and others at random. `write` also fails from one call on, like a full disk, or the program is
killed there (SIGKILL). tests/faults/fault_shim.cpp makes the calls fail, by LD_PRELOAD. A run must
  - end without another signal within 60 s,
  - give its correct result, or one to eight lines that say what is wrong,
  - leave each file that was there as it was, or give it its correct new content,
  - leave no other file, except an unfinished one with a leading dot after SIGKILL.
Prints a line per scenario and kind, and one per violation with the command to repeat it. Exits with 1 after violations.

GHOSTSPACE: program instead of build/release/ghostspace.
"""

import argparse
import array
import concurrent.futures
import gzip
import http.server
import math
import os
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
KINDS = ["allocate", "read", "write", "write onwards", "write kill", "open", "connect"]
OLD = b"the content before\n"
SECONDS = 60


def png(width, height):
    rows = b"".join(b"\0" + b"".join(bytes((x * 9 % 256, y * 7 % 256, 90)) for x in range(width)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def sphere(steps):
    text = ["# sphere"]
    for i in range(steps + 1):
        for j in range(2 * steps):
            u, v = math.pi * i / steps, math.pi * j / steps
            text.append(f"v {math.sin(u) * math.cos(v):.5f} {math.sin(u) * math.sin(v):.5f} {math.cos(u):.5f}")
    for i in range(steps):
        for j in range(2 * steps):
            a, b = i * 2 * steps + j, i * 2 * steps + (j + 1) % (2 * steps)
            text.append(f"f {a + 1} {b + 1} {b + 2 * steps + 1} {a + 2 * steps + 1}")
    return "\n".join(text).encode() + b"\n"


def volume(edge):
    values = array.array("H")
    for z in range(edge):
        for y in range(edge):
            for x in range(edge):
                values.append(int(1000 * max(0.0, 1 - math.dist((x, y, z), (edge / 2,) * 3) / edge * 2)))
    head = f"NRRD0004\ntype: uint16\ndimension: 3\nsizes: {edge} {edge} {edge}\nendian: little\nencoding: raw\n\n"
    return head.encode() + values.tobytes()


WORLD = b"""#VRML V2.0 utf8
Viewpoint { position 0 0 8 }
DEF T TimeSensor { cycleInterval 2 loop TRUE }
DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 0 0 ] }
DEF M Transform { children [
  Shape { appearance Appearance { material Material { } texture ImageTexture { url "picture.png" } } geometry Box { } }
  Inline { url "part.wrl.gz" } ] }
DEF S Script { eventIn SFTime set eventOut SFVec3f at url "javascript: function set(t) { at = new SFVec3f(t, 0, 0); }" }
ROUTE T.fraction_changed TO P.set_fraction
ROUTE P.value_changed TO M.set_translation
Shape { geometry Text { string "faults" } }
"""
PART = b"#VRML V2.0 utf8\nTransform { translation 2 0 0 children Shape { appearance Appearance { material Material { } } " \
       b"geometry Sphere { } } }\n"


def write_inputs(folder, program):
    (folder / "world.wrl").write_bytes(WORLD)
    (folder / "part.wrl.gz").write_bytes(gzip.compress(PART, mtime=0))
    (folder / "picture.png").write_bytes(png(32, 24))
    (folder / "mesh.obj").write_bytes(sphere(12))
    (folder / "volume.nrrd").write_bytes(volume(24))
    for source, stream in (("mesh.obj", "mesh.qnv"), ("volume.nrrd", "volume.qnv")):
        subprocess.run([program, "encode", folder / source, folder / stream], check=True, capture_output=True)


# Name, arguments, result, and optionally the old content of the result. "{}" is the folder of inputs, "{out}" that of results, "{http}" a server of the inputs. The
# result "-" is the output.
SCENARIOS = [
    ("open a world", ["--snapshot", "{out}/p.png", "--size", "96x64", "{}/world.wrl"], "p.png"),
    ("open a world over HTTP", ["--snapshot", "{out}/p.png", "--size", "96x64", "{http}/world.wrl"], "p.png"),
    ("stream a mesh over HTTP", ["--snapshot", "{out}/p.png", "--size", "96x64", "{http}/mesh.qnv"], "p.png"),
    ("show a volume", ["--snapshot", "{out}/p.png", "--size", "96x64", "{}/volume.nrrd"], "p.png"),
    ("show a stream of values", ["--snapshot", "{out}/p.png", "--size", "96x64", "{}/volume.qnv"], "p.png"),
    ("animate", ["animate", "--turntable", "--frames", "3", "--size", "48x32", "{}/world.wrl", "{out}/a.webm"], "a.webm"),
    ("encode a mesh", ["encode", "{}/mesh.obj", "{out}/m.qnv"], "m.qnv"),
    ("encode a volume", ["encode", "{}/volume.nrrd", "{out}/v.qnv"], "v.qnv"),
    ("export values", ["export", "{}/volume.qnv", "{out}/v.nrrd"], "v.nrrd"),
    ("export a mesh", ["export", "{}/mesh.qnv", "{out}/m.ply"], "m.ply"),
    ("info", ["info", "{}/volume.qnv"], "-"),
    ("check", ["check", "{}/world.wrl"], "-"),
    ("print", ["print", "{}/world.wrl"], "-"),
    ("trace", ["trace", "--until", "1", "{}/world.wrl"], "-"),
    ("export a picture of splats", ["export", "{}/mesh.qnv", "{out}/m.spz"], "m.spz"),
]
# The same for the program tests/faults/save_settings.cpp, with the contents that a window finds.
SETTINGS = [
    ("save settings", ["settings", "{out}/settings.conf"], "settings.conf", b"text-size = 1.5\n"),
    ("save bookmarks", ["bookmarks", "{out}/bookmarks.json"], "bookmarks.json",
     b'{"bookmarks":[{"place":"/worlds/a.wrl","viewpoint":"","title":"A","camera":[]}]}\n'),
    ("save the state", ["state", "{out}/memory.json"], "memory.json", b'{"recent":["/worlds/a.wrl"]}\n'),
]


class Runs:
    def __init__(self, program, settings_program, shim, work):
        self.program, self.settings_program, self.shim, self.work = program, settings_program, shim, work
        self.inputs = work / "inputs"
        self.inputs.mkdir()
        self.home = work / "home"
        write_inputs(self.inputs, program)
        folder = str(self.inputs)

        class Handler(http.server.SimpleHTTPRequestHandler):
            def __init__(self, *arguments):
                super().__init__(*arguments, directory=folder)

            def log_message(self, *_):
                pass

            def handle(self):
                try:
                    super().handle()
                except OSError:
                    pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self.http = f"http://127.0.0.1:{self.server.server_address[1]}"

    def run(self, scenario, fault, old):
        """Returns (status, result bytes or None, message, number of calls, list of other files)."""
        arguments, result = scenario[1:3]
        program = self.settings_program if scenario in SETTINGS else self.program
        with tempfile.TemporaryDirectory(dir=self.work) as scratch:
            scratch = pathlib.Path(scratch)
            out, home = scratch / "out", scratch / "home"
            out.mkdir()
            home.mkdir()
            if result != "-" and old:
                (out / result).write_bytes(old_content(scenario))
            command = [str(program)] + [a.replace("{out}", str(out)).replace("{http}", self.http)
                                             .replace("{}", str(self.inputs)) for a in arguments]
            environment = {"PATH": os.environ["PATH"], "HOME": str(home), "GHOSTSPACE_FAULT": fault,
                           "GHOSTSPACE_FAULT_COUNT": str(scratch / "count"), "LD_PRELOAD": str(self.shim)}
            try:
                done = subprocess.run(command, env=environment, capture_output=True, timeout=SECONDS, cwd=out)
                status, output, message = done.returncode, done.stdout, done.stderr.decode(errors="replace")
            except subprocess.TimeoutExpired as late:
                status, output, message = "hang", b"", (late.stderr or b"").decode(errors="replace")
            count = scratch / "count"
            calls = struct.unpack("=Q", count.read_bytes())[0] if count.exists() else 0
            made = output if result == "-" else (out / result).read_bytes() if (out / result).exists() else None
            others = sorted(p.name for p in out.iterdir() if p.name != result)
            return status, made, message, calls, others


def old_content(scenario):
    return scenario[3] if len(scenario) > 3 else OLD


def verdict(scenario, found, right, old, kill):
    """Returns a text for a violation, or None."""
    status, made, message, _, others = found
    said = message if scenario[2] != "-" or status in (0, "hang") else message + (made or b"").decode(errors="replace")
    lines = [line for line in said.splitlines() if line.strip()]
    if status == "hang":
        return f"runs longer than {SECONDS} s"
    if status == -9 and kill:
        if scenario[2] != "-" and made not in (old_content(scenario) if old else None, right):
            return "leaves another file after SIGKILL"
        strange = [name for name in others if not name.startswith(".")]
        return "leaves " + ", ".join(strange) if strange else None
    if status < 0:
        return f"ends by signal {-status}: " + (lines[-1] if lines else "no message")
    if "terminate called" in message or "ERROR: " in message:
        return "reports " + lines[0]
    if others:
        return "leaves " + ", ".join(others)
    errors = [line for line in message.splitlines() if line.strip()]
    if len(errors) > 8:
        return f"writes {len(errors)} lines: {errors[0]}"
    if status != 0 and not lines:
        return f"ends with status {status} and no message"
    if made == right:
        return None
    if scenario[2] != "-" and status != 0 and made != (old_content(scenario) if old else None):
        return f"leaves {'no file' if made is None else 'another file'} after status {status}: {lines[0]}"
    if not lines:
        return "gives another result without a message"
    return None


def chosen(calls, most, generator):
    if calls <= most:
        return list(range(1, calls + 1))
    numbers = set(range(1, most // 4 + 1)) | {calls}
    while len(numbers) < most:
        numbers.add(generator.randint(1, calls))
    return sorted(numbers)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, default=40)
    parser.add_argument("-k", choices=KINDS)
    parser.add_argument("-s", default="")
    parser.add_argument("-j", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--shim", type=pathlib.Path)
    parser.add_argument("--settings-program", type=pathlib.Path, default=ROOT / "build/release/tests/save_settings")
    options = parser.parse_args()
    program = pathlib.Path(os.environ.get("GHOSTSPACE", ROOT / "build/release/ghostspace")).resolve()
    violations = runs = 0
    with tempfile.TemporaryDirectory() as work:
        work = pathlib.Path(work)
        shim = options.shim or work / "fault_shim.so"
        if not options.shim:
            subprocess.run(["c++", "-std=c++20", "-O2", "-fPIC", "-shared", str(ROOT / "tests/faults/fault_shim.cpp"),
                            "-o", str(shim), "-ldl"], check=True)
        all_runs = Runs(program, options.settings_program.resolve(), shim.resolve(), work)
        generator = random.Random(options.seed)
        for scenario in SCENARIOS + SETTINGS:
            if options.s not in scenario[0]:
                continue
            status, right, message, _, _ = all_runs.run(scenario, "allocate 0", False)
            rights = {False: right, True: right}
            if scenario in SETTINGS:  # the only ones that keep a part of the old content
                rights[True] = all_runs.run(scenario, "allocate 0", True)[1]
            if status != 0 or None in rights.values():
                print(f"{scenario[0]}: fails without faults: {message}")
                violations += 1
                continue
            for kind in KINDS if not options.k else [options.k]:
                name, _, onwards = kind.partition(" ")
                calls = all_runs.run(scenario, f"{name} 0", False)[3]
                numbers = chosen(calls, options.n, generator)
                found = 0
                with concurrent.futures.ThreadPoolExecutor(options.j) as pool:
                    faults = [f"{name} {number} {onwards}".strip() for number in numbers]
                    olds = [number % 2 == 0 for number in numbers]
                    for fault, old, result in zip(faults, olds, pool.map(all_runs.run, [scenario] * len(faults), faults, olds)):
                        problem = verdict(scenario, result, rights[old], old, onwards == "kill")
                        if problem:
                            found += 1
                            print(f"  {scenario[0]}, {fault}: {problem}", flush=True)
                runs += len(numbers)
                violations += found
                print(f"{scenario[0]}, {kind}: {calls} calls, {len(numbers)} runs, {found} violations", flush=True)
    print(f"{runs} runs, {violations} violations")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
