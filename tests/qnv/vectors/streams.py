"""What decoders of streams share: chunks, and normals in an octahedron, from FORMAT.md alone."""
import struct
import sys
import zlib

from residuals import clamp


def all_chunks(data, at):
    """Types and payloads of the chunks from byte `at`."""
    while at + 10 <= len(data):
        mark, size, kind, _, checksum = struct.unpack_from("<HHBBI", data, at)
        payload = data[at + 10:at + 10 + size]
        if mark != 0x4351 or zlib.crc32(data[at:at + 6] + payload) != checksum:
            sys.exit("a damaged chunk at byte %d" % at)
        at += 10 + size
        yield kind, payload


def chunks(data, at, wanted):
    """Payloads of the chunks of type `wanted`, from byte `at`."""
    return (payload for kind, payload in all_chunks(data, at) if kind == wanted)


def product(a, b):
    """Product in the field of 256 elements."""
    result = 0
    while b:
        if b & 1:
            result ^= a
        a = a << 1 ^ (0x11D if a & 128 else 0)
        b >>= 1
    return result


INVERSE = [0] + [next(b for b in range(1, 256) if product(a, b) == 1) for a in range(1, 256)]


def restored(found):
    """Adds the chunks that parity restores to a list of types and payloads."""
    known, groups = {}, {}
    for kind, payload in found:
        if kind != 17:
            start = struct.pack("<HHBB", 0x4351, len(payload), kind, 0)
            known[zlib.crc32(start + payload)] = struct.pack("<BH", kind, len(payload)) + payload
            continue
        k = payload[0]
        members = struct.unpack_from("<%dI" % k, payload, 2)
        groups.setdefault(members, {})[payload[1]] = payload[2 + 4 * k:]
    again = True
    while again:
        again = False
        for members, parity in groups.items():
            missing = [d for d in range(len(members)) if members[d] not in known]
            if not missing or len(missing) > len(parity):
                continue
            again = True
            rows = []
            for i, total in list(parity.items())[:len(missing)]:
                total = bytearray(total)
                for d, name in enumerate(members):
                    if name in known:
                        weight = INVERSE[i ^ d]
                        for j, byte in enumerate(known[name]):
                            total[j] ^= product(weight, byte)
                rows.append([[INVERSE[i ^ d] for d in missing], total])
            for c in range(len(rows)):
                pivot = next(r for r in range(c, len(rows)) if rows[r][0][c])
                rows[c], rows[pivot] = rows[pivot], rows[c]
                scale = INVERSE[rows[c][0][c]]
                rows[c] = [[product(scale, v) for v in part] for part in rows[c]]
                for r in range(len(rows)):
                    by = rows[r][0][c]
                    if r != c and by:
                        rows[r] = [[v ^ product(by, w) for v, w in zip(*parts)] for parts in zip(rows[r], rows[c])]
            for d, (_, piece) in zip(missing, rows):
                kind, size = struct.unpack("<BH", bytes(piece[:3]))
                payload = bytes(piece[3:3 + size])
                if zlib.crc32(struct.pack("<HHBB", 0x4351, size, kind, 0) + payload) != members[d]:
                    sys.exit("parity restored a wrong chunk")
                known[members[d]] = bytes(piece[:3 + size])
                found.append((kind, payload))
    return found


def sign(v):
    return -1 if v < 0 else 1


def normal(u, v):
    w = 1024 - abs(u) - abs(v)
    return (u, v, w) if w >= 0 else (sign(u) * (1024 - abs(v)), sign(v) * (1024 - abs(u)), w)


def wrap(u, v):
    if abs(u) > 1024:
        u, v = 2048 * sign(u) - u, -v
    if abs(v) > 1024:
        v, u = 2048 * sign(v) - v, -u
    return clamp(u, -1024, 1024), clamp(v, -1024, 1024)
