#!/usr/bin/env python3
"""Measures other ways to look at remote data, through shaping_proxy.py: copying, compressed copying and ParaView.

usage: remote_peers.py [--links 10,1] [--runs 3] [--limit SECONDS] [--only copy,paraview] NAME=FILE ...

Copies of a file (HTTP, `ssh`, `ssh -C`, `zstd -3` and `gzip -6` through ssh, `rsync -z`) run at most `--limit` seconds. Longer ones
report the time that their bytes need at the measured rate, marked with "~". Copies on the fast link give the bytes of the slow one.
ParaView renders FILE on the server (paraview_client.py). A FILE.vti beside FILE replaces it there, because ParaView reads no NRRD of
this size in place. Prints Markdown. Needs nginx or python3, openssh-server, rsync, zstd, paraview and xvfb.
"""
import argparse
import json
import os
import pathlib
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

from remote_link import HERE, LINKS, Account, Display, Link, await_port, end, free_port

COPIES = {
    "ssh": "cat FILE",
    "ssh -C": "cat FILE",
    "ssh, gzip -6": "gzip -6 < FILE",
    "ssh, zstd -3": "zstd -q -3 -T2 < FILE",
}


def file_server(folder, scratch):
    """Starts an HTTP server for a folder; returns its process and port."""
    port = free_port()
    process = subprocess.Popen([sys.executable, "-m", "http.server", str(port), "--bind", "127.0.0.1", "--directory",
                                str(folder)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    await_port(port)
    return process, port


def timed(arguments, link, limit, environment=None):
    """Runs a program. Returns seconds, bytes through the link, and whether the program ended before the limit."""
    start = time.monotonic()
    process = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment,
                               start_new_session=True)
    try:
        status = process.wait(timeout=limit)
        complete = status == 0
    except subprocess.TimeoutExpired:
        complete = False
    seconds = time.monotonic() - start
    end(process)
    time.sleep(0.3)
    return seconds, link.received(), complete


def compressed_bytes(file, program):
    """Returns the bytes that a compressor writes for the file, and its seconds."""
    start = time.monotonic()
    with open(file, "rb") as source:
        process = subprocess.Popen(program, stdin=source, stdout=subprocess.PIPE)
        total = 0
        while data := process.stdout.read(1 << 20):
            total += len(data)
    process.wait()
    return total, time.monotonic() - start


def copies(options, scratch, files):
    account = Account(scratch / "account", "true")
    try:
        copy_all(options, scratch, files, account)
    finally:
        account.end()


def copy_all(options, scratch, files, account):
    size = {}
    for name, file in files.items():
        size[name] = file.stat().st_size
    print("| link | input | way | bytes | of the file | seconds |\n| --- | --- | --- | --: | --: | --: |")
    for link_name in options.links:
        rate = LINKS[link_name][0] / 8
        for name, file in files.items():
            server, port = file_server(file.parent, scratch)
            ways = {"HTTP": (port, lambda p: ["curl", "-s", "-o", "/dev/null", f"http://127.0.0.1:{p}/{file.name}"], None)}
            ssh = ["ssh", "-F", account.folder + "/config"]
            for way, command in COPIES.items():
                extra = ["-C"] if way.endswith("-C") else []
                ways[way] = (account.port, lambda p, c=command, e=extra: [*ssh, *e, "-p", str(p), "127.0.0.1",
                                                                          c.replace("FILE", str(file))], command)
            target = scratch / "copy"
            ways["rsync -z"] = (account.port, lambda p: ["rsync", "-z", "-e", " ".join(ssh) + f" -p {p}",
                                                         f"127.0.0.1:{file}", str(target)], "rsync")
            for way, (far, arguments, command) in ways.items():
                if options.ways and way not in options.ways:
                    continue
                results = []
                for _ in range(options.runs):
                    target.unlink(missing_ok=True)
                    link = Link(scratch, link_name, far)
                    try:
                        results.append(timed(arguments(link.port), link, options.limit))
                    finally:
                        link.end()
                    if not results[-1][2]:
                        break
                target.unlink(missing_ok=True)
                if results[-1][2]:
                    seconds, count = (statistics.median(each[i] for each in results) for i in (0, 1))
                    print(f"| {link_name} | {name} | {way} | {count:,.0f} | {count / size[name]:.3f} | {seconds:.1f} |", flush=True)
                else:
                    seconds, count, _ = results[-1]
                    total = size[name]
                    if "gzip" in way or "zstd" in way:
                        total, _ = compressed_bytes(file, command.split("<")[0].split())
                    elif way in ("ssh -C", "rsync -z"):
                        total, _ = compressed_bytes(file, ["gzip", "-6"])
                    print(f"| {link_name} | {name} | {way} | ~{total:,} | {total / size[name]:.3f} | "
                          f"~{total / rate:.0f} ({count / seconds / rate:.2f} of the rate in {seconds:.0f} s) |", flush=True)
            end(server)


def paraview(options, scratch, files):
    print("| link | input | to the first picture: s | bytes | a turn of ten views: s | bytes | end: s | bytes |\n"
          "| --- | --- | --: | --: | --: | --: | --: | --: |")
    display = Display(scratch, 1200, 900)
    environment = dict(os.environ, DISPLAY=display.name)
    for link_name in options.links:
        for name, file in files.items():
            vti = file.with_suffix(".vti")
            file = vti if vti.exists() else file
            array, low, high = options.arrays.get(name, "density:0:2").split(":")
            rows = []
            for run in range(options.runs):
                port = free_port()
                server = subprocess.Popen(["pvserver", f"--server-port={port}"], env=environment, start_new_session=True,
                                          stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                          stderr=None if options.debug else subprocess.DEVNULL)
                link = client = None
                try:
                    await_port(port)
                    link = Link(scratch, link_name, port)
                    arguments = [str(link.port), str(file), array, low, high, options.compressor]
                    if options.keep:
                        arguments.append(str(options.keep / f"paraview-{name}-{link_name}.png"))
                    client = subprocess.Popen(["pvpython", HERE / "paraview_client.py", *arguments], env=environment,
                                              start_new_session=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                              stderr=None if options.debug else subprocess.DEVNULL, text=True)
                    at = {}
                    for line in client.stdout:
                        if line.startswith("{"):
                            fact = json.loads(line)
                            time.sleep(0.15)  # the log of the link has tenths of a second
                            at[fact["what"]] = fact["at"], link.received()
                    if "end" in at:
                        rows.append((*at["still"], at["turn"][0] - at["interactive"][0], at["turn"][1] - at["interactive"][1],
                                     *at["end"]))
                finally:
                    for process in (client, server):
                        end(process)
                    if link:
                        link.end()
            if rows:
                middle = [statistics.median(row[i] for row in rows) for i in range(6)]
                print(f"| {link_name} | {name} | {middle[0]:.1f} | {middle[1]:,.0f} | {middle[2]:.1f} | {middle[3]:,.0f} | "
                      f"{middle[4]:.1f} | {middle[5]:,.0f} |", flush=True)
            else:
                print(f"| {link_name} | {name} | fails | | | | | |", flush=True)
    display.end()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", metavar="NAME=FILE")
    parser.add_argument("--links", default="10,1", type=lambda text: text.split(","))
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--limit", type=float, default=120)
    parser.add_argument("--only", default="copy,paraview")
    parser.add_argument("--ways", default="", type=lambda text: text.split(";") if text else [])
    parser.add_argument("--array", action="append", default=[], metavar="NAME:ARRAY:LOW:HIGH")
    parser.add_argument("--compressor", default="default", help="image compressor of ParaView, for example 'vtkZlibCompressor 0 9 5 0'")
    parser.add_argument("--keep", type=pathlib.Path, metavar="FOLDER", help="keeps pictures of ParaView")
    parser.add_argument("--debug", action="store_true", help="shows the messages of ParaView")
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # ends the programs that it started
    options.arrays = dict(each.split(":", 1) for each in options.array)
    files = {name: pathlib.Path(file).resolve() for name, file in (each.split("=", 1) for each in options.files)}
    scratch = pathlib.Path(tempfile.mkdtemp(prefix="remote-peers-"))
    try:
        if "copy" in options.only:
            copies(options, scratch, files)
        if "paraview" in options.only:
            paraview(options, scratch, files)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


main()
