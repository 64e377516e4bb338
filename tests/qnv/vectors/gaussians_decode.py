"""Decodes a stream of Gaussians, from FORMAT.md alone. Prints a line for each Gaussian that no received one replaces, by
cluster: scales, opacity, leaf, and the bits of the f32 numbers of rotation, position, colour and harmonics.

    python3 gaussians_decode.py STREAM
"""
import math
import pathlib
import re
import struct
import sys

from streams import all_chunks

EIGHTHS = [1, 1.0905077326652577, 1.189207115002721, 1.2968395546510096, 1.4142135623730951, 1.5422108254079407,
           1.681792830507429, 1.8340080864093424]
RATES = [131072 // (2 * n + 3) for n in range(31)]
MASK = 0xFFFFFFFF


def power(e):
    return math.ldexp(EIGHTHS[e & 7], e >> 3)


def f32(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]


def clamp(x, a, b):
    return max(a, min(x, b))


def halves(x):
    if x == 0:
        return 0
    f, e = math.frexp(x)
    return 2 * (e - 1) + 2 + (1 if f >= 0.70710678118654757 else 0)


class Model:
    def __init__(self, prior=0):
        self.p, self.n = (prior << 8, 20) if prior else (32768, 0)


class Range:
    def __init__(self, data):
        self.data, self.at, self.range = data, 4, MASK
        self.code = int.from_bytes((data + bytes(4))[:4], "big")

    def decide(self, bound):
        yes = self.code < bound
        if yes:
            self.range = bound
        else:
            self.code -= bound
            self.range -= bound
        while self.range < 1 << 24:
            byte = self.data[self.at] if self.at < len(self.data) else 0
            self.at += 1
            self.code = (self.code << 8 | byte) & MASK
            self.range = self.range << 8 & MASK
        return yes

    def yes(self, model):
        answer = self.decide(self.range * min(max(model.p, 64), 65472) >> 16)
        model.p += ((65535 if answer else 0) - model.p) * RATES[model.n] >> 16
        model.n = min(model.n + 1, 30)
        return answer

    def bits(self, n):
        value = 0
        for _ in range(n):
            value = value << 1 | (1 if self.decide(self.range >> 1) else 0)
        return value


def short_names(steps, *key):
    return [key + ("S", i) for i in range(steps)] + [key + ("Z", i) for i in range(8)]


def signed_names(*key):
    return [name for size in range(10) for name in short_names(10, *key, size)] + [key + (i, "sign") for i in range(10)]


def tree_names(*key):
    return [key + ("high", c, i) for c in range(8) for i in range(15)] + [key + ("low", t, i) for t in range(16) for i in range(3)]


def table_of_priors():
    """Reads the table of trained models. Returns probabilities by name."""
    names = short_names(16, "children") + [("leaf", i) for i in range(3)]
    for kind in ("size", "turn", "color"):
        names += [name for one in range(2) for k in range(2 if kind == "size" else 3) for name in signed_names(kind, one, k)]
    names += [name for axis in (1, 2) for one in range(2) for name in tree_names("gap", axis, one)]
    names += [name for axis in (1, 2) for name in short_names(8, "far", axis)]
    names += [name for one in range(2) for name in tree_names("opacity", one)]
    names += [name for which in range(4) for name in signed_names("place", which)]
    text = (pathlib.Path(__file__).parents[3] / "qnv/codecs/gaussians/splat_priors.inc").read_text()
    numbers = [int(word) for word in re.findall("[0-9]+", text)]
    assert len(numbers) == len(names)
    return dict(zip(names, numbers))


class Models:
    """Models and means by name, made when first used."""

    def __init__(self, other=None, priors=None):
        self.models, self.means, self.priors = {}, {}, other.priors if other else priors
        if other:
            for key, model in other.models.items():
                self.models[key] = Model()
                self.models[key].p, self.models[key].n = model.p, model.n
            self.means = dict(other.means)

    def __getitem__(self, key):
        if key not in self.models:
            self.models[key] = Model(self.priors[key] if self.priors else 0)
        return self.models[key]

    def short(self, coder, steps, *key):
        for i in range(steps):
            if not coder.yes(self[key + ("S", i)]):
                return i
        z = 0
        while z < 26 and coder.yes(self[key + ("Z", min(z, 7))]):
            z += 1
        return (1 << z | coder.bits(z)) - 1 + steps

    def branch(self, coder, context, *key):
        node = 1
        for _ in range(4):
            node = node << 1 | coder.yes(self[key + ("high", context, node - 1)])
        return node - 16

    def tree(self, coder, context, *key):
        top, node = self.branch(coder, context, *key), 1
        for _ in range(2):
            node = node << 1 | coder.yes(self[key + ("low", top, node - 1)])
        return top << 2 | node - 4

    def signed(self, coder, sizes, u, *key):
        size = clamp(u, 0, sizes - 1)
        if self.priors and u >= sizes and key[0] != "size":
            size = sizes - 2 + (u - sizes) % 2
        low = clamp(int((u - 2) / 2) - 2, 0, 24)
        value = self.short(coder, 10, *key, size) << low
        if low:
            value |= coder.bits(low)
        if value and coder.yes(self[key + (size, "sign")]):
            return -value
        return value

    def signed_by_mean(self, coder, sizes, *key, more=0):
        mean = self.means.get(key, 64)
        value = self.signed(coder, sizes, (mean * mean).bit_length() - 7 + more, *key)
        self.means[key] = max(1, mean + int((16 * min(abs(value), 2047) - mean) / 8))
        return value


def faintness(a):
    m = 0
    while m > -48 and a / 63 < power(m):
        m -= 1
    return m


def less_important(s, a, header):
    floor = header["finest"] + 28 if header["tuned"] else 0
    return int((header["important"] - (max(s[0], floor) + max(s[1], floor) + 2 * faintness(a))) / 2)


def cell_index(gap):
    return gap if gap < 4 else 4 + (gap - 4) // 2 if gap < 8 else 6 + (gap - 8) // 4 if gap < 16 else 8 + (gap - 16) // 8


def cell(index):
    """Returns the smallest gap and the width of a cell."""
    if index < 4:
        return index, 1
    return (4 + 2 * (index - 4), 2) if index < 6 else (8 + 4 * (index - 6), 4) if index < 8 else (16 + 8 * (index - 8), 8)


def fine_bits(s, a, header):
    if not header["tuned"]:
        return [header["fine"]] * 4
    less = less_important(s, a, header)

    def bits(width, step, more=0):
        return clamp((width - (header["steps"] + clamp(less + more, -8, 16) + step) + 4) // 8, 0, 8)

    gap = s[1] - s[2]
    width = {1: 0, 2: 8, 4: 16, 8: 24}[cell(cell_index(gap))[1]]
    wide = bits(0, 8)
    return [wide, wide, bits(width, 8 + gap * 11 // 8), bits(0, 3, faintness(a))]


def look(node, header):
    """Returns the deviations and the opacity of a Gaussian of a tuned stream."""
    s, a = node["s"], node["a"]
    if not node["leaf"]:
        return [power(v - 320) for v in s] + [a / 63]
    bits = fine_bits(s, a, header)
    at = [(x + 0.5) / 2 ** n for x, n in zip(node["fine"], bits)]
    lowest, width = cell(cell_index(s[1] - s[2]))
    gap = lowest - 0.5 + width * at[2]
    return [power(s[0] - 320) * 2 ** ((at[0] - 0.5) / 8), power(s[1] - 320) * 2 ** ((at[1] - 0.5) / 8),
            power(s[1] - 320) * 2 ** (-gap / 8), min(1, (a + at[3] - 0.5) / 63)]


def leaf_steps(s, a, header):
    e = header["steps"] + clamp(less_important(s, a, header), -8, 16)
    lift = (s[1] - s[2]) * 3 // 8
    place, turn = [], []
    for k in range(3):
        place.append(0.1 * power(e - 2) * power(max(s[k] + (lift if k == 2 else 0), s[0] - 24, header["finest"]) - 320))
        u, w = sorted((s[(k + 1) % 3], s[(k + 2) % 3]), reverse=True)
        i = clamp(u - max(w, header["finest"]), 0, 40)
        r = power(i)
        turn.append(clamp(0.18 * power(e - 6 + (0 if k == 2 else min(lift, i))) / (r - 1 / r + 0.05), 0.0005, 0.35))
    return place, turn, header["color"] * power(e + 8)


def steps_of(s, a, leaf, header):
    if leaf and header["tuned"]:
        return leaf_steps(s, a, header)
    z = clamp(less_important(s, a, header), 0, header["less"])
    f, n = power(z), (1 if leaf else header["inner"]) * power(max(header["steps"], 0) if header["tuned"] else header["steps"])
    fine = n * min(f, 2.0)
    place, turn = [], []
    for k in range(3):
        place.append(0.1 * fine * power(max(s[k], s[0] - 24, header["finest"]) - 320))
        u, w = sorted((s[(k + 1) % 3], s[(k + 2) % 3]), reverse=True)
        r = power(clamp(u - max(w, header["finest"]), 0, 40))
        turn.append(clamp(0.18 * fine / (r - 1 / r + 0.05), 0.01, 0.35))
    return place, turn, header["color"] * n * f


def turned(p, t, steps):
    x, y, z = (t[k] * steps[k] for k in range(3))
    square = x * x + y * y + z * z
    w = math.sqrt(1 - square) if square < 1 else 0.0
    px, py, pz, pw = p
    q = [pw * x + px * w + py * z - pz * y, pw * y - px * z + py * w + pz * x, pw * z + px * y - py * x + pz * w,
         pw * w - px * x - py * y - pz * z]
    length = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return [f32(v / length) for v in q]


def axes(q):
    x, y, z, w = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
            [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
            [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]]


def rgb(q, step):
    y, o, g = (v * step for v in q)
    return [y + o - g, y + g, y - o - g]


def child(coder, models, p, b, header):
    h = 1 if b else 0
    leaf = coder.yes(models["leaf", (2 if b["leaf"] else 1) if b else 0])
    one, c = (1, 0) if leaf else (0, 1)
    trained = header["trained"]
    v = p["s"][0] - 8
    if b:
        v = (b["s"][0] + 3 * v) >> 2 if trained else b["s"][0]
    s = [clamp((v >> c) + models.signed_by_mean(coder, 10, "size", one, h), 0, 639 >> c) << c]
    for k in (1, 2):
        g = (b or p)["s"][k - 1] - (b or p)["s"][k]
        if trained:
            inherited = max(p["s"][k - 1] - p["s"][k], 0)
            mean = (inherited + max(g, 0)) // 2 if b else inherited
            if header["tuned"] and k == 2:
                index = models.branch(coder, min(cell_index(mean >> c) // 2, 7), "gap", k, one)
                if index == 15:
                    index += min(models.short(coder, 8, "far", k), 639)
                lowest, width = cell(index)
                s.append(max(0, s[1] - ((lowest + width // 2) << c)))
                continue
            gap = models.tree(coder, min(mean // 6, 7), "gap", k, one)
            if gap == 63:
                gap += models.short(coder, 8, "far", k)
        else:
            i = min(5, (max(g, 0) >> 2).bit_length() + h)
            gap = models.short(coder, 20, "gap", k, one, i)
        s.append(max(0, s[k - 1] - (min(gap, 639) << c)))
    if trained:
        mean = (b["a"] + p["a"]) // 2 if b else p["a"]
        v = models.tree(coder, mean // 8, "opacity", one)
    else:
        v = ((b or p)["a"] >> c) + models.signed_by_mean(coder, 8, "opacity", one, h)
    a = clamp(v << c | c, 1, 63)
    fine = [coder.bits(count) for count in fine_bits(s, a, header)] if leaf else None
    place_step, turn_step, color_step = steps_of(s, a, leaf, header)
    most = 2047 if header["tuned"] else 255
    t = [clamp(models.signed(coder, 10, halves(0.25 / turn_step[k]), "turn", one, k), -most, most) for k in range(3)]
    rotation = turned(p["rotation"], t, turn_step)
    own, frame = axes(rotation), axes(p["rotation"])
    d = []
    for k in range(3):
        variance = 0.0
        for j in range(3):
            along = (own[k][0] * frame[j][0] + own[k][1] * frame[j][1] + own[k][2] * frame[j][2]) * power(p["s"][j] - 320)
            variance += along * along
        spread = math.sqrt(variance) / place_step[k]
        if trained:
            number = models.signed(coder, 10, halves(spread), "place", 1 + k if leaf else 0)
        else:
            number = models.signed(coder, 20, halves(spread), "place", one)
        d.append(clamp(number, -(1 << 24), 1 << 24))
    q, more = [], 0
    for k in range(3):
        mean = models.means.get(("color", one, k), 64)
        q.append(clamp(models.signed_by_mean(coder, 10, "color", one, k, more=more), -(1 << 14), 1 << 14))
        if trained:
            magnitude = 16 * min(abs(q[k]), 2047)
            more = 1 if magnitude > 2 * mean else -1 if 2 * magnitude < mean else 0
    position = []
    for i in range(3):
        at = p["position"][i]
        for k in range(3):
            at += own[k][i] * (d[k] * place_step[k])
        position.append(clamp(f32(at), header["lower"][i], header["upper"][i]))
    color = [f32(old + change) for old, change in zip(p["color"], rgb(q, color_step))]
    return {"s": s, "a": a, "fine": fine, "leaf": leaf, "rotation": rotation, "position": position, "color": color}


def numbers(payload, count):
    found, at = [], 0
    for _ in range(count):
        value = shift = 0
        while True:
            byte = payload[at]
            at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
        found.append(value)
    return found, payload[at:]


def main():
    data = open(sys.argv[1], "rb").read()
    size = struct.unpack_from("<I", data, 12)[0]
    lower, upper = struct.unpack_from("<3f", data, 26), struct.unpack_from("<3f", data, 38)
    header, at = {"lower": lower, "upper": upper}, 108
    while at + 6 <= size:
        tag, length = struct.unpack_from("<HI", data, at)
        if tag == 10:
            header["important"], header["finest"], degree, flags, header["steps"] = struct.unpack_from("<hhBBb", data, at + 6)
            header["degree"], header["trained"], header["tuned"] = degree & 15, degree >> 4, degree >> 4 == 2
            header["fine"] = flags >> 4 if degree >> 4 == 1 else 0
        at += 6 + length
    header["color"], header["less"], header["inner"], header["harmonic"] = \
        (1.0 / 90, 8, 4, 1.4) if header["trained"] else (1.0 / 128, 16, 3, 2)
    if header["tuned"]:
        header["harmonic"] = 3.5
    priors = table_of_priors() if header["trained"] else None
    edge = max(f32(b - a) for a, b in zip(lower, upper))
    scale = clamp(round(8 * (math.log2(f32(edge / 4)) + 40)), 0, 639)
    root = {"s": [scale] * 3, "a": 63, "leaf": False, "rotation": [0.0, 0.0, 0.0, 1.0],
            "position": [f32(a + f32(f32(b - a) * 0.5)) for a, b in zip(lower, upper)], "color": [0.5] * 3}
    clusters, per = {}, (header["degree"] + 1) ** 2 - 1
    for kind, payload in all_chunks(data, size):
        if kind == 20:
            (name, parent, first, count, _), rest = numbers(payload, 5)
            before = clusters[parent - 1] if parent else None
            covered = before["nodes"][first:first + count] if before else [root]
            coder, models, nodes = Range(rest), Models(before and before["models"], priors), []
            origins, unchanged = [], []  # indexes in the parent; whether a Gaussian is its parent
            for i, p in enumerate(covered):
                if p["leaf"]:
                    continue
                if before:
                    before["replaced"].add(first + i)
                more = min(models.short(coder, 16, "children"), 254) + 1
                origins += more * [first + i]
                unchanged += more * [bool(before) and more == 1]
                if before and more == 1:
                    nodes.append(p)
                    continue
                b = None
                for _ in range(more):
                    b = child(coder, models, p, b, header)
                    nodes.append(b)
            clusters[name] = {"nodes": nodes, "models": models, "replaced": set(), "harmonics": {}, "origins": origins,
                              "unchanged": unchanged, "parent": parent - 1 if parent else None}
        elif kind in (21, 22):
            (name, first, count), rest = numbers(payload, 3)
            cluster = clusters[name]
            chosen = [i for i, node in enumerate(cluster["nodes"])
                      if node["leaf"] == (kind == 21) and not cluster["unchanged"][i]]
            coder, models = Range(rest), Models()
            for i in range(first, first + count):
                node = cluster["nodes"][chosen[i]]
                step = header["harmonic"] * steps_of(node["s"], node["a"], node["leaf"], header)[2]
                own = []
                some = coder.yes(models["any"])
                for k in range(per):
                    band = 0 if k < 3 else 1 if k < 8 else 2
                    code = [0, 0, 0]
                    for c in range(3) if some else ():
                        mean = models.means.get((k, c), 64)
                        value = models.signed(coder, 8, (mean * mean).bit_length() - 7, "harmonic", band, c)
                        value = clamp(value, -(1 << 14), 1 << 14)
                        models.means[k, c] = max(1, mean + int((16 * min(abs(value), 2047) - mean) / 8))
                        code[c] = value
                    own += [f32(v) for v in rgb(code, step)]
                if some or kind == 21:
                    cluster["harmonics"][chosen[i]] = own
    for name in sorted(clusters):
        cluster = clusters[name]
        for i, node in enumerate(cluster["nodes"]):
            if i in cluster["replaced"]:
                continue
            # Harmonics of the Gaussian, else those of its nearest ancestor.
            at, number = cluster, i
            while number not in at["harmonics"] and at["parent"] is not None:
                at, number = clusters[at["parent"]], at["origins"][number]
            own = at["harmonics"].get(number, [0.0] * 3 * per)
            floats = node["rotation"] + node["position"] + node["color"] + own
            words = ["%08x" % struct.unpack("<I", struct.pack("<f", v + 0.0))[0] for v in floats]
            values = [*node["s"], node["a"]]
            if header["tuned"]:
                values = ["%.9g" % value for value in look(node, header)]
            print(*values, 1 if node["leaf"] else 0, *words)


if __name__ == "__main__":
    main()
