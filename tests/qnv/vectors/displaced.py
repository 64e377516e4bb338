"""What a displaced stream decodes to, worked out from qnv/FORMAT.md alone, by nothing that the program shares.

python3 displaced.py v1/displaced_fold.qnv > v1/displaced_fold.txt

Lines: "stage NUMBER DEPTH S COLOURS CLUSTERS BITS", then of each stage "vertex X Y Z" of its lattice, "triangle A B C",
"crease FROM TO", then of what has come "numbers KIND LAYER LEVEL" with pairs of a vertex and its number, for all that
are not 0 (kind n normal, s sideways, 0 to 2 colours), then of the stage that is shown, of every eleventh vertex of its
deepest level, "place VERTEX X Y Z", nine significant digits, and "colour VERTEX R G B".

Of an exact tail that has come as a whole then "exact BITS CREASE", "at X Y Z" of each vertex, on the lattice, with "R G B"
where it has a colour, and "face A B C"; where a chunk says how it is shaded "shading ANGLE", and "normal CORNER X Y Z" of
every eleventh corner; where corners have texture coordinates "texture BITS S T WIDTH HEIGHT" and "corners" with six numbers for
each face; where there is a picture "picture FLAGS" and "file LENGTH ENOUGH CHECKSUM" of its files; where there are normals of the
file's own "own CORNER X Y Z" of every eleventh corner; where a chunk says which patches it covers "cover STAGE PARTS TRIANGLES" and a number for each.

Vertices of a level: those of the base, those of edges in their order (from `from` on), those inside of patches in
their order, j = 1 first.
"""
import heapq
import math
import struct
import sys
import zlib


class Refused(Exception):
    pass


class Model:
    def __init__(self):
        self.p = 32768
        self.n = 0


class Coder:
    """Binary range coding."""

    def __init__(self, data):
        self.data = data
        self.at = 0
        self.range = 0xFFFFFFFF
        self.code = 0
        for _ in range(4):
            self.code = self.code * 256 + self.byte()

    def byte(self):
        at = self.at
        self.at += 1
        if at >= len(self.data) + 8:
            raise Refused("bytes ended")
        return self.data[at] if at < len(self.data) else 0

    def decide(self, bound):
        yes = self.code < bound
        if yes:
            self.range = bound
        else:
            self.code -= bound
            self.range -= bound
        while self.range < 1 << 24:
            self.code = self.code * 256 + self.byte()
            self.range *= 256
        return yes

    def get(self, model):
        yes = self.decide((self.range * min(max(model.p, 64), 65472)) >> 16)
        model.p += (((65535 if yes else 0) - model.p) * (131072 // (2 * model.n + 3))) >> 16
        model.n = min(model.n + 1, 30)
        return yes

    def plain(self):
        return self.decide(self.range >> 1)

    def bits(self, n):
        value = 0
        for _ in range(n):
            value = value * 2 + (1 if self.plain() else 0)
        return value


class Number:
    def __init__(self):
        self.s = [Model() for _ in range(6)]
        self.p = [Model() for _ in range(24)]

    def get(self, coder):
        for i in range(6):
            if not coder.get(self.s[i]):
                return i
        z = 0
        while z < 23 and coder.get(self.p[z]):
            z += 1
        return (1 << z) + coder.bits(z) + 5


class Base:
    """Base mesh."""

    def __init__(self, data):
        self.b = data[0]
        if not 1 <= self.b <= 16:
            raise Refused("lattice")
        self.most = min(131072, 64 * len(data))
        self.coder = Coder(data[1:])
        self.vertices, self.triangles, self.around = [], [], []
        self.sides, self.gates = set(), []  # gates as [a, b, opposite], oldest first
        self.grow()
        self.number_edges()

    def add(self, u, v, w):
        if len({u, v, w}) < 3 or len(self.triangles) >= self.most:
            raise Refused("triangle")
        for x, y, z in ((u, v, w), (v, w, u), (w, u, v)):
            if (x, y) in self.sides:
                raise Refused("side")
            self.sides.add((x, y))
            self.around[x] += 1
            there = [g for g in self.gates if g[0] == y and g[1] == x]
            if there:
                self.gates.remove(there[0])
            elif (y, x) not in self.sides:
                self.gates.append([x, y, z])
        self.triangles.append((u, v, w))

    def place(self, predicted, models):
        out = []
        for value in predicted:
            length = 0
            while length < 19 and self.coder.get(models[length]):
                length += 1
            if length > 0:
                negative = self.coder.plain()
                size = (1 << (length - 1)) + self.coder.bits(length - 1)
                value += -size if negative else size
            out.append(value)
        if min(out) < 0 or max(out) >= 1 << self.b:
            raise Refused("lattice")
        self.vertices.append(tuple(out))
        self.around.append(0)
        return tuple(out)

    def grow(self):
        get = self.coder.get
        fresh, right, left = ([Model() for _ in range(8)] for _ in range(3))
        rim, component = Model(), Model()
        beside_gate, of_first = [Model() for _ in range(20)], [Model() for _ in range(20)]
        last = (1 << (self.b - 1),) * 3
        while get(component):
            first = len(self.vertices)
            for _ in range(3):
                last = self.place(last, of_first)
            self.add(first, first + 1, first + 2)
            v = first
            while v < len(self.vertices):
                ending = [g for g in self.gates if g[1] == v]
                if not ending:
                    v += 1
                    continue
                gate = a, b, o = ending[-1]
                rights = [g[1] for g in self.gates if g[0] == b]
                lefts = [g[0] for g in self.gates if g[1] == a]
                r = rights[-1] if rights else None
                l = lefts[-1] if lefts else None
                if l == r:
                    l = None
                ca, cb = min(self.around[a], 7), min(self.around[b], 7)
                if get(fresh[cb]):
                    top = (1 << self.b) - 1
                    p = [min(max(x + y - z, 0), top)
                         for x, y, z in zip(self.vertices[a], self.vertices[b], self.vertices[o])]
                    self.place(p, beside_gate)
                    x = len(self.vertices) - 1
                elif r is not None and get(right[cb]):
                    x = r
                elif l is not None and get(left[ca]):
                    x = l
                elif get(rim):
                    self.gates.remove(gate)
                    continue
                else:
                    x = self.coder.bits(len(self.vertices).bit_length())
                    if x >= len(self.vertices):
                        raise Refused("vertex")
                self.add(b, a, x)

    def number_edges(self):
        self.edges, self.patch_edges = [], []  # edges as [from, to, owner, other, crease]
        at = {}
        for t, corners in enumerate(self.triangles):
            mine = []
            for k in range(3):
                a, b = corners[k], corners[(k + 1) % 3]
                if (b, a) in at:
                    e = at[(b, a)]
                    self.edges[e][3] = t
                else:
                    e = len(self.edges)
                    self.edges.append([a, b, t, None, False])
                    at[(a, b)] = e
                mine.append(e)
            self.patch_edges.append(mine)
        crease, ends = [Model() for _ in range(3)], set()
        for edge in self.edges:
            if edge[3] is None:
                continue
            if self.coder.get(crease[(edge[0] in ends) + (edge[1] in ends)]):
                edge[4] = True
                ends.update(edge[:2])

    def line(self, e):
        return self.edges[e][3] is None or self.edges[e][4]


class Stage:
    def __init__(self, data):
        self.depth, self.s, flags, self.clusters = data[:4]
        if self.depth > 8 or not 1 <= self.s <= 24 or flags > 3:
            raise Refused("stage")
        self.colored = flags & 1 == 1
        self.beside = flags & 2 == 2
        self.base = Base(data[4:])
        if not self.base.triangles:
            raise Refused("empty")
        self.come = 0
        self.has = set()
        self.numbers = {}  # (kind, layer, level) -> {vertex: value}
        self.owner = {}
        for t, corners in enumerate(self.base.triangles):
            for v in corners:
                self.owner.setdefault(v, t)
        self.make_slots()

    def edge_start(self, e, level):
        return len(self.base.vertices) + e * ((1 << level) - 1)

    def inner_start(self, p, level):
        n = 1 << level
        return len(self.base.vertices) + len(self.base.edges) * (n - 1) + p * ((n - 1) * (n - 2) // 2)

    def vertices_at(self, level):
        return self.inner_start(len(self.base.triangles), level)

    def vertex(self, p, level, i, j):
        """The number of a place of a patch."""
        n = 1 << level
        corners = self.base.triangles[p]
        if (i, j) in ((0, 0), (n, 0), (0, n)):
            return corners[0 if i + j == 0 else 1 if i else 2]
        if j == 0 or i + j == n or i == 0:
            k, t = (0, i) if j == 0 else (1, j) if i + j == n else (2, n - j)
            e = self.base.patch_edges[p][k]
            if self.base.edges[e][0] != corners[k]:
                t = n - t
            return self.edge_start(e, level) + t - 1
        return self.inner_start(p, level) + sum(n - 1 - y for y in range(1, j)) + i - 1

    # Clusters

    def add(self, kind, level, layer, first, count, data):
        if level > self.depth or first + count > len(self.base.triangles) or (kind == 2 and not self.colored):
            raise Refused("cluster")
        keys = {(kind, level, layer if kind == 1 else 0, p) for p in range(first, first + count)}
        if keys & self.has:
            raise Refused("twice")
        self.has |= keys
        self.come += 1
        coder = Coder(data)
        for channel in ("n",) if kind == 1 else (0, 1, 2):
            self.sequence(coder, channel, level, layer if kind == 1 else 0, first, count)

    def sequence(self, coder, kind, level, layer, first, count):
        filled, zero = [Model() for _ in range(3)], [Model() for _ in range(5)]
        sizes = [Number() for _ in range(4)]

        def residual(c):
            if not coder.get(zero[(0, 1, 2, 3, 3, 3, 4)[min(c, 6)]]):
                return 0
            negative = coder.plain()
            size = min(sizes[min(c // 3, 3)].get(coder), 32766) + 1
            return -size if negative else size

        now = self.numbers.setdefault((kind, layer, level), {})
        run = range(first, first + count)
        if level == 1:
            base = self.numbers.setdefault((kind, layer, 0), {})
            for p in run:
                for v in self.base.triangles[p]:
                    if self.owner[v] == p:
                        base[v] = residual(0)
        n = 1 << level
        empties = 0
        for p in run:
            if not coder.get(filled[empties]):
                empties = min(empties + 1, 2)
                continue
            empties = 0
            known = {}
            for k in range(3):
                e = self.base.patch_edges[p][k]
                owner = self.base.edges[e][2]
                if owner not in run:
                    continue
                before = 0
                for t in range(1, n, 2):
                    place = (t, 0) if k == 0 else (n - t, t) if k == 1 else (0, n - t)
                    v = self.vertex(p, level, *place)
                    if owner == p:
                        now[v] = residual(2 * before)
                        if kind == "n" and self.base.line(e):
                            self.numbers.setdefault(("s", layer, level), {})[v] = residual(2 * before)
                    before = known[place] = min(abs(now.get(v, 0)), 255)
            for j in range(1, n):
                for i in range(1, n - j):
                    if i % 2 == 0 and j % 2 == 0:
                        continue
                    v = self.vertex(p, level, i, j)
                    now[v] = residual(known.get((i - 1, j), 0) + known.get((i, j - 1), 0) + known.get((i + 1, j - 1), 0))
                    known[(i, j)] = min(abs(now[v]), 255)

    def number(self, kind, layer, level, vertex):
        return self.numbers.get((kind, layer, level), {}).get(vertex, 0)

    # Places

    def make_slots(self):
        """self.slot[p][k]: the slot of a corner."""
        sets = {(p, k): (p, k) for p in range(len(self.base.triangles)) for k in range(3)}

        def find(x):
            while sets[x] != x:
                x = sets[x]
            return x

        for e, edge in enumerate(self.base.edges):
            if self.base.line(e):
                continue
            for v in edge[:2]:
                one = (edge[2], self.base.triangles[edge[2]].index(v))
                sets[find(one)] = find((edge[3], self.base.triangles[edge[3]].index(v)))
        self.slot = [[find((p, k)) for k in range(3)] for p in range(len(self.base.triangles))]

    def slot_of(self, p, level, i, j):
        """A name for the slot that a place of a patch has."""
        n = 1 << level
        if (i, j) in ((0, 0), (n, 0), (0, n)):
            return self.slot[p][0 if i + j == 0 else 1 if i else 2]
        v = self.vertex(p, level, i, j)
        k = 0 if j == 0 else 1 if i + j == n else 2 if i == 0 else None
        if k is not None:
            edge = self.base.edges[self.base.patch_edges[p][k]]
            if edge[4] and self.two_sided(edge):
                return ("side", v, p)
        return ("vertex", v)

    def corner_slot(self, p, v):
        return self.slot[p][self.base.triangles[p].index(v)]

    def two_sided(self, edge):
        return any(self.corner_slot(edge[2], v) != self.corner_slot(edge[3], v) for v in edge[:2])

    def normals(self, level, places):
        sums = {}
        n = 1 << level
        for p in range(len(self.base.triangles)):
            for j in range(n):
                for i in range(n - j):
                    for corners in ([(i, j), (i + 1, j), (i, j + 1)],
                                    [(i + 1, j), (i + 1, j + 1), (i, j + 1)] if i + j + 1 < n else None):
                        if not corners:
                            continue
                        a, b, c = (places[self.vertex(p, level, *x)] for x in corners)
                        face = cross(minus(b, a), minus(c, a))
                        for x in corners:
                            s = self.slot_of(p, level, *x)
                            sums[s] = plus(sums.get(s, (0, 0, 0)), face)
        return {s: unit(n) for s, n in sums.items()}

    def step(self, layer):
        return 2.0 ** -(self.s + 2 * layer)

    def new_vertices(self, level):
        """(vertex, A, B, slot of A, of B, edge, other slots)"""
        n = 1 << level
        for e, (_, _, owner, other, crease) in enumerate(self.base.edges):
            k = self.base.patch_edges[owner].index(e)
            on = lambda patch, t: self.along(patch, e, level - 1, t)
            for t in range(1, n, 2):
                a, b = on(owner, t // 2), on(owner, t // 2 + 1)
                far = None
                if crease and self.two_sided(self.base.edges[e]):
                    x, y = on(other, t // 2), on(other, t // 2 + 1)
                    far = (self.slot_of(other, level - 1, *x), self.slot_of(other, level - 1, *y))
                v = self.edge_start(e, level) + t - 1
                yield (v, self.vertex(owner, level - 1, *a), self.vertex(owner, level - 1, *b),
                       self.slot_of(owner, level - 1, *a), self.slot_of(owner, level - 1, *b), e, far)
        for p in range(len(self.base.triangles)):
            for j in range(1, n):
                for i in range(1, n - j):
                    if i % 2 == 0 and j % 2 == 0:
                        continue
                    x, y = i // 2, j // 2
                    a = (x + 1, y) if i % 2 and j % 2 else (x, y)
                    b = (x + 1, y) if j % 2 == 0 else (x, y + 1)
                    yield (self.vertex(p, level, i, j), self.vertex(p, level - 1, *a), self.vertex(p, level - 1, *b),
                           self.slot_of(p, level - 1, *a), self.slot_of(p, level - 1, *b), None, None)

    def along(self, patch, e, level, t):
        """The place of a patch t steps from an edge's `from`."""
        n = 1 << level
        k = self.base.patch_edges[patch].index(e)
        if self.base.triangles[patch][k] != self.base.edges[e][0]:
            t = n - t
        return (t, 0) if k == 0 else (n - t, t) if k == 1 else (0, n - t)

    def kept(self, level):
        """(vertex, its number a level before)"""
        n = 1 << level
        for p in range(len(self.base.triangles)):
            for j in range(0, n + 1, 2):
                for i in range(0, n + 1 - j, 2):
                    yield self.vertex(p, level, i, j), self.vertex(p, level - 1, i // 2, j // 2)

    def places(self):
        places = {v: tuple((x + 0.5) / (1 << self.base.b) for x in q) for v, q in enumerate(self.base.vertices)}
        at_slots = self.normals(0, places)
        direction = {v: (0, 0, 0) for v in places}
        for p, corners in enumerate(self.base.triangles):
            for k, v in enumerate(corners):
                direction[v] = plus(direction[v], at_slots[self.slot[p][k]])
        shifts = {}
        for v in places:
            n = unit(direction[v])
            shifts[v] = (0, 0, 0)
            for layer in range(4):
                by = times(n, self.step(layer) * self.number("n", layer, 0, v))
                if layer == 0:
                    places[v] = plus(places[v], by)
                else:
                    shifts[v] = plus(shifts[v], by)
        for level in range(1, self.depth + 1):
            normals = self.normals(level - 1, places)
            next_places, next_shifts = {}, {}
            for v, before in self.kept(level):
                next_places[v], next_shifts[v] = places[before], shifts[before]
            for v, ia, ib, sa, sb, e, far in self.new_vertices(level):
                a, b, na, nb = places[ia], places[ib], normals[sa], normals[sb]
                n = plus(na, nb)
                if far:
                    n = plus(n, plus(normals[far[0]], normals[far[1]]))
                n = unit(n) if length(n) > 1e-6 else na
                m = times(plus(a, b), 0.5)
                line = e is not None and self.base.line(e)
                s = (0, 0, 0)
                if line:
                    s = unit(cross(minus(b, a), n))
                else:
                    h = times(plus(times(na, dot(na, minus(a, m))), times(nb, dot(nb, minus(b, m)))), 0.25)
                    most = 0.15 * length(minus(b, a))
                    if length(h) > most:
                        h = times(unit(h), most)
                    m = plus(m, h)
                shift = times(plus(shifts[ia], shifts[ib]), 0.5)
                for layer in range(4):
                    by = plus(times(n, self.step(layer) * self.number("n", layer, level, v)),
                              times(s, self.step(layer) * self.number("s", layer, level, v)))
                    if layer == 0:
                        m = plus(m, by)
                    else:
                        shift = plus(shift, by)
                next_places[v], next_shifts[v] = m, shift
            places, shifts = next_places, next_shifts
        return [plus(places[v], shifts[v]) for v in range(self.vertices_at(self.depth))]

    def colours(self):
        if not self.colored or (0, 0, 0) not in self.numbers:
            return []
        steps = (6, 12, 12)
        own = lambda level, v: tuple(steps[c] * self.number(c, 0, level, v) for c in range(3))
        now = {v: plus((128, 0, 0), own(0, v)) for v in range(len(self.base.vertices))}
        for level in range(1, self.depth + 1):
            after = {v: now[before] for v, before in self.kept(level)}
            for v, a, b, *_ in self.new_vertices(level):
                after[v] = plus(tuple((x + y) >> 1 for x, y in zip(now[a], now[b])), own(level, v))
            now = after
        return [to_rgb(*now[v]) for v in range(len(now))]


class Double:
    def __init__(self):
        self.fast = self.slow = 32768
        self.n = 0

    def learn(self, yes):
        target = 65535 if yes else 0
        self.fast += ((target - self.fast) * (131072 // (2 * min(self.n, 30) + 3))) >> 16
        self.slow += ((target - self.slow) * (131072 // (2 * self.n + 3))) >> 16
        self.n = min(self.n + 1, 254)


class Table(dict):
    """Models that are made when they are asked for."""

    def __init__(self, make):
        self.make = make

    def __missing__(self, key):
        self[key] = self.make()
        return self[key]


def doubles():
    return Table(Double)


def grade(x):
    return x if x < 4 else 4 * (x.bit_length() - 2) + (x >> (x.bit_length() - 3)) % 4


def reduce(v, n):
    shift = max(0, max(abs(c) for c in v).bit_length() - n)
    return tuple(c >> shift for c in v)


class Tail:
    """Exact tail."""

    def __init__(self, data):
        flags, self.b, self.crease, self.count, self.most = struct.unpack_from("<BBBII", data, 0)
        if flags > 31 or not 8 <= self.b <= 20 or self.crease > 180 or not 1 <= self.most <= 64 * len(data):
            raise Refused("tail")
        self.colored = flags & 1 == 1
        if flags & 2:
            self.weights = [[2048, -2048, 2048, -2048] + [0] * 4] * 2 + [[4096, -4096] + [0] * 6] * 4
        else:
            weights = struct.unpack_from("<48h", data, 11 + (flags >> 2 & 1) + (flags >> 3 & 1) + 17 * (flags >> 4))
            self.weights = [weights[8 * i:8 * i + 8] for i in range(6)]
        self.finest = data[11] if flags & 4 else self.b
        if not self.b <= self.finest <= 20:
            raise Refused("finest")
        self.cell_bits = data[11 + (flags >> 2 & 1)] if flags & 8 else 0
        if flags & 8 and not 1 <= self.cell_bits <= 5:
            raise Refused("cells")
        self.lattice = struct.unpack_from("<B4f", data, 11 + (flags >> 2 & 1) + (flags >> 3 & 1)) if flags & 16 else None
        if self.lattice and not (1 <= self.lattice[0] <= 16 and min(self.lattice[3:]) >= 0):
            raise Refused("lattice")
        self.corners = Corners(self) if self.lattice else None
        self.twin = {}
        self.ranks, self.last_rank, self.rank_models = {}, 0, Table(doubles)
        self.coder = Coder(data[(11 if flags & 2 else 107) + (flags >> 2 & 1) + (flags >> 3 & 1) + 17 * (flags >> 4):])
        self.places, self.colours, self.marks, self.turns, self.triangles = [], [], [], [], []
        self.state, self.behind, self.before = [], [], []
        self.waiting, self.clock = {}, 0  # (gap, when) -> (side, behind)
        self.close, self.close2, self.fresh, self.twice, self.twice2 = (doubles() for _ in range(5))
        self.left, self.rim = doubles(), doubles()
        self.starts, self.start_digits = Table(doubles), Table(doubles)
        self.along, self.gap_along, self.across, self.fold = (Table(doubles) for _ in range(4))
        self.digits, self.digits2 = Table(lambda: Table(doubles)), Table(lambda: Table(doubles))
        self.tint, self.tint2, self.tint_digits = Table(doubles), Table(doubles), Table(lambda: Table(doubles))
        self.grow()

    # Decisions

    def yes(self, *models):
        models = models if len(models) == 2 else models * 2
        p = sum(m.fast + m.slow for m in models) >> 2
        yes = self.coder.decide((self.coder.range * min(max(p, 64), 65472)) >> 16)
        for m in set(models):
            m.learn(yes)
        return yes

    def value(self, one, other, digits):
        length = 0
        while length < 23 and self.pair(one[length], other[length]):
            length += 1
        if length == 0:
            return 0
        negative = self.coder.plain()
        size, left, which = 1, length - 1, 0
        for _ in range(2):
            if left:
                left -= 1
                bit = self.yes(digits[length][which])
                size = 2 * size + bit
                which = 2 if bit else 1
        size = (size << left) + self.coder.bits(left)
        return -size if negative else size

    def pair(self, one, other):
        if one is not other:
            return self.yes(one, other)
        yes = self.coder.decide((self.coder.range * min(max((one.fast + one.slow) >> 1, 64), 65472)) >> 16)
        one.learn(yes)
        one.learn(yes)
        return yes

    # Sides

    def start(self, side):
        return self.triangles[side // 3][side % 3]

    def end(self, side):
        return self.triangles[side // 3][(side % 3 + 1) % 3]

    def opposite(self, side):
        return self.triangles[side // 3][(side % 3 + 2) % 3]

    def triangle(self, a, b, c):
        if len({a, b, c}) < 3 or len(self.triangles) >= self.most:
            raise Refused("triangle")
        self.triangles.append((a, b, c))
        for v in (a, b, c):
            self.turns[v] += 1
        self.state += ["open"] * 3
        self.behind += [None] * 3
        self.before += [None] * 3
        return len(self.state) - 3

    def join(self, one, other):
        self.state[one] = self.state[other] = "joined"
        self.twin[one], self.twin[other] = other, one

    def link(self, side, behind):
        self.behind[side] = behind
        self.before[behind] = side

    def wait(self, *sides):
        for side in sides:
            if self.state[side] == "open":
                key = (self.rank(self.places[self.end(side)]), self.gap(side), self.clock)
                self.waiting[key] = (side, self.behind[side])
                heapq.heappush(self.queue, key)
                self.clock += 1

    def rank(self, place):
        if not self.cell_bits:
            return 0
        cell = tuple(c >> (self.b - self.cell_bits) for c in place)
        if cell not in self.ranks:
            node = 1
            for _ in range(3):
                node = 2 * node + self.yes(self.rank_models[self.last_rank][node])
            self.ranks[cell] = self.last_rank = node - 8
        return self.ranks[cell]

    def gap(self, side):
        a, b, o, r = (self.places[v] for v in (self.start(side), self.end(side), self.opposite(side),
                                               self.end(self.behind[side])))
        both = dot(minus(a, b), minus(a, b)) + dot(minus(r, b), minus(r, b))
        gap = 32 * dot(minus(a, r), minus(a, r)) // both if both else 0
        one = reduce(cross(minus(b, a), minus(o, a)), 30)
        other = reduce(cross(minus(a, b), minus(r, b)), 30)
        return 128 - gap if dot(one, other) < 0 else gap

    # Growth

    def grow(self):
        self.queue = []
        while len(self.triangles) < self.most:
            first = len(self.places)
            for k in range(3):
                at = self.places[-1] if self.places else (1 << (self.b - 1),) * 3
                lengths = self.starts[min(k, 1)]
                place = tuple(c + self.value(lengths, lengths, self.start_digits) for c in at)
                colour, mark = None, 8
                if self.colored:
                    colour, mark = self.colour(self.colours[-1] if self.colours else (128, 0, 0), 24)
                self.vertex(place, colour, [8, 8, mark])
            side = self.triangle(first, first + 1, first + 2)
            for k in range(3):
                self.link(side + k, side + (k + 1) % 3)
            self.wait(side, side + 1, side + 2)
            self.dress()
            while self.queue:
                key = heapq.heappop(self.queue)
                side, behind = self.waiting.pop(key)
                if self.state[side] == "open" and self.behind[side] == behind:
                    self.beside(side, key[1])
                    self.dress()
        if len(self.places) != self.count or self.coder.bits(16) != 0x5143:
            raise Refused("end")

    def dress(self):
        while self.corners and len(self.corners.told) < len(self.triangles):
            self.corners.triangle(len(self.corners.told))

    def vertex(self, place, colour, mark):
        if min(place) < 0 or max(place) >= 1 << self.b or len(self.places) >= self.count:
            raise Refused("vertex")
        self.places.append(place)
        self.marks.append(mark)
        self.turns.append(0)
        if self.colored:
            self.colours.append(colour)
            if not all(0 <= c <= 255 for c in self.rgb(colour)):
                raise Refused("colour")

    def rgb(self, colour):
        y, co, cg = colour
        t = y - (cg >> 1)
        b = t - (co >> 1)
        return b + co, cg + t, b

    def colour(self, expected, activity):
        out, k, total = [], 0, 0
        for channel in range(3):
            off = self.value(self.tint[(channel, min(grade(activity) // 2, 15))], self.tint2[(channel, k)],
                             self.tint_digits[channel])
            out.append(expected[channel] + off)
            k = min(abs(off).bit_length(), 9)
            total += abs(off)
        return tuple(out), min(4 * total, 4000)

    def beside(self, g, m):
        n, p = self.behind[g], self.before[g]
        a, b, o, r, l = self.start(g), self.end(g), self.opposite(g), self.end(n), self.start(p)
        if r == a:
            raise Refused("chain")
        closes = self.state[n] == "open"
        u = minus(self.places[a], self.places[b])
        v = minus(self.places[r], self.places[b])
        uu, vv = dot(u, u), dot(v, v)
        e = int(uu > 2 * vv or vv > 2 * uu)
        turns = lambda x: min(self.turns[x], 9)
        here, ends = (m // 4, turns(b), e), (m // 8, turns(a), turns(r))
        if closes and self.yes(self.close[here], self.close2[ends]):
            side = self.triangle(b, a, r)
            after = self.behind[n]
            self.join(g, side)
            self.join(n, side + 2)
            if after == p and self.state[p] == "open":
                self.join(p, side + 1)
                return
            self.link(p, side + 1)
            self.link(side + 1, after)
            self.wait(p, side + 1)
        elif self.yes(self.fresh[(m // 4, turns(b) if closes else 0)]):
            two = closes and self.yes(self.twice[here], self.twice2[ends])
            x = len(self.places)
            self.place(g, m, two)
            side = self.triangle(b, a, x)
            self.join(g, side)
            self.link(p, side + 1)
            if two:
                after = self.behind[n]
                other = self.triangle(b, x, r)
                self.join(side + 2, other)
                self.join(n, other + 2)
                self.link(side + 1, other + 1)
                self.link(other + 1, after)
                self.wait(p, side + 1, other + 1)
            else:
                self.link(side + 1, side + 2)
                self.link(side + 2, n)
                self.wait(p, side + 1, side + 2)
        elif self.state[p] == "open" and self.yes(self.left[closes]):
            side = self.triangle(b, a, l)
            first = self.before[p]
            self.join(g, side)
            self.join(p, side + 1)
            self.link(first, side + 2)
            self.link(side + 2, n)
            self.wait(first, side + 2)
        elif self.yes(self.rim[self.state[n] == "rim"]):
            self.state[g] = "rim"
        else:
            h = self.coder.bits(len(self.state).bit_length())
            if h >= len(self.state) or self.state[h] == "joined":
                raise Refused("side")
            w = self.before[h]
            side = self.triangle(b, a, self.start(h))
            self.join(g, side)
            self.link(p, side + 1)
            self.link(side + 1, h)
            self.link(w, side + 2)
            self.link(side + 2, n)
            self.wait(p, side + 1, w, side + 2)

    def place(self, g, m, two):
        n, p = self.behind[g], self.before[g]
        f = self.behind[n]
        ia, ib, io, ir = self.start(g), self.end(g), self.opposite(g), self.end(n)
        a, b, o, r, o2 = (self.places[v] for v in (ia, ib, io, ir, self.opposite(n)))
        others = [self.places[v] for v in (self.start(p), self.end(f), self.opposite(p), self.opposite(f))]
        closes = self.state[n] == "open"
        situation = (0 if m < 48 else 1) if two else 5 if not closes else 2 if m < 48 else 3 if m < 64 else 4
        top = (1 << self.b) - 1
        near = [minus(q, b) for q in [a, o, r, o2] + others]
        at = [min(max(b[k] + ((sum(w * q[k] for w, q in zip(self.weights[situation], near)) + 2048) >> 12), 0), top)
              for k in range(3)]
        one, other = cross(minus(b, a), minus(o, a)), cross(minus(r, b), minus(o2, b))
        normal = one
        if closes:
            normal = plus(normal, other)
        if two:
            normal = plus(normal, cross(minus(a, b), minus(r, b)))
        normal = reduce(normal, 30)
        z = max(range(3), key=lambda k: (abs(normal[k]), -k))
        x, y = (z + 1) % 3, (z + 2) % 3
        it = ir if two else io
        along = sum(self.marks[v][0] for v in (ia, ib, it)) // 2
        across = sum(self.marks[v][1] for v in (ia, ib, it)) // 2
        d = int(two)
        edges = dot(minus(a, b), minus(a, b)) + dot(minus(o, b), minus(o, b))
        s = min(max(edges.bit_length() // 2 - 2, 0), 7)
        rank = lambda i: min(grade(i), 39)
        place = list(at)

        def step(axis, i):
            off = self.value(self.along[(d, rank(i), s)], self.gap_along[(d, m // 4, 2 * rank(i) // 5)],
                             self.digits[d])
            place[axis] += off
            return abs(off)

        qx = step(x, along)
        q = qx + step(y, (2 * along + 12 * qx) // 3)
        flat = at[z]
        if normal[z]:
            c = normal[x] * (place[x] - at[x]) + normal[y] * (place[y] - at[y])
            k = abs(normal[z])
            flat = min(max(at[z] + (2 * (-c if normal[z] > 0 else c) + k) // (2 * k), 0), top)
        one, other = reduce(one, 14), reduce(other, 14)
        square, both = dot(one, one) * dot(other, other), dot(one, other)
        i = (square - both * both) // max(1, square >> 16) if square else 0
        if both < 0:
            i = 131072 - min(i, 131072)
        h = min(grade(i) // 2, 32)
        off = self.value(self.across[(d, rank(across), min(q.bit_length(), 7))],
                         self.fold[(d, h, 2 * rank(across) // 5)], self.digits2[d])
        place[z] = flat + off
        colour, mark = None, 8
        if self.colored:
            from_ = [self.colours[v] for v in ([ia, ib, ir] if two else [ia, ib])]
            mean = tuple(sum(c[k] for c in from_) // len(from_) for k in range(3))
            colour, mark = self.colour(mean, sum(self.marks[v][2] for v in (ia, ib, it)))
        self.vertex(tuple(place), colour, [min(4 * q, 4000), min(8 * abs(off), 4000), mark])


class Corners:
    """Corners: where those of each triangle lie in the texture."""

    def __init__(self, tail):
        self.tail, self.top = tail, (1 << tail.lattice[0]) - 1
        self.told, self.last, self.turn = [], (0, 0), 1
        self.at, self.several, self.off = {}, set(), {}  # of vertices: where it was told to lie last, ...
        self.same, self.other, self.again = doubles(), Double(), Double()
        self.sizes, self.before, self.digits = Table(doubles), Table(doubles), Table(lambda: Table(doubles))

    def beside(self, side, step):
        twin = self.tail.twin.get(side)
        return None if twin is None or twin // 3 >= len(self.told) else self.told[twin // 3][(twin % 3 + step) % 3]

    def triangle(self, t):
        tail, found, apart = self.tail, [None] * 3, 0
        for k, v in enumerate(tail.triangles[t]):
            places = [self.beside(3 * t + k, 1), self.beside(3 * t + (k + 2) % 3, 0)]
            places = [q for i, q in enumerate(places) if q is not None and q not in places[:i]]
            if places:
                if tail.yes(self.same[(apart, v in self.several, len(places))]):
                    found[k] = places[0]
                    continue
                apart += 1
                if len(places) == 2 and tail.yes(self.other):
                    found[k] = places[1]
                    continue
            if v in self.at and self.at[v] not in places and tail.yes(self.again):
                found[k] = self.at[v]
        while None in found:
            self.place(t, found.index(None), found)
        (a, b), (c, d) = minus(found[1], found[0]), minus(found[2], found[0])
        if a * d != b * c:
            self.turn = 1 if a * d > b * c else -1
        self.told.append(tuple(found))
        for v, q in zip(tail.triangles[t], found):
            if self.at.setdefault(v, q) != q:
                self.several.add(v)
            self.at[v] = q

    def expected(self, t, k, found):
        i, j = (k + 1) % 3, (k + 2) % 3
        if found[i] is None and found[j] is None:
            return "alone", self.last
        if found[i] is None or found[j] is None:
            return "beside", found[j] if found[i] is None else found[i]
        vertices = self.tail.triangles[t]
        from_ = self.tail.places[vertices[i]]
        edge, corner = minus(self.tail.places[vertices[j]], from_), minus(self.tail.places[vertices[k]], from_)
        start, along = found[i], minus(found[j], found[i])
        side = 3 * t + i
        square = dot(edge, edge)
        rounded = lambda a, by: (2 * a + by) // (2 * by)
        most = lambda x: min(max(x, -(1 << 24)), 1 << 24)
        if self.beside(side, 1) == found[i] and self.beside(side, 0) == found[j]:
            if square == 0:
                return "folded", start
            twin = self.tail.twin[side]
            beyond = minus(self.tail.places[self.tail.opposite(twin)], from_)
            q = self.told[twin // 3][(twin % 3 + 2) % 3]
            one, other = cross(edge, corner), cross(edge, beyond)
            shift = max(0, max(abs(c) for c in one + other).bit_length() - 30)
            here, there = (math.isqrt(sum((c >> shift) ** 2 for c in v)) for v in (one, other))
            out = []
            for s, a, q in zip(start, along, q):
                c = s + rounded(dot(corner, edge) * a, square)
                if there:
                    off = most(q - s - rounded(dot(beyond, edge) * a, square))
                    c -= rounded(here * off, there)
                out.append(most(c))
            return "folded", tuple(out)
        if square == 0:
            return "turned", start
        area = cross(edge, corner)
        shift = max(0, max(abs(c) for c in area).bit_length() - 30)
        height = math.isqrt(sum((c >> shift) ** 2 for c in area)) << shift
        across = (-along[1] * self.turn, along[0] * self.turn)
        return "turned", tuple(most(s + rounded(dot(corner, edge) * a + height * c, square))
                               for s, a, c in zip(start, along, across))

    def place(self, t, k, found):
        which, at = self.expected(t, k, found)
        at = [min(max(c, 0), self.top) for c in at]
        vertices = self.tail.triangles[t]
        around = sum(self.off.get(vertices[(k + n) % 3], 8) for n in (1, 2))
        rank, before, total = min(grade(around) // 2, 15), 0, 0
        for axis in range(2):
            off = self.tail.value(self.sizes[(which, rank)], self.before[(which, before)], self.digits[which])
            at[axis] += off
            before = min(abs(off).bit_length() + 1, 17)
            total += abs(off)
        if min(at) < 0 or max(at) > self.top:
            raise Refused("corner")
        if which in ("folded", "turned"):
            self.off[vertices[k]] = min(4 * total, 4000)
        found[k] = self.last = tuple(at)


def creased(tail, angle):
    """The normals of all corners by the tail's own rule: of the faces that edges join."""
    faces = []
    for t in tail.triangles:
        a, b, c = (tail.places[v] for v in t)
        faces.append(cross(minus(b, a), minus(c, a)))
    sets = list(range(3 * len(faces)))

    def find(c):
        while sets[c] != c:
            c = sets[c]
        return c

    after = lambda side: side - 2 if side % 3 == 2 else side + 1
    least = math.cos(math.radians(angle + 0.01))
    for side, twin in tail.twin.items():
        n, m = faces[side // 3], faces[twin // 3]
        if angle == 180 or length(n) * length(m) == 0 or dot(n, m) >= least * length(n) * length(m):
            sets[find(side)] = find(after(twin))
            sets[find(after(side))] = find(twin)
    sums = {}
    for corner in range(len(sets)):
        sums[find(corner)] = plus(sums.get(find(corner), (0, 0, 0)), faces[corner // 3])
    return [unit(sums[find(corner)]) if length(sums[find(corner)]) else (0, 0, 1) for corner in range(len(sets))]


class Normals:
    """Normals: those that corners have in their file."""

    def __init__(self, data, tail):
        bits, triangles = struct.unpack_from("<BI", data)
        if not 4 <= bits <= 14 or triangles != len(tail.triangles):
            raise Refused("normals")
        self.top = (1 << bits) - 1
        tail.coder = Coder(data[5:])
        rule = creased(tail, tail.crease)
        same, sizes, before_sizes, digits = doubles(), Table(doubles), Table(doubles), Table(doubles)
        offs, last, self.normals = {}, 0, []
        for corner in range(3 * triangles):
            t, k = corner // 3, corner % 3
            apart, normal = 0, None
            known = []
            for side, step in ((corner, 1), (3 * t + (k + 2) % 3, 0)):
                twin = tail.twin.get(side)
                there = twin is not None and twin // 3 < t
                known.append(self.normals[twin // 3 * 3 + (twin % 3 + step) % 3] if there else None)
            for i in range(2):
                if known[i] is None or (i == 1 and known[0] == known[1]):
                    continue
                if tail.yes(same[(i, apart, last)]):
                    normal = known[i]
                    break
                apart += 1
            last = int(apart > 0)
            if normal is None:
                mirrored = rule[corner][2] < 0
                turned = lambda n: (n[0], n[1], -n[2]) if mirrored else n
                at = self.point(turned(rule[corner]))
                vertices = tail.triangles[t]
                rank, before, total = min(grade(sum(offs.get(v, 4) for v in vertices)) // 2, 15), 0, 0
                for axis in range(2):
                    off = tail.value(sizes[rank], before_sizes[before], digits)
                    at[axis] = min(max(at[axis] + off, 0), self.top)
                    before = min(abs(off).bit_length() + 1, 15)
                    total += abs(off)
                offs[vertices[k]] = min(4 * total, 4000)
                normal = turned(self.direction(at))
            self.normals.append(normal)
        if tail.coder.bits(16) != 0x4E51:
            raise Refused("end of normals")

    def point(self, n):
        n = times(n, 1 / sum(abs(c) for c in n))
        x, y = n[:2]
        if n[2] < 0:
            x, y = math.copysign(1 - abs(n[1]), n[0]), math.copysign(1 - abs(n[0]), n[1])
        return [min(max(math.floor((c + 1) / 2 * self.top + 0.5), 0), self.top) for c in (x, y)]

    def direction(self, q):
        x, y = (2 * c / self.top - 1 for c in q)
        z = 1 - abs(x) - abs(y)
        if z < 0:
            x, y = math.copysign(1 - abs(y), x), math.copysign(1 - abs(x), y)
        return unit((x, y, z))


def cover_of(payload):
    """Covered patches: the stage, into how many parts the triangles are divided, and of each patch a number of them."""
    stage, parts, patches, triangles = struct.unpack_from("<BBII", payload)
    coder = Coder(payload[10:])
    changes, less, number = [Model(), Model()], Model(), Number()
    changed, last, out = False, 0, []
    for _ in range(patches):
        changed = coder.get(changes[changed])
        if changed:
            sign = -1 if coder.get(less) else 1
            last += sign * (number.get(coder) + 1)
        out.append(last)
        if not 0 <= last <= parts:
            raise Refused("cover")
    return stage, parts, triangles, out


def refine(tail, low_bits):
    """Low bits: {(layer, first vertex): bytes}."""
    known = [0] * len(tail.places)
    places = [list(p) for p in tail.places]
    for (layer, first), data in sorted(low_bits.items()):
        bits = [byte >> (7 - i) & 1 for byte in data for i in range(8)]
        for i in range(min(len(bits) // 3, len(places) - first)):
            if known[first + i] == layer < tail.finest - tail.b:
                known[first + i] += 1
                places[first + i] = [2 * q + bit for q, bit in zip(places[first + i], bits[3 * i:])]
    less = [tail.finest - tail.b - n for n in known]
    tail.places = [tuple((q << n) + ((1 << n) >> 1) for q in p) for p, n in zip(places, less)]


def shaded(tail, angle):
    """The normals of all corners: "Shading"."""
    faces = []
    for t in tail.triangles:
        a, b, c = (tail.places[v] for v in t)
        faces.append(cross(minus(b, a), minus(c, a)))
    around = {}
    for number, t in enumerate(tail.triangles):
        for v in t:
            around.setdefault(v, []).append(number)
    least = math.cos(math.radians(angle + 0.01)) if angle < 180 else -2
    for number, t in enumerate(tail.triangles):
        own = unit(faces[number])
        for v in t:
            everything = own == (0, 0, 0) or len(around[v]) > 256
            total = (0, 0, 0)
            for other in around[v]:
                if everything or dot(own, unit(faces[other])) >= least:
                    total = plus(total, faces[other])
            yield unit(total)


class Field:
    """The field of 256 elements of "Pieces"."""

    def __init__(self):
        self.power = [1]
        while len(self.power) < 255:
            x = 2 * self.power[-1]
            self.power.append(x ^ 0x11D if x > 255 else x)
        self.log = {x: i for i, x in enumerate(self.power)}

    def times(self, a, b):
        return self.power[(self.log[a] + self.log[b]) % 255] if a and b else 0

    def inverse(self, a):
        return self.power[-self.log[a] % 255]


def payloads_of(pieces):
    """The payloads of a group, from those of its pieces that come last: parity first of all."""
    field = Field()
    needed, = {piece[1] for piece in pieces}
    length, = {struct.unpack_from("<I", piece, 3)[0] for piece in pieces}
    size = -(-length // needed)
    by_number = {piece[2]: piece[7:] for piece in pieces}
    rows = []
    for number in sorted(by_number)[-needed:]:
        assert len(by_number[number]) == size
        weights = [int(i == number) if number < needed else field.inverse(number ^ i) for i in range(needed)]
        rows.append(weights + list(by_number[number]))
    for c in range(needed):
        pivot = next(r for r in range(c, needed) if rows[r][c])
        rows[c], rows[pivot] = rows[pivot], rows[c]
        scale = field.inverse(rows[c][c])
        rows[c] = [field.times(scale, x) for x in rows[c]]
        for r in range(needed):
            by = rows[r][c]
            if r != c and by:
                rows[r] = [x ^ field.times(by, y) for x, y in zip(rows[r], rows[c])]
    data = bytes(x for row in rows for x in row[needed:])[:length]
    at, out = 0, []
    while at < length:
        size, at = number_at(data, at)
        out.append(data[at:at + size])
        at += size
    return out


def to_rgb(y, co, cg):
    t = y - (cg >> 1)
    g = cg + t
    b = t - (co >> 1)
    return tuple(min(max(x, 0), 255) for x in (b + co, g, b))


def plus(a, b):
    return tuple(x + y for x, y in zip(a, b))


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def times(a, s):
    return tuple(x * s for x in a)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a):
    return math.sqrt(dot(a, a))


def unit(a):
    size = length(a)
    return times(a, 1 / size) if size > 0 else (0, 0, 0)


def number_at(data, at):
    value = 0
    for i in range(4):
        value |= (data[at + i] & 127) << (7 * i)
        if data[at + i] < 128:
            return value, at + i + 1
    raise Refused("number")


def main(name):
    data = open(name, "rb").read()
    header = struct.unpack_from("<I", data, 12)[0]
    assert data[:8] == bytes.fromhex("89514e560d0a1a0a") and data[11] == 3
    assert zlib.crc32(data[:16] + bytes(4) + data[20:header]) == struct.unpack_from("<I", data, 16)[0]
    lower, upper = struct.unpack_from("<3f", data, 26), struct.unpack_from("<3f", data, 38)
    longest = max(u - l for l, u in zip(lower, upper))
    stages, pieces, groups, origin, shading, low_bits, cover = {}, {}, {}, None, None, {}, None
    pictures, normals = {}, {}
    kinds = {6: pieces, 12: pictures, 13: normals}
    at = 108
    while at + 6 <= header:
        tag, size = struct.unpack_from("<HI", data, at)
        if tag == 5:
            stages[0] = Stage(data[at + 6:at + 6 + size])
        if tag == 7 and data[8] == 2:
            origin = struct.unpack_from("<3d", data, at + 6)
        at += 6 + size
    at = header
    payloads = []
    while at < len(data):
        mark, size, kind, zero, crc = struct.unpack_from("<HHBBI", data, at)
        payload = data[at + 10:at + 10 + size]
        assert mark == 0x4351 and zlib.crc32(data[at:at + 6] + payload) == crc
        at += 10 + size
        if kind in kinds:
            kinds[kind][struct.unpack_from("<I", payload)[0]] = payload[8:]
        if kind == 10:
            low_bits.setdefault(struct.unpack_from("<BI", payload), payload[5:])
        if kind == 11:
            cover = cover_of(payload)
        if kind == 8:
            assert payload[0] == 1
            shading = payload[1]
        if kind == 7:
            groups.setdefault(payload[0], []).append(payload)
        if kind == 4:
            payloads.append(payload)
    for which, group in sorted(groups.items()):
        if which < 16:
            payloads += payloads_of(group)
        elif 48 <= which < 64:
            for payload in payloads_of(group):
                low_bits.setdefault(struct.unpack_from("<BI", payload), payload[5:])
        else:
            of = pieces if which < 48 else pictures if which < 80 else normals
            for payload in payloads_of(group):
                of[struct.unpack_from("<I", payload)[0]] = payload[8:]
    for payload in payloads:
        if payload[0] & 15 == 0:
            stages[payload[0] >> 4] = Stage(payload[1:])
    for payload in payloads:
        what, of = payload[0] & 15, payload[0] >> 4
        if what == 0:
            continue
        level, layer = payload[1] & 15, payload[1] >> 4
        first, behind = number_at(payload, 2)
        count, behind = number_at(payload, behind)
        stages[of].add(what, level, layer, first, count, payload[behind:])
    for of, stage in sorted(stages.items()):
        print("stage", of, stage.depth, stage.s, int(stage.colored), stage.clusters, stage.base.b)
        for v in stage.base.vertices:
            print("vertex", *v)
        for t in stage.base.triangles:
            print("triangle", *t)
        for edge in stage.base.edges:
            if edge[4]:
                print("crease", *edge[:2])
        for (kind, layer, level), values in sorted(stage.numbers.items(), key=str):
            told = [(v, value) for v, value in sorted(values.items()) if value]
            print("numbers", kind, layer, level, *(x for pair in told for x in pair))
    shown = max(of for of, stage in stages.items() if stage.come >= stage.clusters and not stage.beside)
    for v, p in list(enumerate(stages[shown].places()))[::11]:
        place = [l + x * longest for l, x in zip(lower, p)]
        print("place", v, *("%.9g" % x for x in place) if not origin else ("%.17g" % (o + x) for o, x in zip(origin, place)))
    for v, c in list(enumerate(stages[shown].colours()))[::11]:
        print("colour", v, *c)
    if pieces:
        joined = lambda parts: b"".join(part for _, part in sorted(parts.items()))
        tail = Tail(joined(pieces))
        own = Normals(joined(normals), tail).normals if normals else []
        refine(tail, low_bits)
        print("exact", tail.finest, tail.crease)
        for v, p in enumerate(tail.places):
            print("at", *p, *(tail.rgb(tail.colours[v]) if tail.colored else ()))
        for t in tail.triangles:
            print("face", *t)
        if tail.lattice:
            print("texture", tail.lattice[0], *("%.9g" % x for x in tail.lattice[1:]))
            for corners in tail.corners.told:
                print("corners", *(c for q in corners for c in q))
        if pictures:
            data = joined(pictures)
            print("picture", data[0])
            begin = 2 + 8 * data[1]
            for i in range(data[1]):
                size, enough = struct.unpack_from("<II", data, 2 + 8 * i)
                print("file", size, enough, zlib.crc32(data[begin:begin + size]))
                begin += size
        for corner, n in list(enumerate(own))[::11]:
            print("own", corner, *("%.6f" % x for x in n))
        if cover:
            print("cover", *cover[:3])
            print("covered", *cover[3])
        if shading is not None:
            print("shading", shading)
            for corner, n in list(enumerate(shaded(tail, shading)))[::11]:
                print("normal", corner, *("%.6f" % x for x in n))


if __name__ == "__main__":
    main(sys.argv[1])
