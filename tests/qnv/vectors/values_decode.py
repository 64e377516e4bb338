"""Decodes a stream of values, from FORMAT.md alone. Prints the samples, with "-" for missing voxels, or the codes of
labels. Of several components, prints one after the other; of colours, red, green, blue and opacity; of time series, step
after step.

    python3 values_decode.py STREAM
"""
import struct
import sys

from streams import all_chunks, restored

MASK = 0xFFFFFFFF


def wrapped(v):
    v &= MASK
    return v - (1 << 32) if v >> 31 else v


class Estimate:
    def __init__(self, start=32768):
        self.f = self.s = start
        self.n = 0


class Range:
    def __init__(self, data):
        self.data, self.at, self.range, self.code = data, 0, MASK, 0
        for _ in range(4):
            self.code = self.code << 8 | self.next()

    def next(self):
        self.at += 1
        return self.data[self.at - 1] if self.at <= len(self.data) else 0

    def exhausted(self):
        return self.at > len(self.data) + 8

    def decide(self, bound):
        yes = self.code < bound
        if yes:
            self.range = bound
        else:
            self.code -= bound
            self.range -= bound
        while self.range < 1 << 24:
            self.code = (self.code << 8 | self.next()) & MASK
            self.range = self.range << 8 & MASK
        return yes

    def plain(self):
        return self.decide(self.range >> 1)

    def bits(self, count):
        value = 0
        for _ in range(count):
            value = value * 2 + self.plain()
        return value

    def get(self, e):
        p = min(max((e.f + e.s) >> 1, 48), 65488)
        yes = self.decide(self.range * p >> 16)
        q = 2 if e.n < 3 else 3 if e.n < 8 else 4
        r = 2 if e.n < 3 else 3 if e.n < 8 else 4 if e.n < 18 else 5 if e.n < 40 else 7
        target = 65535 if yes else 0
        e.f += (target - e.f) >> q
        e.s += (target - e.s) >> r
        e.n = min(e.n + 1, 47)
        return yes


def number(data, at):
    value, shift = 0, 0
    while True:
        value |= (data[at] & 127) << shift
        shift += 7
        at += 1
        if data[at - 1] < 128:
            return value, at


def number_pair(payload):
    block, at = number(payload, 0)
    return block, number(payload, at)[0]


def halves(extent, level):
    for _ in range(level):
        extent = [(n + 1) // 2 for n in extent]
    return extent


class Block:
    FIRST = [0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 19, 24, 32, 42]

    def __init__(self, level, parts):
        self.level, self.parts, self.cubes, self.plane, self.cube, self.next = level, parts, [], 0, 0, 0
        self.differs = 0
        for b, (first, size, high) in enumerate(parts):
            counts = [(n + 3) // 4 for n in size]
            for z in range(counts[2]):
                for y in range(counts[1]):
                    for x in range(counts[0]):
                        self.cubes.append((b, (x, y, z), counts))
        self.index = {(b, at): i for i, (b, at, _) in enumerate(self.cubes)}
        self.active, self.known = set(), {}
        self.values = [dict() for _ in parts]  # (x, y, z): [magnitude, negative]
        self.actives = [Estimate(min(9000 + 5500 * (c // 3) + 6000 * (c % 3), 58000)) for c in range(15)]
        self.lines = [Estimate(6000) for _ in range(4)]
        self.ones = [[Estimate(min(1700 + 2300 * c, 34000)) for c in range(16)] for _ in range(4)]
        self.more = [Estimate(26000 + 900 * c) for c in range(4)]

    def size(self, b, x, y, z):
        found = self.values[b].get((x, y, z))
        return min(4, found[0] >> self.plane) if found else 0

    def sum(self, b, x, y, z):
        total = 0
        for dz in (-1, 0, 1):
            for dy in (-1, 0, 1):
                for dx in (-1, 0, 1):
                    far = abs(dx) + abs(dy) + abs(dz)
                    if far in (1, 2):
                        total += (3 - far) * self.size(b, x + dx, y + dy, z + dz)
        return total

    def step(self, coder):
        b, at, counts = self.cubes[self.cube]
        first, size, high = self.parts[b]
        if self.cube not in self.active:
            a = 0
            for axis in range(3):
                for side in (-1, 1):
                    beside = list(at)
                    beside[axis] += side
                    a += self.index.get((b, tuple(beside)), -1) in self.active
            before = 0
            if b > 0 and [(n + 3) // 4 for n in self.parts[b - 1][1]] == counts:
                before = 2 if self.index[(b - 1, at)] in self.active else 1
            if coder.get(self.actives[3 * min(4, a) + before]):
                self.active.add(self.cube)
        if self.cube in self.active:
            lower = [4 * n for n in at]
            upper = [min(4 * n + 4, s) for n, s in zip(at, size)]
            for z in range(lower[2], upper[2]):
                for y in range(lower[1], upper[1]):
                    self.line(coder, b, high, range(lower[0], upper[0]), y, z)
            self.known[self.cube] = self.plane
        self.cube += 1
        if self.cube == len(self.cubes):
            self.cube, self.plane = 0, self.plane - 1

    def line(self, coder, b, high, xs, y, z):
        values, p = self.values[b], self.plane
        expects = False
        if len(xs) == 4 and not any((x, y, z) in values for x in xs) and not any(self.sum(b, x, y, z) for x in xs):
            if not coder.get(self.lines[high]):
                return
            expects = True
        for x in xs:
            s = self.sum(b, x, y, z)
            value = values.get((x, y, z))
            if value is None:
                c = max(i for i in range(16) if self.FIRST[i] <= s)
                if (expects and x == xs[-1]) or coder.get(self.ones[high][c]):
                    values[(x, y, z)] = [1 << p, coder.plain()]
                    expects = False
            elif coder.get(self.more[min(3, s >> 3)]) if value[0] >> p == 2 else coder.plain():
                value[0] |= 1 << p

    def write(self, volume):
        for b, (first, _, _) in enumerate(self.parts):
            for (x, y, z), (magnitude, negative) in self.values[b].items():
                cube = self.index[(b, (x // 4, y // 4, z // 4))]
                p = self.known[cube]
                v = magnitude + ((3 << p) >> 3) if p > 0 else magnitude
                volume[(first[0] + x, first[1] + y, first[2] + z)] = -v if negative else v


def blocks_of(extent, levels):
    blocks = []
    for level in range(max(levels, 1), 0, -1):
        whole = halves(extent, level - 1)
        low = halves(extent, level) if levels else whole
        bands = range(1) if not levels else range(0 if level == levels else 1, 8)
        for k in range((low[2] + 15) // 16):
            for j in range((low[1] + 15) // 16):
                for i in range((low[0] + 15) // 16):
                    parts = []
                    for band in bands:
                        high = [band >> a & 1 for a in range(3)]
                        n = [whole[a] - low[a] if high[a] else low[a] for a in range(3)]
                        at = [16 * i, 16 * j, 16 * k]
                        if all(at[a] < n[a] for a in range(3)):
                            parts.append(([at[a] + high[a] * low[a] for a in range(3)],
                                          [min(16, n[a] - at[a]) for a in range(3)], sum(high)))
                    blocks.append(Block(level, parts))
    return blocks


def lift(a, b, f):
    s = wrapped(a + b)
    return wrapped(wrapped(f * (s >> 14)) + (wrapped(f * (s & 16383) + 8192) >> 14))


def inverse_line(line):
    n = len(line)
    low = (n + 1) // 2
    s = [0] * n
    s[0::2], s[1::2] = line[:low], line[low:]
    for f, odd in ((7266, 0), (14465, 1), (-868, 0), (-25987, 1)):
        for i in range(odd, n, 2):
            before = s[i - 1] if i > 0 else s[1]
            after = s[i + 1] if i + 1 < n else s[n - 2]
            s[i] = wrapped(s[i] - lift(before, after, f))
    return s


def inverse(volume, extent, levels):
    for level in range(levels - 1, -1, -1):
        part = halves(extent, level)
        for axis in (2, 1, 0):
            if part[axis] < 2:
                continue
            u, v = [a for a in range(3) if a != axis]
            for j in range(part[v]):
                for i in range(part[u]):
                    places = []
                    for k in range(part[axis]):
                        at = [0, 0, 0]
                        at[axis], at[u], at[v] = k, i, j
                        places.append(tuple(at))
                    for place, value in zip(places, inverse_line([volume[p] for p in places])):
                        volume[place] = value


def voxels_of_run(payload, extent):
    first, at = number(payload, 0)
    count, at = number(payload, at)
    cubes = [(n + 3) // 4 for n in extent]
    boxes = []
    for i in range(first, first + count):
        x, y, z = i % cubes[0], i // cubes[0] % cubes[1], i // cubes[0] // cubes[1]
        boxes.append([(a, b, c) for c in range(4 * z, min(4 * z + 4, extent[2]))
                      for b in range(4 * y, min(4 * y + 4, extent[1]))
                      for a in range(4 * x, min(4 * x + 4, extent[0]))])
    return boxes, Range(payload[at:])


def gaps(payload, extent, missing):
    boxes, coder = voxels_of_run(payload, extent)
    same, full = [Estimate() for _ in range(3)], [Estimate() for _ in range(3)]
    voxel = [Estimate() for _ in range(8)]
    before = 0
    for box in boxes:
        mixed = coder.get(same[before])
        whole = not mixed and coder.get(full[before])
        inside = set()
        for x, y, z in box:
            if mixed:
                near = [(x - 1, y, z) in inside, (x, y - 1, z) in inside, (x, y, z - 1) in inside]
                gone = coder.get(voxel[near[0] + 2 * near[1] + 4 * near[2]])
            else:
                gone = whole
            if gone:
                inside.add((x, y, z))
        missing |= inside
        before = 2 if mixed else 1 if whole else 0


def remainders(payload, extent, found):
    boxes, coder = voxels_of_run(payload, extent)
    zero = [Estimate() for _ in range(12)]
    length = [[Estimate() for _ in range(32)] for _ in range(12)]
    before = 0
    for box in boxes:
        for place in box:
            c = min(11, before // 3)
            if coder.get(zero[c]):
                before = value = 0
            else:
                node = 1
                for _ in range(5):
                    node = 2 * node + coder.get(length[c][node])
                before = (node & 31) + 1
                value = 1 << (before - 1) | coder.bits(before - 1)
            found[place] = (value >> 1) ^ -(value & 1)


class Labels:
    """A level of labels: those received, by place."""
    NEAR = [(-1, 0, 0, 3), (0, -1, 0, 3), (0, 0, -1, 3), (-1, -1, 0, 2), (-1, 0, -1, 2), (0, -1, -1, 2), (1, -1, 0, 2),
            (1, 0, -1, 2), (0, 1, -1, 2), (-1, -1, -1, 1), (1, -1, -1, 1), (-1, 1, -1, 1), (1, 1, -1, 1)]

    def __init__(self, extent, count):
        self.extent, self.count, self.known = extent, count, {}
        self.bits = [((n + 3) // 4 - 1).bit_length() for n in extent]

    def cube(self, code):
        at = [0, 0, 0]
        for bit in range(max(self.bits)):
            for axis in range(3):
                if bit < self.bits[axis]:
                    at[axis] |= (code & 1) << bit
                    code >>= 1
        return at

    def run(self, first, count, coder, differs):
        self.coder, self.now, self.list = coder, {}, []
        kept, decision = {}, [Estimate() for _ in range(16)]
        self.uniform = [Estimate() for _ in range(16)]
        self.expected = [Estimate() for _ in range(4)]
        self.first = [Estimate() for _ in range(512)]
        self.second = [Estimate() for _ in range(16)]
        self.again = [Estimate() for _ in range(8)]
        for code in range(first, first + count):
            cube = self.cube(code)
            lower = [4 * n for n in cube]
            if all(lower[a] < self.extent[a] for a in range(3)):
                if differs:
                    beside = [kept[place] for place in
                              (tuple(n - (a == axis) for a, n in enumerate(cube)) for axis in range(3)) if place in kept]
                    kept[tuple(cube)] = coder.get(decision[4 * len(beside) + sum(beside)])
                    if kept[tuple(cube)]:
                        continue
                self.one_cube(lower, [min(4, self.extent[a] - lower[a]) for a in range(3)])
        self.known.update(self.now)

    def one_cube(self, lower, size):
        now = self.now
        spots = [(lower[0] + x, lower[1] + y, lower[2] + z)
                 for z in range(size[2]) for y in range(size[1]) for x in range(size[0])]
        p = None
        for axis in range(3):
            beside = list(lower)
            beside[axis] -= 1
            p = now.get(tuple(beside)) if p is None else p
        k = s = 0
        for axis in range(3):
            face = []
            for spot in spots:
                if spot[axis] == lower[axis]:
                    beside = list(spot)
                    beside[axis] -= 1
                    face.append(now.get(tuple(beside)))
            there = any(label is not None for label in face)
            k += there
            s += there and all(label == p for label in face)
        if self.coder.get(self.uniform[4 * k + s]):
            if p is not None and self.coder.get(self.expected[s]):
                label = p
            else:
                label = self.explicit([p])
            now.update((spot, label) for spot in spots)
            return
        for spot in spots:
            now[spot] = self.voxel(spot)

    def voxel(self, spot):
        near = [self.now.get((spot[0] + x, spot[1] + y, spot[2] + z)) for x, y, z, _ in self.NEAR]
        votes = {}
        for label, (_, _, _, weight) in zip(near, self.NEAR):
            if label is not None:
                votes[label] = votes.get(label, 0) + weight
        ranked = sorted(votes, key=lambda label: -votes[label])
        if not ranked:
            return self.explicit([])
        a = ranked[0]
        estimate = self.first[sum((near[i] == a) << i for i in range(9))]
        if estimate.n == 0:
            estimate.f = estimate.s = max(30000, 60000 - 2500 * (sum(votes.values()) - votes[a]))
        if self.coder.get(estimate):
            return a
        if self.count == 2:
            return 1 - a
        if len(ranked) > 1 and self.coder.get(self.second[min(15, votes[ranked[1]])]):
            return ranked[1]
        return self.explicit(ranked[:2])

    def explicit(self, excluded):
        label = None
        for i, one in enumerate([one for one in self.list if one not in excluded][:8]):
            if self.coder.get(self.again[i]):
                label = one
                break
        if label is None:
            label = min(self.coder.bits((self.count - 1).bit_length()), self.count - 1)
        self.list = ([label] + [one for one in self.list if one != label])[:16]
        return label


def print_labels(extent, section, payloads, steps):
    codes, at, following = [], 0, 0
    while at < len(section):
        skipped, at = number(section, at)
        more, at = number(section, at)
        codes.extend(range(following + skipped, following + skipped + more + 1))
        following += skipped + more + 1
    for step in range(steps):
        if step % 8 == 0:
            levels = []
            while not levels or max(halves(extent, len(levels) - 1)) > 16:
                levels.append(Labels(halves(extent, len(levels)), len(codes)))
        for payload in payloads:
            level, differs = levels[payload[0] & 127], payload[0] >> 7
            first, at = number(payload, 1)
            count, at = number(payload, at)
            if first >> sum(level.bits) != step:
                continue
            if differs and step % 8 == 0:
                sys.exit("labels of no step are kept")
            level.run(first & (1 << sum(level.bits)) - 1, count, Range(payload[at:]), differs)
        for z in range(extent[2]):
            for y in range(extent[1]):
                for x in range(extent[0]):
                    level = 0
                    while (x >> level, y >> level, z >> level) not in levels[level].known:
                        level += 1
                    print(codes[levels[level].known[(x >> level, y >> level, z >> level)]])


def main():
    data = open(sys.argv[1], "rb").read()
    if data[:8] != b"\x89QNV\r\n\x1a\n" or data[11] != 5:
        sys.exit("no stream of values")
    (length,) = struct.unpack_from("<I", data, 12)
    at, grids, steps = 108, [], 1
    while at + 6 <= length:
        tag, size = struct.unpack_from("<HI", data, at)
        if tag == 8 or tag == 11:
            grids.append(data[at + 6:at + 6 + size])
        if tag == 12:
            (steps,) = struct.unpack_from("<H", data, at + 6)
        if tag == 9:
            names = data[at + 6:at + 6 + size]
        at += 6 + size
    extent = list(struct.unpack_from("<3I", grids[0], 0))
    kept = restored(list(all_chunks(data, length)))
    if grids[0][73] & 4:
        return print_labels(extent, names, [payload for kind, payload in kept if kind == 19], steps)
    (components,) = struct.unpack_from("<H", grids[0], 74)
    levels = 0
    while max(halves(extent, levels)) > 16:
        levels += 1
    cubes = [(n + 3) // 4 for n in extent]
    counts = {14: len(blocks_of(extent, levels)), 15: cubes[0] * cubes[1] * cubes[2]}
    counts[16] = counts[15]
    before = [None] * components  # coefficients of the step before, by block
    for step in range(steps):
        decoded = []
        for component in range(components):
            payloads = []
            for kind, payload in kept:
                if kind in counts:
                    first, at = number(payload, 0)
                    if first // counts[kind] == step * components + component:
                        payloads.append((kind, written(first % counts[kind]) + payload[at:]))
            numbers, before[component] = component_numbers(extent, levels, grids[component], payloads,
                                                           before[component] if step % 8 else None)
            decoded.append(numbers)
        if grids[0][73] & 8:
            decoded = colors(decoded, grids)
        for numbers in decoded:
            for number_or_gap in numbers:
                print(number_or_gap)


def colors(decoded, grids):
    """Returns red, green, blue and opacity, from 0 to 255."""
    numbers = []
    for samples, grid in zip(decoded, grids):
        unit, zero = struct.unpack_from("<2d", grid, 96)
        numbers.append([int(zero + unit * sample) for sample in samples])
    if grids[0][73] & 16:
        for i, (luma, orange, green) in enumerate(zip(*numbers[:3])):
            half = luma - (green >> 1)
            blue = half - (orange >> 1)
            numbers[0][i], numbers[1][i], numbers[2][i] = blue + orange, green + half, blue
    return [[min(max(one, 0), 255) for one in component] for component in numbers]


def written(value):
    out = []
    while value >= 128:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes(out + [value])


def component_numbers(extent, levels, grid, payloads, before):
    kind, flags = grid[72], grid[73]
    (step,) = struct.unpack_from("<I", grid, 76)
    slope, intercept, unit, zero = struct.unpack_from("<4d", grid, 80)
    blocks = blocks_of(extent, levels)
    missing, found = set(), {}
    for payload in (p for type, p in payloads if type == 15):
        gaps(payload, extent, missing)
    for payload in (p for type, p in payloads if type == 16):
        remainders(payload, extent, found)
    clusters = [number_pair(p) + (p,) for type, p in payloads if type == 14]
    for _, _, payload in sorted(clusters):
        n, p = number(payload, 0)
        index, p = number(payload, p)
        steps, p = number(payload, p)
        block = blocks[n]
        if index < block.next:
            continue  # repeated
        if index == 0:
            block.plane, block.differs, p = payload[p] & 127, payload[p] & 128, p + 1
            if block.differs and before is None:
                sys.exit("a difference to no step")
        if index != block.next:
            sys.exit("a cluster is missing")
        block.next += 1
        coder = Range(payload[p:])
        for _ in range(steps):
            if coder.exhausted() or block.plane < 0:
                break
            block.step(coder)
    places = [(x, y, z) for z in range(extent[2]) for y in range(extent[1]) for x in range(extent[0])]
    volume = dict.fromkeys(places, 0)
    coefficients = []
    for i, block in enumerate(blocks):
        own = {}
        block.write(own)
        if before is not None and (block.next == 0 or block.differs):
            for place, value in before[i].items():
                own[place] = wrapped(own.get(place, 0) + value)
        coefficients.append(own)
        volume.update(own)
    inverse(volume, extent, levels)
    numbers = []
    for place in places:
        value = volume[place]
        if step:
            value = wrapped(value + found.get(place, 0) * step)
        if flags & 2:
            if kind < 6:
                value = round((zero - intercept) / slope) + round(unit / slope) * value
            else:
                (bits,) = struct.unpack("<I", struct.pack("<f", zero + unit * value))
                value = ~bits & MASK if bits >> 31 else bits | 1 << 31
            value = (value + found.get(place, 0)) & MASK
        numbers.append("-" if place in missing else value)
    return numbers, coefficients


main()
