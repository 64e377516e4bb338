#!/usr/bin/env python3
"""Forwards TCP connections with a limited rate and an additional delay, for measurements of remote sessions.

  shaping_proxy.py LISTEN HOST:PORT --rate BITS_PER_SECOND --rtt MILLISECONDS [--log FILE]

All connections share the rate of each direction. Bytes leave half of the round-trip time after they arrive. `--log` gets one line per
tenth of a second: seconds since the first connection, bytes received by clients so far.
"""
import argparse
import asyncio
import time


LATENESS = 0.05  # seconds by which sending may catch up


class Direction:
    """Link of one direction: a queue that sends at a rate, and then delays."""

    def __init__(self, rate, delay):
        self.bytes_per_second = rate / 8
        self.delay = delay
        self.free_at = 0.0
        self.sent = 0

    async def carry(self, reader, writer):
        loop = asyncio.get_running_loop()
        waiting = asyncio.Queue(maxsize=256)

        async def deliver():
            while True:
                due, data = await waiting.get()
                await asyncio.sleep(max(0, due - loop.time()))
                if not data:
                    break
                writer.write(data)
                await writer.drain()
                self.sent += len(data)

        task = asyncio.ensure_future(deliver())
        try:
            while data := await reader.read(8192):
                # Time that this process slept too long is not lost to the link.
                self.free_at = max(self.free_at, loop.time() - LATENESS) + len(data) / self.bytes_per_second
                await waiting.put((self.free_at + self.delay, data))
                await asyncio.sleep(max(0, self.free_at - loop.time()))
        except ConnectionError:
            pass
        await waiting.put((loop.time() + self.delay, b""))
        try:
            await task
        except ConnectionError:
            pass
        if writer.can_write_eof():
            try:
                writer.write_eof()
            except OSError:
                pass


async def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("listen", type=int)
    parser.add_argument("target")
    parser.add_argument("--rate", type=float, required=True)
    parser.add_argument("--rtt", type=float, required=True)
    parser.add_argument("--log")
    options = parser.parse_args()
    host, port = options.target.rsplit(":", 1)
    up = Direction(options.rate, options.rtt / 2000)
    down = Direction(options.rate, options.rtt / 2000)
    first = []

    async def serve(reader, writer):
        if not first:
            first.append(time.monotonic())
        await asyncio.sleep(options.rtt / 1000)  # the handshake of TCP
        try:
            far_reader, far_writer = await asyncio.open_connection(host, int(port))
        except OSError:
            writer.close()
            return
        await asyncio.gather(up.carry(reader, far_writer), down.carry(far_reader, writer))
        for one in (writer, far_writer):
            one.close()

    async def note():
        last = -1
        with open(options.log, "w") as log:
            while True:
                await asyncio.sleep(0.1)
                if first and down.sent != last:
                    last = down.sent
                    log.write(f"{time.monotonic() - first[0]:.1f} {last}\n")
                    log.flush()

    server = await asyncio.start_server(serve, "127.0.0.1", options.listen)
    if options.log:
        asyncio.ensure_future(note())
    async with server:
        await server.serve_forever()


asyncio.run(main())
