#!/usr/bin/env python3
"""serve_load.py [--seconds N] [--clients N]: loads `ghostspace serve` on loopback with many clients, some of them bad.

Of N clients (200), each with an address of its own, one half reads ranges. The others are slow (1 kB/s), half open (a
part of a request, then silence), broken (garbage, cut requests and answers) and greedy (whole files, ten connections
each), an eighth each. After N seconds (60), prints a line per property, and exits with 1 if one is violated:
  - the clients that read ranges get at least a third of their fair share of the --rate, and about equal parts,
  - they get right bytes, and no error,
  - from the first quarter of the time to the end, memory grows by at most 16 MB, or stays below the bound of its
    connections, and descriptors grow by the clients' number,
  - without clients, all their descriptors are closed,
  - of 1,000 clients and more, the server that starts with a limit of 1,024 descriptors serves all,
  - SIGTERM ends the server within 2 s while clients read.

GHOSTSPACE: program instead of build/release/ghostspace.
"""

import argparse
import asyncio
import os
import pathlib
import random
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FILE_BYTES = 8 << 20
PIECE = 64 << 10
RATE = 400_000_000  # bits per second
CONNECTION_BYTES = 120_000  # memory of a connection that has been used
SOFT_LIMIT = 1024  # descriptors that the server may open at first


class Load:
    def __init__(self, port, data, generator):
        self.port, self.data, self.random = port, data, generator
        self.received, self.errors = {}, []
        self.running = True

    async def connect(self, number):
        address = f"127.{10 + number // 250}.0.{1 + number % 250}"
        return await asyncio.open_connection("127.0.0.1", self.port, local_addr=(address, 0), limit=1 << 20)

    async def answer(self, reader):
        """Returns (status, body)."""
        head = await reader.readuntil(b"\r\n\r\n")
        status = int(head.split(b" ", 2)[1])
        length = 0
        for line in head.split(b"\r\n")[1:]:
            name, _, value = line.partition(b":")
            if name.lower() == b"content-length":
                length = int(value)
        return status, await reader.readexactly(length)

    async def read_ranges(self, number):
        self.received[number] = 0
        reader = writer = None
        while self.running:
            try:
                if writer is None:
                    reader, writer = await self.connect(number)
                first = self.random.randrange(0, FILE_BYTES - PIECE)
                writer.write(f"GET /data.bin HTTP/1.1\r\nHost: 127.0.0.1\r\nRange: bytes={first}-{first + PIECE - 1}\r\n\r\n"
                             .encode())
                status, body = await self.answer(reader)
                if status == 429:
                    await asyncio.sleep(0.2)
                elif status != 206 or body != self.data[first:first + PIECE]:
                    self.errors.append(f"status {status}, {len(body)} bytes")
                else:
                    self.received[number] += len(body)
            except (OSError, asyncio.IncompleteReadError) as problem:
                if self.running:
                    self.errors.append(repr(problem))
                writer = None
                await asyncio.sleep(0.2)
        if writer:
            writer.close()

    async def read_slowly(self, number):
        while self.running:
            try:
                reader, writer = await self.connect(number)
                writer.write(b"GET /data.bin HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
                while self.running and await reader.read(1000):
                    await asyncio.sleep(1)
                writer.close()
            except OSError:
                pass
            await asyncio.sleep(0.5)

    async def stay_half_open(self, number):
        while self.running:
            try:
                reader, writer = await self.connect(number)
                writer.write(b"GET /data.bin HTTP/1.1\r\nHost: 127.0"[:self.random.randrange(0, 38)])
                try:
                    await asyncio.wait_for(reader.read(1), 25)
                except asyncio.TimeoutError:
                    pass
                writer.close()
            except OSError:
                pass
            await asyncio.sleep(0.1)

    async def break_rules(self, number):
        parts = [b"GET /data.bin HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", b"GET /../../etc/passwd HTTP/1.1\r\n\r\n",
                 b"POST / HTTP/1.1\r\nContent-Length: 99999999999999999999\r\n\r\n", b"\0" * 5000,
                 b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nRange: bytes=9-1,-,5-\r\n\r\n", b"GET /" + b"a" * 40000]
        while self.running:
            try:
                _, writer = await self.connect(number)
                for _ in range(self.random.randrange(1, 4)):
                    part = self.random.choice(parts)
                    writer.write(part[:self.random.randrange(1, len(part) + 1)])
                    await asyncio.sleep(self.random.random() / 10)
                if self.random.random() < 0.5:
                    writer.transport.abort()
                else:
                    writer.close()
            except OSError:
                pass
            await asyncio.sleep(0.05)

    async def be_greedy(self, number):
        async def whole_files():
            while self.running:
                try:
                    reader, writer = await self.connect(number)
                    writer.write(b"GET /data.bin HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n" * 4)
                    while self.running and await reader.read(1 << 18):
                        pass
                    writer.close()
                except OSError:
                    await asyncio.sleep(0.1)

        await asyncio.gather(*[whole_files() for _ in range(10)])


def memory_of(process):
    for line in pathlib.Path(f"/proc/{process.pid}/status").read_text().splitlines():
        if line.startswith("RssAnon"):
            return int(line.split()[1]) * 1024
    return 0


def descriptors_of(process):
    return len(os.listdir(f"/proc/{process.pid}/fd"))


async def load(process, port, data, options, report):
    of = Load(port, data, random.Random(1))
    half, eighth = options.clients // 2, options.clients // 8
    kinds = [of.read_ranges] * half + [of.read_slowly] * eighth + [of.stay_half_open] * eighth + \
            [of.break_rules] * eighth + [of.be_greedy] * (options.clients - half - 3 * eighth)
    before = descriptors_of(process)
    tasks = [asyncio.create_task(kind(number)) for number, kind in enumerate(kinds)]
    await asyncio.sleep(options.seconds / 4)
    early, early_files = memory_of(process), descriptors_of(process)
    of.received = {number: 0 for number in of.received}
    started = time.monotonic()
    await asyncio.sleep(options.seconds * 3 / 4)
    seconds = time.monotonic() - started
    late, late_files = memory_of(process), descriptors_of(process)
    rates = sorted(bytes_ / seconds for bytes_ in of.received.values())
    share = RATE / 8 / options.clients
    report(rates[0] > share / 3, f"ranges: {rates[0] / 1e3:.0f} to {rates[-1] / 1e3:.0f} kB/s a client, fair share "
                                 f"{share / 1e3:.0f} kB/s")
    report(rates[0] > rates[-1] / 3, f"the slowest gets {rates[0] / rates[-1]:.2f} of the fastest")
    report(not of.errors, f"{len(of.errors)} wrong answers or lost connections" +
           (": " + of.errors[0] if of.errors else ""))
    bound = (late_files - before) // 2 * CONNECTION_BYTES
    report(late - early < 16 << 20 or late < bound, f"memory: {early / 1e6:.1f} MB, then {late / 1e6:.1f} MB")
    report(late_files - early_files < options.clients, f"descriptors: {before}, {early_files}, then {late_files}")
    if options.clients >= 1000:
        report(late_files > SOFT_LIMIT, f"more descriptors than the {SOFT_LIMIT} of the limit at the start")
    return of, tasks, before


async def run(process, port, data, options, report):
    of, tasks, before = await load(process, port, data, options, report)
    # Half of the connections end here; the others while SIGTERM is handled.
    of.running = False
    _, pending = await asyncio.wait(tasks, timeout=30)
    for task in pending:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    for _ in range(300):
        if descriptors_of(process) <= before:
            break
        await asyncio.sleep(0.1)
    report(descriptors_of(process) <= before, f"without clients: {descriptors_of(process)} descriptors, before {before}")
    of.running = True
    tasks = [asyncio.create_task(of.be_greedy(number)) for number in range(5)]
    tasks += [asyncio.create_task(of.read_slowly(number)) for number in range(5, 20)]
    await asyncio.sleep(2)
    started = time.monotonic()
    process.send_signal(signal.SIGTERM)
    while process.poll() is None and time.monotonic() - started < 20:
        await asyncio.sleep(0.01)
    report(process.poll() is not None and time.monotonic() - started < 2,
           f"SIGTERM: ends after {time.monotonic() - started:.2f} s with status {process.poll()}")
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--clients", type=int, default=200)
    options = parser.parse_args()
    program = os.environ.get("GHOSTSPACE", str(ROOT / "build/release/ghostspace"))
    failed = []

    def report(good, text):
        print(("      " if good else "FAIL  ") + text, flush=True)
        if not good:
            failed.append(text)

    with tempfile.TemporaryDirectory() as folder:
        data = random.Random(2).randbytes(FILE_BYTES)
        (pathlib.Path(folder) / "data.bin").write_bytes(data)
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        # This process needs a descriptor per connection. The server starts with the limit of most systems.
        _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
        process = subprocess.Popen([program, "serve", folder, "--http", str(port), "--rate", str(RATE), "--log", "/dev/null"],
                                   stdout=subprocess.DEVNULL,
                                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (min(SOFT_LIMIT, hard), hard)))
        try:
            for _ in range(100):
                try:
                    socket.create_connection(("127.0.0.1", port), 1).close()
                    break
                except OSError:
                    time.sleep(0.1)
            asyncio.run(run(process, port, data, options, report))
        finally:
            if process.poll() is None:
                process.kill()
            process.wait()
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
