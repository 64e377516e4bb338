#!/usr/bin/env python3
"""Measures the seconds from the end of a step of a simulation to its first picture: insitu_latency.py BUILD [--example NAME] [...]

Starts BUILD/examples/insitu_NAME (or its Python version with --python), and a window of BUILD/ghostspace in Xvfb that follows
it. A step ends when the server of the simulation names it. Its picture is there when the window has drawn the world of that
step, which its title states. --rate and --rtt put bench/transfer/shaping_proxy.py between the two. --picture saves the window.
"""
import argparse
import json
import os
import re
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

HERE = os.path.dirname(os.path.abspath(__file__))
parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("build")
parser.add_argument("--example", default="heat")
parser.add_argument("--python", action="store_true")
parser.add_argument("--size", type=int, default=96)
parser.add_argument("--every", type=int, default=1)
parser.add_argument("--pause", type=int, default=20, help="milliseconds between two steps (C only)")
parser.add_argument("--share", type=float, default=-1.0, help="-1: the default of the library; 0: unlimited")
parser.add_argument("--seconds", type=float, default=20)
parser.add_argument("--rate", type=int, default=0, help="bits per second; 0: no proxy")
parser.add_argument("--rtt", type=int, default=40, help="milliseconds, with --rate")
parser.add_argument("--port", type=int, default=0, help="port of the simulation; 0 means any free port")
parser.add_argument("--display", type=int, default=97)
parser.add_argument("--picture")
options = parser.parse_args()


def free_port():
    """Returns a local port that no socket uses, not even a closed connection of an earlier run."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


options.port = options.port or free_port()


class Control:
    """Connection to the control socket of a window."""

    def __init__(self, path, token):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.connect(path)
        self.lines = self.socket.makefile("rw")
        self.lines.write(token + "\n")
        self.count = 0

    def call(self, method, **parameters):
        self.count += 1
        self.lines.write(json.dumps({"id": self.count, "method": method, "params": parameters}) + "\n")
        self.lines.flush()
        while True:
            line = self.lines.readline()
            if not line:
                raise OSError("the window closed the connection")
            answer = json.loads(line)
            if answer.get("id") == self.count:
                return answer.get("result")


def simulation(folder):
    common = ["--size", str(options.size), "--steps", "100000000", "--every", str(options.every), "--serve",
              "--port", str(options.port), "--share", str(options.share), "--token-file", folder + "/token"]
    if not options.python:
        return subprocess.Popen([options.build + "/examples/insitu_" + options.example, "--pause", str(options.pause)] + common,
                                stdout=subprocess.DEVNULL)
    source = os.path.join(HERE, "..", "app", "insitu", "python")
    environment = dict(os.environ, PYTHONPATH=source,
                       GHOSTSPACE_INSITU_LIBRARY=os.path.abspath(options.build) + "/lib/libghostspace-insitu.so")
    return subprocess.Popen(["/usr/bin/python3", os.path.join(source, "examples", options.example + ".py")] + common,
                            env=environment, stdout=subprocess.DEVNULL)


ended, shown, stop = {}, {}, False


def watch_steps():
    """Notes when the simulation serves each step."""
    while not stop:
        try:
            with urllib.request.urlopen("http://127.0.0.1:%d/insitu.json" % options.port, timeout=5) as answer:
                ended.setdefault(json.load(answer).get("step"), time.monotonic())
        except OSError:
            pass
        time.sleep(0.01)


processes = []
with tempfile.TemporaryDirectory() as folder:
    try:
        display = ":%d" % options.display
        processes.append(subprocess.Popen(["Xvfb", display, "-screen", "0", "1024x768x24"], stderr=subprocess.DEVNULL))
        processes.append(simulation(folder))
        time.sleep(1)
        if processes[-1].poll() is not None:
            sys.exit("the simulation ended; choose a free port with --port (was %d)" % options.port)
        port = options.port
        if options.rate:
            port = free_port()
            processes.append(subprocess.Popen(
                [sys.executable, os.path.join(HERE, "transfer", "shaping_proxy.py"), str(port), "127.0.0.1:%d" % options.port,
                 "--rate", str(options.rate), "--rtt", str(options.rtt)]))
            time.sleep(0.5)
        watcher = threading.Thread(target=watch_steps)
        watcher.start()
        begun = time.monotonic()
        processes.append(subprocess.Popen(
            [options.build + "/ghostspace", "--control", folder + "/control", "--control-token", folder + "/control-token",
             "http://127.0.0.1:%d/" % port],
            env=dict(os.environ, DISPLAY=display, HOME=folder, XDG_RUNTIME_DIR=folder), stderr=subprocess.DEVNULL))
        token = ""
        while len(token) < 32 or not os.path.exists(folder + "/control"):
            if time.monotonic() - begun > 60:
                sys.exit("the window does not start")
            time.sleep(0.01)
            if os.path.exists(folder + "/control-token"):
                token = open(folder + "/control-token").read().strip()
        control = Control(folder + "/control", token)
        until = time.monotonic() + options.seconds
        while time.monotonic() < until:
            try:
                found = re.search(r", step (\d+), time", (control.call("getBrowser") or {}).get("title") or "")
            except OSError as problem:
                print(problem, file=sys.stderr)
                break
            if found and int(found.group(1)) not in shown:
                control.call("getName")  # is answered after the picture
                shown[int(found.group(1))] = time.monotonic()
            time.sleep(0.01)
        if options.picture:
            subprocess.run(["import", "-window", "root", options.picture], env=dict(os.environ, DISPLAY=display), check=False)
    finally:
        stop = True
        for process in reversed(processes):
            process.terminate()
            process.wait()
waits = sorted(shown[step] - ended[step] for step in shown if step in ended and ended[step] >= begun)
print("%s: window after %.2f s, %d steps served, %d shown" % (
    options.example, min(shown.values(), default=begun) - begun, len(ended), len(shown)))
if waits:
    print("seconds from the end of a step to its first picture: median %.3f, fastest %.3f, slowest %.3f (%d steps)" % (
        statistics.median(waits), waits[0], waits[-1], len(waits)))
