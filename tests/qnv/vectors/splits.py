"""What a mesh that grows vertex by vertex becomes, worked out from qnv/FORMAT.md ("Splits") alone.

python3 splits.py v1/displaced_splits.qnv [SEGMENTS] > v1/displaced_splits.txt

Lines: "exact BITS ANGLE", "at X Y Z" of each vertex on the finest lattice, "face A B C". Groups are put together from
their parity. SEGMENTS: so many of them alone.
"""
import struct
import sys

from displaced import Coder, Double, Refused, Table, Tail, doubles, dot, minus, payloads_of


class Splits(Tail):
    """The decisions of a tail, other models."""

    def __init__(self, front):
        mark, self.B, middles, self.rule, self.angle, self.vertices, self.faces = struct.unpack_from("<5B2I", front)
        if mark != 255 or not 8 <= self.B <= 20 or middles > 1 or self.rule > 1 or self.angle > 180:
            raise Refused("front")
        super().__init__(front[13:])
        self.middles = middles == 1
        if self.colored or self.b > self.B:
            raise Refused("first mesh")
        self.triangles = [list(t) for t in self.triangles]
        self.places = [list(p) for p in self.places]
        self.next = self.end = len(self.places)
        self.refines = False
        self.models = Table(Double)  # by name and context
        self.off, self.off_digits = Table(doubles), Table(lambda: Table(doubles))

    def decide(self, *context):
        return self.yes(self.models[context])

    def segment(self, payload):
        visits, = struct.unpack_from("<I", payload, 2)
        if visits > 64 * len(payload):
            raise Refused("visits")
        self.coder = Coder(payload[6:])
        for _ in range(visits):
            self.visit()

    def visit(self):
        if self.next == self.end:
            self.refines = self.coder.bits(1) == 1
            if self.refines:
                self.b += 1
                if self.b > self.B:
                    raise Refused("bits")
            self.next, self.end = 0, len(self.places)
        (self.refine if self.refines else self.divide)(self.next)
        self.next += 1

    def ring(self, v):
        """Triangles, their neighbours, whether it is open."""
        at = {}  # from a neighbour to the one behind it, and the triangle between
        for t, corners in enumerate(self.triangles):
            if v in corners:
                k = corners.index(v)
                at[corners[(k + 1) % 3]] = (corners[(k + 2) % 3], t)
        if not at:
            return [], [], False
        starts = set(at) - {behind for behind, _ in at.values()}
        opened = bool(starts)
        n = starts.pop() if opened else min(at, key=lambda x: at[x][1])
        triangles, neighbours = [], [n]
        while n in at and len(triangles) < len(at):
            n, t = at[n]
            triangles.append(t)
            neighbours.append(n)
        return triangles, neighbours if opened else neighbours[:-1], opened

    def refine(self, v):
        _, neighbours, _ = self.ring(v)
        for axis in range(3):
            is_now = self.places[v][axis]
            bits = [self.places[n][axis] & 1 for n in neighbours if n < v and self.places[n][axis] >> 1 == is_now]
            self.places[v][axis] = 2 * is_now + self.decide("low", axis, bits[0] if bits else 2)

    def choice(self, name, n):
        if n < 2:
            return 0
        k = (n - 1).bit_length()
        if n > 16:
            return self.coder.bits(k)
        j = 1
        for _ in range(k):
            j = 2 * j + self.decide(name, n, j)
        return j - (1 << k)

    def divide(self, v):
        triangles, n, opened = self.ring(v)
        c = len(triangles)
        if c == 0:
            return
        p = self.places
        r = max(dot(minus(p[x], p[v]), minus(p[x], p[v])) for x in n)
        big = min(r.bit_length() + 2 * (self.B - self.b), 31)
        f = min(sum(x >= self.end for x in n), 2)
        if not self.yes(self.models["divides", min(c, 11), opened, min(f, 1)], self.models["sizes", big, f]):
            return
        left = right = True
        if not opened:
            first = self.choice("firsts", c)
            last = first + 1 + self.choice("spans", c - 1)
        elif self.decide("one", 0):
            first = self.choice("firsts", c)
            last = first + 1 + self.choice("spans", c - first)
        else:
            left = self.decide("one", 1)
            right = not left
            end = self.choice("firsts", c + 1)
            first, last = (end, c) if left else (0, end)
        if (opened and last > c) or (not opened and (c < 2 or last - first >= c)):
            raise Refused("ring")
        if len(p) >= self.vertices or len(self.triangles) + left + right > self.faces:
            raise Refused("too many")
        at = self.placed(v, n, first if left else None, last if right else None, range(first, last + 1))
        x = len(p)
        p.append(at)
        for k in range(first, last):
            t = self.triangles[triangles[k % c]]
            t[t.index(v)] = x
        if left:
            self.triangles.append([v, n[first % len(n)], x])
        if right:
            self.triangles.append([x, n[last % len(n)], v])

    def placed(self, v, n, first, last, around):
        p, size = self.places, len(n)
        old = p[v]
        l = p[n[first % size]] if first is not None else old
        g = p[n[last % size]] if last is not None else old
        s, out = 0, []
        for axis in range(3):
            o = old[axis]
            e = o
            if self.middles:
                total = o + sum(p[n[k % size]][axis] for k in around)
                e = total // (len(around) + 1)
            if self.decide("as", s, axis):
                at, more = o, 1
            else:
                more = 0
                if l[axis] != o and self.decide("as left", s, axis):
                    at = l[axis]
                elif g[axis] != o and g[axis] != l[axis] and self.decide("as right", s, axis):
                    at = g[axis]
                else:
                    j = max(abs(l[axis] - o), abs(g[axis] - o)).bit_length()
                    lengths = self.off[(s, j)]
                    at = e + self.value(lengths, lengths, self.off_digits[axis])
            s += more
            if not 0 <= at < 1 << self.b:
                raise Refused("lattice")
            out.append(at)
        return out

    def shown(self, v):
        less = self.B - self.b + (self.refines and self.next < self.end and v >= self.next)
        half = 1 << (less - 1) if less else 0
        return [(x << less) + half for x in self.places[v]]


def main(name, most=None):
    data = open(name, "rb").read()
    header = struct.unpack_from("<I", data, 12)[0]
    at, mesh, groups, segments = 108, None, {}, {}
    while at + 6 <= header:
        tag, size = struct.unpack_from("<HI", data, at)
        if tag == 5:
            mesh = Splits(data[at + 6:at + 6 + size])
        at += 6 + size
    at = header
    while at < len(data):
        _, size, kind, _, _ = struct.unpack_from("<HHBBI", data, at)
        payload = data[at + 10:at + 10 + size]
        at += 10 + size
        if kind == 7:
            groups.setdefault(payload[0], []).append(payload)
        if kind == 9:
            segments[struct.unpack_from("<H", payload)[0]] = payload
    for which, group in groups.items():
        assert 32 <= which <= 47
        for payload in payloads_of(group):
            segments[struct.unpack_from("<H", payload)[0]] = payload
    for number in range(len(segments) if most is None else int(most)):
        mesh.segment(segments[number])
    print("exact", mesh.B, mesh.angle)
    for v in range(len(mesh.places)):
        print("at", *mesh.shown(v))
    for t in mesh.triangles:
        print("face", *t)


if __name__ == "__main__":
    main(*sys.argv[1:])
