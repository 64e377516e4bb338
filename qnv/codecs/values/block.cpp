#include "qnv/codecs/values/block.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gs::qnv::values {

namespace {

constexpr std::uint32_t kSign = std::uint32_t{1} << 31;
constexpr std::uint32_t kMaxSize = 4;  // of a coefficient in units of the plane, as a neighbour

std::uint32_t magnitude_of(std::int32_t value) {
  const auto v = static_cast<std::uint32_t>(value);
  return (value < 0 ? 0u - v : v) & ~kSign;
}

// Middle of the possible values of a magnitude with known planes `lowest` and above. Small ones are more frequent.
std::uint32_t middle(std::uint32_t magnitude, int lowest) {
  if (magnitude == 0 || lowest == 0) return magnitude;
  return magnitude + static_cast<std::uint32_t>((std::uint64_t{3} << lowest) >> 3);
}

// Context of a coefficient that is zero so far, by the sum of its neighbours' sizes.
constexpr std::array<std::uint8_t, 128> kContexts = [] {
  std::array<std::uint8_t, 128> contexts{};
  constexpr std::array<int, 16> kFirst{0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 19, 24, 32, 42};
  for (int sum = 0; sum < 128; ++sum) {
    std::uint8_t context = 0;
    while (context < 15 && sum >= kFirst[context + 1u]) ++context;
    contexts[static_cast<std::size_t>(sum)] = context;
  }
  return contexts;
}();

std::uint64_t eight_bytes(const std::uint8_t* at) {
  std::uint64_t bytes;
  std::memcpy(&bytes, at, 8);
  if constexpr (std::endian::native == std::endian::big) bytes = __builtin_bswap64(bytes);
  return bytes;
}

// Sums of the neighbours' sizes of four coefficients, one per byte: faces count twice, edges once. `at` is the first
// coefficient.
std::uint32_t neighbour_sums(const std::uint8_t* at, std::uint32_t row, std::uint32_t slice) {
  const std::uint8_t* const left = at - 1;
  const std::uint64_t own = eight_bytes(left);
  const std::uint64_t faces =
      eight_bytes(left - row) + eight_bytes(left + row) + eight_bytes(left - slice) + eight_bytes(left + slice);
  const std::uint64_t edges = eight_bytes(left - slice - row) + eight_bytes(left - slice + row) +
                              eight_bytes(left + slice - row) + eight_bytes(left + slice + row);
  const std::uint64_t sums = faces + ((2 * faces + edges) >> 8) + (faces >> 16) + 2 * (own + (own >> 16));
  return static_cast<std::uint32_t>(sums);
}

struct EncodingSide {
  BinaryEncoder* coder;
  const std::int32_t* source = nullptr;  // of the current cube
  double weight = 1;
  double gain = 0;
  static constexpr bool kEncodes = true;

  bool code(Estimate& model, bool bit) {
    coder->put(model.probability(), bit);
    model.learn(bit);
    return bit;
  }
  bool code_bit(bool bit) {
    coder->put_bits(bit ? 1 : 0, 1);
    return bit;
  }
  std::uint32_t code_sign(bool minus) { return code_bit(minus) ? kSign : 0; }
};

struct DecodingSide {
  BinaryDecoder coder;
  static constexpr bool kEncodes = false;

  bool code(Estimate& model, bool) {
    const bool bit = coder.get(model.probability());
    model.learn(bit);
    return bit;
  }
  bool code_bit(bool) { return coder.get_bits(1) != 0; }
  std::uint32_t code_sign(bool) { return coder.get_bits(1) << 31; }
};

}  // namespace

BlockBands bands_in_volume(const BlockPlace& place, std::span<std::int32_t> volume, Extent extent) {
  BlockBands bands;
  bands.row = extent[0];
  for (std::uint32_t i = 0; i < place.band_count; ++i) {
    const BandPart& part = place.bands[i];
    for (std::uint32_t z = 0; z < part.size[2]; ++z) {
      const std::size_t at = ((std::size_t{part.first[2]} + z) * extent[1] + part.first[1]) * extent[0] + part.first[0];
      if (at < volume.size()) bands.parts[i][z] = volume.data() + at;
    }
  }
  return bands;
}

Block::Block(const BlockPlace& place) : place_(place) {
  for (const BandPart& part : std::span(place_.bands).first(place_.band_count)) {
    Band band;
    for (std::size_t a = 0; a < 3; ++a)
      band.cubes[a] = static_cast<std::uint8_t>((part.size[a] + kCubeEdge - 1) / kCubeEdge);
    band.row = band.cubes[0] * kCubeEdge + 8;
    band.slice = band.row * (band.cubes[1] * kCubeEdge + 2);
    band.first = sizes_bytes_ + band.slice + band.row + 4;
    sizes_bytes_ += band.slice * (band.cubes[2] * kCubeEdge + 2);
    band.first_cube = static_cast<std::uint16_t>(cubes_.size());
    for (std::uint8_t z = 0; z < band.cubes[2]; ++z)
      for (std::uint8_t y = 0; y < band.cubes[1]; ++y)
        for (std::uint8_t x = 0; x < band.cubes[0]; ++x) {
          Cube cube;
          cube.band = static_cast<std::uint8_t>(bands_.size());
          cube.at = {x, y, z};
          for (std::size_t a = 0; a < 3; ++a)
            cube.size[a] = static_cast<std::uint8_t>(std::min(kCubeEdge, part.size[a] - cube.at[a] * kCubeEdge));
          cubes_.push_back(cube);
        }
    bands_.push_back(band);
  }
  // The estimates begin with what most volumes have: a probability that grows with the neighbours.
  for (std::size_t i = 0; i < cube_models_.size(); ++i)
    cube_models_[i].start(
        static_cast<std::uint32_t>(std::min<std::size_t>(9000 + 5500 * (i / 3) + 6000 * (i % 3), 58000)));
  for (Estimate& model : line_models_) model.start(6000);
  for (auto& models : one_models_)
    for (std::size_t i = 0; i < models.size(); ++i)
      models[i].start(static_cast<std::uint32_t>(std::min<std::size_t>(1700 + 2300 * i, 34000)));
  for (std::size_t i = 0; i < more_models_.size(); ++i)
    more_models_[i].start(static_cast<std::uint32_t>(26000 + 900 * i));
}

int Block::load(const BlockBands& bands) {
  source_.assign(cubes_.size() * kCubeSize, 0);
  std::uint32_t bits = 0;
  std::int32_t* to = source_.data();
  for (const Cube& cube : cubes_) {
    for (std::uint32_t z = 0; z < cube.size[2]; ++z) {
      const std::int32_t* from = bands.parts[cube.band][cube.at[2] * kCubeEdge + z] +
                                 cube.at[1] * kCubeEdge * bands.row + cube.at[0] * kCubeEdge;
      for (std::uint32_t y = 0; y < cube.size[1]; ++y, from += bands.row)
        for (std::uint32_t x = 0; x < cube.size[0]; ++x) {
          const std::int32_t value = from[x];
          to[(z * kCubeEdge + y) * kCubeEdge + x] = value;
          bits |= magnitude_of(value);
        }
    }
    to += kCubeSize;
  }
  return std::bit_width(bits) - 1;
}

double Block::energy() const {
  double energy = 0;
  for (std::size_t i = 0; i < cubes_.size(); ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < kCubeSize; ++k) {
      const double value = source_[i * kCubeSize + k];
      sum += value * value;
    }
    energy += sum * error_weight(place_.level, place_.bands[cubes_[i].band].highs);
  }
  return energy;
}

void Block::write(const Cube& cube, const BlockBands& bands) const {
  const std::uint32_t* from = values_.data() + static_cast<std::size_t>(cube.values) * kCubeSize;
  for (std::uint32_t z = 0; z < cube.size[2]; ++z)
    for (std::uint32_t y = 0; y < cube.size[1]; ++y) {
      std::int32_t* to = bands.parts[cube.band][cube.at[2] * kCubeEdge + z] + (cube.at[1] * kCubeEdge + y) * bands.row +
                         cube.at[0] * kCubeEdge;
      for (std::uint32_t x = 0; x < cube.size[0]; ++x) {
        const std::uint32_t value = from[(z * kCubeEdge + y) * kCubeEdge + x];
        const std::uint32_t size = middle(value & ~kSign, cube.lowest);
        to[x] = static_cast<std::int32_t>((value & kSign) != 0 ? 0u - size : size);
      }
    }
}

void Block::write(const BlockBands& bands) const {
  for (const Cube& cube : cubes_)
    if (cube.values >= 0) write(cube, bands);
}

void Block::write_low(std::span<std::int32_t> bands, Extent extent) const {
  const BlockBands in_volume = bands_in_volume(place_, bands, extent);
  for (const Cube& cube : cubes_)
    if (cube.values >= 0 && place_.bands[cube.band].highs == 0) write(cube, in_volume);
}

Extent Block::band_place(const Cube& cube) const {
  Extent at{};
  for (std::size_t a = 0; a < 3; ++a) at[a] = (place_.first[a] >> place_.level) + cube.at[a] * kCubeEdge;
  return at;
}

void Block::write_split(const SplitWindow& window) const {
  const std::size_t row = window.size[0], slice = row * window.size[1], lows = (row + 1) / 2;
  for (std::size_t b = 0; b < bands_.size(); ++b) {
    const BandPart& part = place_.bands[b];
    const Band& band = bands_[b];
    if (part.highs == 0) continue;
    Extent base{}, high{}, low_end{}, first{}, last{};  // places in the band, and cubes in the window
    for (std::size_t a = 0; a < 3; ++a) {
      base[a] = place_.first[a] >> place_.level;
      high[a] = part.first[a] != base[a] ? 1 : 0;
      low_end[a] = std::min(base[a] + part.size[a], (window.first[a] + window.size[a] - high[a] + 1) / 2);
      first[a] = (std::max(base[a], window.first[a] / 2) - base[a]) / kCubeEdge;
      last[a] = low_end[a] > base[a] ? (low_end[a] - base[a] + kCubeEdge - 1) / kCubeEdge : 0;
    }
    for (std::uint32_t k = first[2]; k < last[2]; ++k)
      for (std::uint32_t j = first[1]; j < last[1]; ++j)
        for (std::uint32_t i = first[0]; i < last[0]; ++i) {
          const Cube& cube = cubes_[band.first_cube + (k * band.cubes[1] + j) * band.cubes[0] + i];
          if (cube.values < 0) continue;
          const Extent at = band_place(cube);
          const std::uint32_t* from = values_.data() + static_cast<std::size_t>(cube.values) * kCubeSize;
          Extent begin{}, end{};
          for (std::size_t a = 0; a < 3; ++a) {
            begin[a] = std::max(at[a], window.first[a] / 2);
            end[a] = std::min(at[a] + cube.size[a], low_end[a]);
          }
          for (std::uint32_t z = begin[2]; z < end[2]; ++z)
            for (std::uint32_t y = begin[1]; y < end[1]; ++y) {
              const std::uint32_t* const line = from + ((z - at[2]) * kCubeEdge + (y - at[1])) * kCubeEdge;
              std::int32_t* const to = window.samples + (2 * z + high[2] - window.first[2]) * slice +
                                       (2 * y + high[1] - window.first[1]) * row + (high[0] != 0 ? lows : 0);
              for (std::uint32_t x = begin[0]; x < end[0]; ++x) {
                const std::uint32_t value = line[x - at[0]], size = middle(value & ~kSign, cube.lowest);
                to[x - window.first[0] / 2] = static_cast<std::int32_t>((value & kSign) != 0 ? 0u - size : size);
              }
            }
        }
  }
}

void Block::fill_sizes(std::vector<std::uint8_t>& sizes) const {
  sizes.assign(sizes_bytes_ + 8, 0);
  for (std::size_t i = 0; i < cubes_.size(); ++i) {
    const Cube& cube = cubes_[i];
    if (cube.values < 0) continue;
    const Band& band = bands_[cube.band];
    const std::uint32_t* const values = values_.data() + static_cast<std::size_t>(cube.values) * kCubeSize;
    std::array<std::uint8_t, kCubeSize> all;
    for (std::uint32_t k = 0; k < kCubeSize; ++k)
      all[k] = static_cast<std::uint8_t>(std::min((values[k] & ~kSign) >> plane_, kMaxSize));
    const std::uint8_t* from = all.data();
    for (std::uint32_t z = 0; z < kCubeEdge; ++z)
      for (std::uint32_t y = 0; y < kCubeEdge; ++y, from += kCubeEdge)
        std::memcpy(sizes.data() + band.first + (cube.at[2] * kCubeEdge + z) * band.slice +
                        (cube.at[1] * kCubeEdge + y) * band.row + cube.at[0] * kCubeEdge,
                    from, kCubeEdge);
  }
}

std::size_t Block::cube_context(std::size_t index) const {
  const Cube& cube = cubes_[index];
  const Band& band = bands_[cube.band];
  const std::array<std::size_t, 3> strides{1, band.cubes[0], std::size_t{band.cubes[0]} * band.cubes[1]};
  std::size_t active = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (cube.at[a] > 0 && cubes_[index - strides[a]].values >= 0) ++active;
    if (cube.at[a] + 1 < band.cubes[a] && cubes_[index + strides[a]].values >= 0) ++active;
  }
  // The same cube of the band before.
  std::size_t other = 0;
  if (cube.band > 0) {
    const Band& before = bands_[cube.band - 1u];
    if (before.cubes == band.cubes) other = cubes_[before.first_cube + index - band.first_cube].values >= 0 ? 2 : 1;
  }
  return std::min<std::size_t>(active, 4) * 3 + other;
}

template <class Side>
void Block::code_values(Side& outer, Cube& cube, const Band& band, std::uint8_t* sizes) {
  Side side = outer;  // a local copy stays in registers
  std::uint32_t* values = values_.data() + static_cast<std::size_t>(cube.values) * kCubeSize;
  Estimate& lines = line_models_[static_cast<std::size_t>(place_.bands[cube.band].highs)];
  auto& ones = one_models_[static_cast<std::size_t>(place_.bands[cube.band].highs)];
  const std::uint32_t bit = 1u << plane_;
  [[maybe_unused]] double gain = 0;
  for (std::uint32_t z = 0; z < cube.size[2]; ++z)
    for (std::uint32_t y = 0; y < cube.size[1]; ++y) {
      std::uint8_t* const at = sizes + band.first + (cube.at[2] * kCubeEdge + z) * band.slice +
                               (cube.at[1] * kCubeEdge + y) * band.row + cube.at[0] * kCubeEdge;
      std::uint32_t sums = neighbour_sums(at, band.row, band.slice);
      std::uint32_t* const line = values + (z * kCubeEdge + y) * kCubeEdge;
      // A line of zeros without neighbours takes one decision.
      std::uint32_t known_one = kCubeEdge;
      if (sums == 0 && cube.size[0] == kCubeEdge && (line[0] | line[1] | line[2] | line[3]) == 0) {
        bool any = false;
        if constexpr (Side::kEncodes)
          for (std::uint32_t x = 0; x < kCubeEdge; ++x)
            any = any || magnitude_of(side.source[(z * kCubeEdge + y) * kCubeEdge + x]) >> plane_ != 0;
        if (!side.code(lines, any)) continue;
        known_one = kCubeEdge - 1;
      }
      for (std::uint32_t x = 0; x < cube.size[0]; ++x, sums >>= 8) {
        [[maybe_unused]] std::int32_t truth = 0;
        bool one = false;
        if constexpr (Side::kEncodes) {
          truth = side.source[(z * kCubeEdge + y) * kCubeEdge + x];
          one = (magnitude_of(truth) & bit) != 0;
        }
        const std::uint32_t sum = sums & 255;
        const std::uint32_t old = line[x];
        if (old == 0) {
          if (x == known_one || side.code(ones[kContexts[sum]], one)) {
            line[x] = bit | side.code_sign(truth < 0);
            at[x] = 1;
            known_one = kCubeEdge;
            sums += 2u << 8;
          }
        } else {
          // Only the first bit after the highest one is worth an estimate.
          const bool more = at[x] == 2 ? side.code(more_models_[std::min(sum >> 3, 3u)], one) : side.code_bit(one);
          if (more) {
            line[x] = old | bit;
            if (at[x] < kMaxSize) {
              ++at[x];
              sums += 2u << 8;
            }
          }
        }
        if constexpr (Side::kEncodes) {
          if (line[x] == 0) continue;  // its error does not change
          const auto size = static_cast<std::int64_t>(magnitude_of(truth));
          const std::int64_t before = size - middle(old & ~kSign, plane_ + 1);
          const std::int64_t after = size - middle(line[x] & ~kSign, plane_);
          gain += static_cast<double>(before * before - after * after);
        }
      }
    }
  cube.lowest = static_cast<std::uint8_t>(plane_);
  if constexpr (Side::kEncodes) side.gain += gain * error_weight(place_.level, place_.bands[cube.band].highs);
  outer = side;
}

template <class Side>
void Block::step(Side& side, std::uint8_t* sizes) {
  Cube& cube = cubes_[cube_];
  if constexpr (Side::kEncodes) side.source = source_.data() + cube_ * kCubeSize;
  if (cube.values < 0) {
    bool any = false;
    if constexpr (Side::kEncodes) {
      std::uint32_t bits = 0;
      for (std::uint32_t i = 0; i < kCubeSize; ++i) bits |= magnitude_of(side.source[i]);
      any = bits >> plane_ != 0;
    }
    if (side.code(cube_models_[cube_context(cube_)], any)) {
      cube.values = static_cast<std::int16_t>(values_.size() / kCubeSize);
      values_.resize(values_.size() + kCubeSize, 0);
    }
  }
  if (cube.values >= 0) code_values(side, cube, bands_[cube.band], sizes);
  if (++cube_ == cubes_.size()) {
    cube_ = 0;
    --plane_;
  }
}

Block::Encoded Block::encode(BinaryEncoder& encoder, std::size_t plane_bytes, std::size_t most_bytes, int last_plane,
                             BlockScratch& scratch) {
  EncodingSide side{&encoder};
  Encoded encoded;
  fill_sizes(scratch.sizes);
  do {
    step(side, scratch.sizes.data());
    ++encoded.steps;
    if (at_plane_start()) {
      if (plane_ < last_plane || encoder.size() >= plane_bytes) break;
      fill_sizes(scratch.sizes);
    }
  } while (encoder.size() < most_bytes);
  encoded.gain = side.gain;
  return encoded;
}

std::size_t Block::decode(BinaryDecoder& decoder, std::uint32_t steps, BlockScratch& scratch) {
  if (plane_ < 0 || cubes_.empty()) return 0;
  DecodingSide side{decoder};
  fill_sizes(scratch.sizes);
  std::size_t done = 0;
  while (done < steps && !side.coder.exhausted()) {
    step(side, scratch.sizes.data());
    ++done;
    if (plane_ < 0) break;
    if (at_plane_start() && done < steps) fill_sizes(scratch.sizes);
  }
  return done;
}

}  // namespace gs::qnv::values
