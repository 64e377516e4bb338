#!/usr/bin/env python3
"""Measures windows that look at remote data through shaping_proxy.py: seconds and bytes to the first picture, 30 and 40 dB.

usage: remote_session.py [--links 10,1] [--runs 3,1] [--limits 60,120] [--keep FOLDER] NAME=WAY:FILE ...

WAY is one of:
  ssh       ssh:// to an sshd on loopback, without streams of earlier sessions; `serve --stdio` encodes FILE there
  ssh-made  the same, after an earlier session has made the stream
  serve     FILE.qnv from `ghostspace serve`, which has made the stream before
  http      FILE, which may be a folder, from nginx (a static server with ranges, as an object store)

Each session has an empty home folder and cache. Seconds count from the start of the program. A picture is the part of the window below
the toolbar and the text of the progress. It is compared with the last picture of the first session that came to rest, which the fast link reaches. The first picture
has at least a quarter of the pixels of that one's foreground. "Rest" is the last change of the picture. The last column compares it with
a window that shows the local FILE. Prints Markdown, medians of the runs, and with --steps each change of the picture.
GHOSTSPACE: program instead of build/release/ghostspace. Needs xvfb, openssh-server, nginx and python3-numpy; python3-pil for --keep.
"""
import argparse
import os
import pathlib
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import zlib

import numpy as np

from remote_link import ROOT, Account, Display, Link, await_port, end, free_port, psnr

WIDTH, HEIGHT = 1024, 768
TOP, BOTTOM = 140, 40  # rows of the toolbar and the progress below it, and of messages at the lower border
PROGRAM = os.path.abspath(os.environ.get("GHOSTSPACE", ROOT / "build/release/ghostspace"))


def cropped(picture):
    return picture[TOP:HEIGHT - BOTTOM]


def foreground(picture):
    """Returns the pixels that differ from the left border of their row."""
    background = np.median(picture[:, :8].astype(np.int16), axis=1)
    return (abs(picture.astype(np.int16) - background[:, None]) > 12).any(axis=2)


def keep(folder, name, picture):
    if folder:
        from PIL import Image

        folder.mkdir(parents=True, exist_ok=True)
        Image.fromarray(picture).save(folder / (name + ".png"), compress_level=1)


class Window:
    """GhostSpace in a window of its own display, with an empty home folder."""

    def __init__(self, scratch, target, options=(), path=None):
        self.home = pathlib.Path(tempfile.mkdtemp(dir=scratch, prefix="home-"))
        self.display = Display(self.home, WIDTH, HEIGHT)
        environment = dict(os.environ, DISPLAY=self.display.name, HOME=str(self.home), XDG_RUNTIME_DIR=str(self.home))
        for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME", "DBUS_SESSION_BUS_ADDRESS",
                     "WAYLAND_DISPLAY", "SSH_ASKPASS", "SSH_AUTH_SOCK"):
            environment.pop(name, None)
        if path:
            environment["PATH"] = path + ":/usr/bin:/bin"
        self.start = time.monotonic()
        self.process = subprocess.Popen([PROGRAM, "--mute", "--size", f"{WIDTH}x{HEIGHT}", *options, target], env=environment,
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                        stderr=open(self.home / "messages", "w"), start_new_session=True)

    def seconds(self):
        return time.monotonic() - self.start

    def picture(self):
        return self.display.picture()

    def end(self):
        end(self.process)
        self.display.end()
        shutil.rmtree(self.home, ignore_errors=True)


def settled(window, least, quiet, most):
    """Waits until the picture has not changed for `quiet` seconds; returns it."""
    last, since = None, 0
    while window.seconds() < most:
        time.sleep(0.5)
        now = window.picture()
        if last is None or not np.array_equal(cropped(now), cropped(last)):
            last, since = now, window.seconds()
        elif window.seconds() > least and window.seconds() - since > quiet:
            break
    return last


class Server:
    """Far end of a session: its port, and the target and options for a window behind a link."""

    def __init__(self, scratch, way, file):
        self.way, self.file, self.account, self.process, self.path = way, file, None, None, None
        self.made = False
        self.cache = pathlib.Path(tempfile.mkdtemp(dir=scratch, prefix="server-"))
        if way in ("ssh", "ssh-made"):
            self.account = Account(self.cache / "account", PROGRAM)
            self.port, self.path = self.account.port, self.account.folder + "/bin"
        elif way == "serve":
            self.port = free_port()
            self.process = subprocess.Popen([PROGRAM, "serve", str(file.parent), "--http", str(self.port), "--cache",
                                             str(self.cache / "made"), "--log", str(self.cache / "log")],
                                            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                            start_new_session=True)
            await_port(self.port)
        else:
            self.port = free_port()
            (self.cache / "nginx.conf").write_text(
                f"daemon off; pid {self.cache}/pid; error_log {self.cache}/errors; worker_processes 1;\n"
                + ("user root;\n" if os.geteuid() == 0 else "") +
                f"events {{ }}\nhttp {{ access_log {self.cache}/log; default_type application/octet-stream;\n"
                f"server {{ listen 127.0.0.1:{self.port}; root {file.parent}; }} }}\n")
            self.process = subprocess.Popen(["/usr/sbin/nginx", "-p", str(self.cache), "-c", str(self.cache / "nginx.conf")],
                                            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                            start_new_session=True)
            await_port(self.port)

    def target(self, port):
        if self.account:
            return f"ssh://127.0.0.1:{port}{self.file}"
        return f"http://127.0.0.1:{port}/{self.file.name}" + (".qnv" if self.way == "serve" else "")

    def prepare(self, scratch):
        """Makes the stream, or removes it; returns the seconds to make it."""
        start = time.monotonic()
        if self.way == "ssh":
            self.account.forget()
        elif self.way == "serve":
            url = f"http://127.0.0.1:{self.port}/{self.file.name}.qnv"
            while subprocess.run(["curl", "-sf", "-r", "0-9", "-o", "/dev/null", url]).returncode != 0:
                time.sleep(0.5)
        elif self.way == "ssh-made" and not self.made:
            home = tempfile.mkdtemp(dir=scratch, prefix="home-")
            environment = dict(os.environ, PATH=self.path + ":/usr/bin:/bin", HOME=home)
            subprocess.run([PROGRAM, "fetch", "--timeout", "900", self.target(self.port) + ".qnv"], env=environment, check=True,
                           stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            self.made = True
        return time.monotonic() - start

    def end(self):
        if self.account:
            self.account.end()
        end(self.process)
        shutil.rmtree(self.cache, ignore_errors=True)


class Record:
    """Pictures of a session, each with its time and the bytes so far."""

    def __init__(self):
        self.steps = []  # seconds, bytes, compressed picture
        self.complete = False
        self.messages = ""

    def add(self, seconds, received, picture):
        self.steps.append((seconds, received, zlib.compress(picture.tobytes(), 1)))

    def picture(self, i):
        return np.frombuffer(zlib.decompress(self.steps[i][2]), np.uint8).reshape(-1, WIDTH, 3)

    def facts(self, reference):
        """Returns seconds and bytes by event."""
        wanted = foreground(reference).sum() / 4
        facts = {"rest": self.steps[-1][:2]}
        for i, (seconds, received, _) in enumerate(self.steps):
            picture = self.picture(i)
            likeness = psnr(picture, reference)
            if "first" not in facts and foreground(picture).sum() > wanted:
                facts["first"], facts["first dB"] = (seconds, received), likeness
            if "first" in facts:
                facts.setdefault("steps", []).append((round(seconds, 1), received, round(likeness, 1)))
            # A bound counts if the picture does not fall below it again.
            for bound in (30, 40):
                if likeness < bound or "first" not in facts:
                    facts.pop(f"{bound} dB", None)
                else:
                    facts.setdefault(f"{bound} dB", (seconds, received))
        facts["final dB"] = likeness
        return facts


def session(options, scratch, server, link_name, limit, kept):
    """Runs one session; returns its record."""
    server.prepare(scratch)
    link = Link(scratch, link_name, server.port)
    window = Window(scratch, server.target(link.port), options.option, server.path)
    record, last, moments, received, busy, shown = Record(), None, [1, 3, 10, 30, 60, 100], 0, 0, False
    try:
        while window.seconds() < limit:
            time.sleep(0.05)
            now, at, so_far = window.picture(), window.seconds(), link.received()
            while moments and at >= moments[0]:
                keep(kept, f"{moments.pop(0):03d}", now)
            if so_far != received:
                received, busy = so_far, at
            if last is None or not np.array_equal(cropped(now), last):
                last = cropped(now)
                record.add(at, received, last)
                shown = shown or foreground(last).sum() > 20_000
            elif shown and min(at - record.steps[-1][0], at - busy) > options.quiet:
                record.complete = True
                break
        keep(kept, "end", window.picture())
        record.messages = (window.home / "messages").read_text()[:400]
    finally:
        window.end()
        link.end()
    return record


def cell(rows, name, size):
    values = [row[name] for row in rows if name in row]
    if len(values) * 2 <= len(rows):
        return "- | - | -"
    seconds, count = (statistics.median(value[i] for value in values) for i in (0, 1))
    return f"{seconds:.1f} | {count / 1e3:,.0f} | {'1/' + format(size / count, ',.0f') if count else '-'}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("inputs", nargs="+", metavar="NAME=WAY:FILE")
    parser.add_argument("--links", default="10,1", type=lambda text: text.split(","))
    parser.add_argument("--runs", default="3,1", type=lambda text: [int(each) for each in text.split(",")],
                        help="sessions, by link")
    parser.add_argument("--limits", default="60,120", type=lambda text: [float(each) for each in text.split(",")],
                        help="seconds of a session, by link")
    parser.add_argument("--quiet", type=float, default=8, help="seconds without a change that end a session")
    parser.add_argument("--keep", type=pathlib.Path, metavar="FOLDER", help="keeps pictures at 1, 3, 10, 30 s and at the end")
    parser.add_argument("--option", action="append", default=[], help="option for the window, for example --orbit=30,20")
    parser.add_argument("--steps", action="store_true", help="prints the changes of each session")
    parser.add_argument("--references", type=pathlib.Path, metavar="FOLDER", help="keeps the pictures of local files there")
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # ends the programs that it started
    scratch = pathlib.Path(tempfile.mkdtemp(prefix="remote-session-"))
    print(f"load {os.getloadavg()[0]:.1f} before\n\n"
          "| link | input, way | first picture: s | kB | of the file | dB | 30 dB: s | kB | of the file | 40 dB: s | kB | of the "
          "file | rest: s | kB | of the file | dB | dB to the local file |\n" + "| --- | --- |" + " --: |" * 15, flush=True)
    try:
        for each in options.inputs:
            name, rest = each.split("=", 1)
            way, file = rest.split(":", 1)
            file = pathlib.Path(file).resolve()
            size = file.stat().st_size if file.is_file() else sum(one.stat().st_size for one in file.rglob("*") if one.is_file())
            stored = options.references / (file.name + ".npy") if options.references else None
            if stored and stored.exists():
                reference = np.load(stored)
            else:
                window = Window(scratch, str(file), options.option)
                reference = settled(window, 10, 6, 240)
                window.end()
                if stored:
                    stored.parent.mkdir(parents=True, exist_ok=True)
                    np.save(stored, reference)
            keep(options.keep, name + "-local", reference)
            server = Server(scratch, way, file)
            try:
                rested = None
                for link_name, limit, runs in zip(options.links, options.limits, options.runs):
                    kept = options.keep / f"{name}-{way}-{link_name}" if options.keep else None
                    records = [session(options, scratch, server, link_name, limit, kept if run == 0 else None)
                               for run in range(runs)]
                    rested = next((one for one in (rested, *records) if one and one.complete), None) or records[-1]
                    last = rested.picture(-1)
                    rows = [record.facts(last) for record in records]
                    row = [cell(rows, "first", size), f"{statistics.median(r.get('first dB', 0) for r in rows):.1f}"]
                    row += [cell(rows, what, size) for what in ("30 dB", "40 dB", "rest")]
                    row.append(f"{statistics.median(r['final dB'] for r in rows):.1f} | {psnr(last, cropped(reference)):.1f}")
                    print(f"| {link_name} | {name}, {way} | " + " | ".join(row) + " |", flush=True)
                    for record, facts in zip(records, rows):
                        if options.steps:
                            print(f"  complete {record.complete}, seconds, bytes and dB: {facts.get('steps')} "
                                  f"{record.messages.strip()}", flush=True)
            finally:
                server.end()
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    print(f"\nload {os.getloadavg()[0]:.1f} after", flush=True)


main()
