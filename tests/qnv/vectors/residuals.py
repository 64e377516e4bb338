"""What payloads of octrees share: residuals and occupancy in eight interleaved rANS states, from FORMAT.md alone."""
import struct

DECAY = [4, 10, 18, 28, 40, 54, 70, 88, 106, 126, 146, 166, 186, 204, 222, 240]


def residual_model(decay):
    weights, w = [], 1 << 24
    for symbol in range(31):
        if symbol % 2 == 1:
            w = w * decay // 256
        weights.append(w)
    weights.append(2 * w * decay // (256 - decay))
    total = sum(weights)
    frequencies = [1 + weight * 4064 // total for weight in weights]
    frequencies[0] += 4096 - sum(frequencies)
    starts, at = [], 0
    for frequency in frequencies:
        starts.append(at)
        at += frequency
    slots = []
    for symbol, frequency in enumerate(frequencies):
        slots += [symbol] * frequency
    return starts, frequencies, slots


MODELS = [residual_model(d) for d in DECAY]


class Rans:
    def __init__(self, data):
        self.x = list(struct.unpack_from("<8I", data))
        self.words = struct.unpack_from("<%dH" % ((len(data) - 32) // 2), data, 32)
        self.at = 0

    def take(self, lane, start, frequency):
        x = frequency * (self.x[lane] >> 12) + (self.x[lane] & 4095) - start
        if x < 65536:
            x = x * 65536 + (self.words[self.at] if self.at < len(self.words) else 0)
            self.at += 1
        self.x[lane] = x

    def bit(self, lane, probability):
        if (self.x[lane] & 4095) < probability:
            self.take(lane, 0, probability)
            return 1
        self.take(lane, probability, 4096 - probability)
        return 0

    def residuals(self, models):
        out = []
        for first in range(0, len(models), 8):
            group = models[first:first + 8]
            symbols = []
            for lane, model in enumerate(group):
                starts, frequencies, slots = MODELS[model]
                symbol = slots[self.x[lane] & 4095]
                self.take(lane, starts[symbol], frequencies[symbol])
                symbols.append(symbol)
            for lane, symbol in enumerate(symbols):
                if symbol == 31:
                    symbol = self.x[lane] & 4095
                    self.take(lane, symbol, 1)
                out.append(-(symbol + 1) // 2 if symbol % 2 else symbol // 2)
        return out

    def even(self):
        return all(x == 65536 for x in self.x) and self.at == len(self.words)


def clamp(v, low, high):
    return max(low, min(high, v))
