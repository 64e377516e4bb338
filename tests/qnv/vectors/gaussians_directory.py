"""Decodes the directory of clusters of a stream of Gaussians, from FORMAT.md alone, and compares it with the chunks.
Prints a line for each entry: offset, bytes of payload, level, parent (-1 if there is none), vectors, corners of the box.

    python3 gaussians_directory.py STREAM
"""
import struct
import sys

from gaussians_decode import Model, Range, numbers
from streams import all_chunks


class Models:
    """Models by name, made when first used. They are those of the whole directory."""

    def __init__(self):
        self.models = {}
        self.coder = None

    def yes(self, *key):
        return self.coder.yes(self.models.setdefault(key, Model()))

    def tree(self, bits, *key):
        v = 1
        for _ in range(bits):
            v = 2 * v + self.yes(*key, "T", v - 1)
        return v - (1 << bits)

    def long(self, *key):
        n = min(self.tree(5, *key, "L"), 24)
        if n == 0:
            return 0
        v, b = 1, n - 1
        for _ in range(2):
            if b > 0:
                b -= 1
                v = 2 * v + self.yes(*key, "H", n, v - 1)
        return (v << b) + self.coder.bits(b)

    def signed(self, *key):
        number = self.long(*key)
        return -number if number and self.yes(*key, "negative") else number


class Directory:
    def __init__(self):
        self.models, self.entries, self.clusters = Models(), [], []
        self.kind, self.end, self.ratio = 0, 0, 585
        self.parents, self.changes = [0, 0], [0, 0]

    def side(self, number):
        t = self.models.tree(7, "side", number) - 32
        return self.models.signed("far") if t == 95 else t

    def box(self, parent):
        lower, upper = [], []
        for axis in range(3):
            l, u = parent[axis], parent[axis + 3]
            s = max((u - l).bit_length() - 6, 0)
            low = min(max(l + (self.side(0) << s), 0), 65535)
            high = min(max(u - (self.side(1) << s), 0), 65535)
            lower.append(low)
            upper.append(max(low, high))
        return lower + upper

    def entry(self):
        m = self.models
        self.kind = k = int(m.yes("kind", self.kind))
        gap = m.long("gap") if m.yes("any") else 0
        size = 32 * m.tree(6, "bytes", k) + m.coder.bits(5)
        parent = -1
        if k or self.clusters:
            change = m.signed("parent", k, self.changes[k])
            parent = self.parents[k] = self.parents[k] + change
            self.changes[k] = min(abs(change).bit_length() // 5, 3)
            assert 0 <= parent < len(self.clusters)
        assert size > 0
        if k:
            level, box, vectors = *self.clusters[parent], 0
        else:
            vectors = (size * self.ratio >> 12) + m.signed("vectors")
            assert 1 <= vectors <= 16384
            self.ratio += min(4096 * vectors // size, 65535) // 16 - self.ratio // 16
            level = self.clusters[parent][0] + 1 if self.clusters else 0
            assert level <= 254
            box = self.box(self.clusters[parent][1] if self.clusters else [0] * 3 + [65535] * 3)
            self.clusters.append((level, box))
        offset = self.end + gap
        self.end = offset + 10 + size
        self.entries.append((offset, size, level, parent, vectors, *box))

    def add(self, payload):
        (before, count), rest = numbers(payload, 2)
        assert before == len(self.entries) and 1 <= count <= 16384
        self.models.coder = Range(rest)
        for _ in range(count):
            self.entry()
        assert self.models.coder.at <= len(rest) + 8


def main():
    data = open(sys.argv[1], "rb").read()
    at = struct.unpack_from("<I", data, 12)[0]
    assert struct.unpack_from("<Q", data, 84)[0] == len(data) - sum(
        10 + len(payload) for kind, payload in all_chunks(data, at) if kind == 23)
    directory, listed, levels = Directory(), [], []
    for kind, payload in all_chunks(data, at):
        if kind == 20:
            (name, parent, _, _, level), _ = numbers(payload, 5)
            assert name == len(levels)
            levels.append(level)
            listed.append((at, len(payload), level, parent - 1))
        elif kind in (21, 22):
            (cluster,), _ = numbers(payload, 1)
            listed.append((at, len(payload), levels[cluster], cluster))
        elif kind == 23:
            directory.add(payload)
        at += 10 + len(payload)
    assert len(listed) == len(directory.entries)
    for chunk, entry in zip(listed, directory.entries):
        assert chunk == entry[:4]
        print(*entry)


main()
