#include "qnv/codecs/values/cube_runs.h"

#include "qnv/base/short_number.h"
#include "qnv/codecs/values/block.h"
#include "qnv/codecs/values/cluster.h"

#include <algorithm>
#include <array>
#include <bit>
#include <type_traits>
#include <utility>

namespace gs::qnv::values {

namespace {

using displaced::BinaryDecoder;
using displaced::BinaryEncoder;
using displaced::unzigzag;
using displaced::zigzag;

/// Voxels of one cube that are in the volume.
struct CubeBox {
  std::size_t first = 0;  // index of the first voxel
  Extent size{};
};

CubeBox cube_box(std::uint64_t number, Extent extent, Extent cubes) {
  const std::uint64_t x = number % cubes[0], y = number / cubes[0] % cubes[1], z = number / cubes[0] / cubes[1];
  CubeBox box;
  box.first = ((z * kCubeEdge * extent[1]) + y * kCubeEdge) * extent[0] + x * kCubeEdge;
  const std::array<std::uint64_t, 3> at{x, y, z};
  for (std::size_t a = 0; a < 3; ++a)
    box.size[a] = static_cast<std::uint32_t>(std::min<std::uint64_t>(kCubeEdge, extent[a] - at[a] * kCubeEdge));
  return box;
}

/// Calls visit(index in the cube, index in the volume) for each voxel.
template <class Visit>
void each_voxel(const CubeBox& box, Extent extent, Visit&& visit) {
  for (std::uint32_t z = 0; z < box.size[2]; ++z)
    for (std::uint32_t y = 0; y < box.size[1]; ++y)
      for (std::uint32_t x = 0; x < box.size[0]; ++x)
        visit((z * kCubeEdge + y) * kCubeEdge + x, box.first + (z * std::size_t{extent[1]} + y) * extent[0] + x);
}

template <class Number>
bool all_zero(const CubeBox& box, Extent extent, std::span<const Number> numbers) {
  Number any = 0;
  each_voxel(box, extent, [&](std::uint32_t, std::size_t i) { any = any | numbers[i]; });
  return any == 0;
}

/// Encodes `bit`, or decodes one. Updates the estimate and returns the bit.
template <class Coder>
bool code(Coder& coder, Estimate& model, bool bit) {
  if constexpr (std::is_same_v<Coder, BinaryEncoder>)
    coder.put(model.probability(), bit);
  else
    bit = coder.get(model.probability());
  model.learn(bit);
  return bit;
}

/// Estimates of a run of gaps.
struct GapModels {
  std::array<Estimate, 3> same, full;  // by the state of the cube before
  std::array<Estimate, 8> voxel;
  std::size_t before = 0;  // state of a cube: 0 present, 1 missing, 2 mixed

  void encode(BinaryEncoder& coder, const CubeBox& box, Extent extent, std::span<const std::uint8_t> missing) {
    bool any = false, all = true;
    each_voxel(box, extent, [&](std::uint32_t, std::size_t i) {
      any = any || missing[i] != 0;
      all = all && missing[i] != 0;
    });
    const bool mixed = code(coder, same[before], any && !all);
    if (!mixed) (void)code(coder, full[before], all);
    std::array<bool, kCubeSize> near{};
    if (mixed)
      each_voxel(box, extent, [&](std::uint32_t k, std::size_t i) {
        near[k] = code(coder, voxel[context_of(near, k)], missing[i] != 0);
      });
    before = mixed ? 2 : all ? 1 : 0;
  }
  void decode(BinaryDecoder& coder, const CubeBox& box, Extent extent, std::span<std::uint8_t> missing) {
    const bool mixed = code(coder, same[before], false);
    const bool whole = !mixed && code(coder, full[before], false);
    std::array<bool, kCubeSize> near{};
    each_voxel(box, extent, [&](std::uint32_t k, std::size_t i) {
      if (mixed) near[k] = code(coder, voxel[context_of(near, k)], false);
      missing[i] = whole || near[k] ? 1 : 0;
    });
    before = mixed ? 2 : whole ? 1 : 0;
  }

 private:
  static std::size_t context_of(const std::array<bool, kCubeSize>& near, std::uint32_t k) {
    return (k % 4 > 0 && near[k - 1] ? 1 : 0) + (k / 4 % 4 > 0 && near[k - 4] ? 2 : 0) +
           (k >= 16 && near[k - 16] ? 4 : 0);
  }
};

/// Estimates of a run of remainders.
struct RemainderModels {
  std::array<Estimate, 12> zero;                     // by the bit length before
  std::array<std::array<Estimate, 32>, 12> lengths;  // binary tree of the bit length less 1
  std::uint32_t before = 0;

  void encode(BinaryEncoder& coder, const CubeBox& box, Extent extent, std::span<const std::uint32_t> numbers) {
    each_voxel(box, extent, [&](std::uint32_t, std::size_t i) {
      (void)code_number(coder, zigzag(static_cast<std::int32_t>(numbers[i])));
    });
  }
  void decode(BinaryDecoder& coder, const CubeBox& box, Extent extent, std::span<std::uint32_t> codes) {
    each_voxel(box, extent, [&](std::uint32_t, std::size_t i) {
      codes[i] += static_cast<std::uint32_t>(unzigzag(code_number(coder, 0)));
    });
  }

 private:
  template <class Coder>
  std::uint32_t code_number(Coder& coder, std::uint32_t number) {
    const std::size_t context = std::min(before / 3, 11u);
    if (code(coder, zero[context], number == 0)) return before = 0;
    const auto truth = static_cast<std::uint32_t>(std::bit_width(number)) - 1;
    std::uint32_t node = 1;
    for (int bit = 4; bit >= 0; --bit)
      node = node << 1 | (code(coder, lengths[context][node], (truth >> bit & 1) != 0) ? 1 : 0);
    before = (node & 31) + 1;
    if (before == 1) return 1;
    const int rest = static_cast<int>(before) - 1;
    if constexpr (std::is_same_v<Coder, BinaryEncoder>) {
      coder.put_bits(number & ((1u << rest) - 1), rest);
      return number;
    } else {
      return 1u << rest | coder.get_bits(rest);
    }
  }
};

template <class Number>
using ModelsOf = std::conditional_t<sizeof(Number) == 1, GapModels, RemainderModels>;

constexpr std::uint32_t kMostSkipped = 512;              // cubes without data inside of a run
constexpr std::size_t kRunEnd = kMaxClusterBytes - 300;  // a cube adds at most 280 bytes

// Extent of the cubes of a layer, and of its voxels.
Extent layer_extent(Extent extent, std::size_t voxels) {
  return {extent[0], extent[1], static_cast<std::uint32_t>(voxels / (std::size_t{extent[0]} * extent[1]))};
}

template <class Number>
std::vector<CubeRun> encode_runs(std::span<const Number> numbers, Extent extent) {
  std::vector<CubeRun> runs;
  RunEncoder<Number> encoder(extent, [&](CubeRun&& run) { runs.push_back(std::move(run)); });
  const std::size_t layer = std::size_t{extent[0]} * extent[1] * kCubeEdge;
  for (std::size_t at = 0; at < numbers.size(); at += layer)
    encoder.add(numbers.subspan(at, std::min(layer, numbers.size() - at)));
  encoder.finish();
  return runs;
}

// Decodes a run of a whole volume. Returns false if the run is not in the volume, or truncated.
template <class Number>
bool decode_run(const CubeRun& run, Extent extent, std::span<Number> numbers) {
  const Extent cubes = cube_extent(extent);
  const std::uint64_t all = std::uint64_t{cubes[0]} * cubes[1] * cubes[2];
  if (run.first >= all || run.count > all - run.first) return false;
  BinaryDecoder decoder(run.bytes);
  ModelsOf<Number> models;
  for (std::uint32_t i = 0; i < run.count && !decoder.exhausted(); ++i)
    models.decode(decoder, cube_box(run.first + i, extent, cubes), extent, numbers);
  return !decoder.exhausted();
}

// Decodes a run cube by cube, up to the cube `last`. Calls visit(cube, numbers). Returns false if the run is not in the
// volume, or truncated.
template <class Number, class Visit>
bool decode_cubes(const CubeRun& run, Extent extent, std::uint64_t last, const Visit& visit) {
  const Extent cubes = cube_extent(extent);
  const std::uint64_t all = std::uint64_t{cubes[0]} * cubes[1] * cubes[2];
  if (run.first >= all || run.count > all - run.first) return false;
  BinaryDecoder decoder(run.bytes);
  ModelsOf<Number> models;
  const std::uint64_t end = std::min(run.first + run.count, last == ~std::uint64_t{0} ? last : last + 1);
  for (std::uint64_t cube = run.first; cube < end && !decoder.exhausted(); ++cube) {
    std::array<Number, kCubeSize> numbers{};
    CubeBox box = cube_box(cube, extent, cubes);
    box.first = 0;
    models.decode(decoder, box, {kCubeEdge, kCubeEdge, kCubeEdge}, numbers);
    if (!decoder.exhausted() || sizeof(Number) == 1) visit(cube, numbers);
  }
  return !decoder.exhausted();
}

}  // namespace

Extent cube_extent(Extent extent) {
  for (std::uint32_t& n : extent) n = n / kCubeEdge + (n % kCubeEdge != 0 ? 1 : 0);
  return extent;
}

template <class Number>
struct RunEncoder<Number>::Open {
  CubeRun run;
  BinaryEncoder encoder;
  ModelsOf<Number> models;
  std::uint32_t skipped = 0;
};

template <class Number>
RunEncoder<Number>::RunEncoder(Extent extent, TakeRun take, std::uint64_t first_slab)
    : extent_(extent), take_(std::move(take)) {
  const Extent cubes = cube_extent(extent);
  next_ = first_slab * (kSlabSlices / kCubeEdge) * cubes[0] * cubes[1];
}
template <class Number>
RunEncoder<Number>::RunEncoder(RunEncoder&&) noexcept = default;
template <class Number>
RunEncoder<Number>::~RunEncoder() = default;

template <class Number>
void RunEncoder<Number>::add(std::span<const Number> layer) {
  const Extent extent = layer_extent(extent_, layer.size()), cubes = cube_extent(extent);
  const std::uint64_t count = std::uint64_t{cubes[0]} * cubes[1];
  if (next_ % (count * (kSlabSlices / kCubeEdge)) == 0) finish();
  for (std::uint64_t i = 0; i < count; ++i, ++next_) {
    const CubeBox box = cube_box(i, extent, cubes);
    const bool skips = all_zero(box, extent, layer);
    if (!open_) {
      if (skips) continue;
      open_ = std::make_unique<Open>();
      open_->run.first = next_;
    }
    open_->skipped = skips ? open_->skipped + 1 : 0;
    open_->models.encode(open_->encoder, box, extent, layer);
    ++open_->run.count;
    if (open_->encoder.size() >= kRunEnd || open_->run.count >= kMostRunCubes || open_->skipped >= kMostSkipped)
      close();
  }
}

template <class Number>
void RunEncoder<Number>::close() {
  open_->run.bytes = open_->encoder.finish();
  take_(std::move(open_->run));
  open_.reset();
}

template <class Number>
void RunEncoder<Number>::finish() {
  if (open_) close();
}

template <class Number>
struct RunDecoder<Number>::State {
  explicit State(CubeRun from) : run(std::move(from)), decoder(run.bytes) {}
  CubeRun run;
  BinaryDecoder decoder;
  ModelsOf<Number> models;
  std::uint32_t decoded = 0;  // number of cubes
};

template <class Number>
RunDecoder<Number>::RunDecoder(CubeRun run, Extent extent)
    : extent_(extent), state_(std::make_unique<State>(std::move(run))) {}
template <class Number>
RunDecoder<Number>::RunDecoder(RunDecoder&&) noexcept = default;
template <class Number>
RunDecoder<Number>& RunDecoder<Number>::operator=(RunDecoder&&) noexcept = default;
template <class Number>
RunDecoder<Number>::~RunDecoder() = default;

template <class Number>
bool RunDecoder<Number>::done() const {
  return state_->decoded >= state_->run.count;
}

template <class Number>
bool RunDecoder<Number>::decode(std::uint64_t layer, std::span<Number> voxels) {
  const Extent extent = layer_extent(extent_, voxels.size()), cubes = cube_extent(extent);
  const std::uint64_t count = std::uint64_t{cubes[0]} * cubes[1], first = layer * count;
  State& state = *state_;
  while (!done() && state.run.first + state.decoded < first + count && !state.decoder.exhausted()) {
    const std::uint64_t cube = state.run.first + state.decoded++;
    if (cube >= first) state.models.decode(state.decoder, cube_box(cube - first, extent, cubes), extent, voxels);
  }
  return !state.decoder.exhausted();
}

template class RunEncoder<std::uint8_t>;
template class RunEncoder<std::uint32_t>;
template class RunDecoder<std::uint8_t>;
template class RunDecoder<std::uint32_t>;

std::vector<CubeRun> encode_gaps(std::span<const std::uint8_t> missing, Extent extent) {
  return encode_runs(missing, extent);
}

std::vector<CubeRun> encode_remainders(std::span<const std::uint32_t> remainders, Extent extent) {
  return encode_runs(remainders, extent);
}

bool decode_gaps(const CubeRun& run, Extent extent, std::span<std::uint8_t> missing) {
  return decode_run(run, extent, missing);
}

bool decode_remainders(const CubeRun& run, Extent extent, std::span<std::uint32_t> codes) {
  return decode_run(run, extent, codes);
}

bool decode_gap_cubes(const CubeRun& run, Extent extent,
                      const std::function<void(std::uint64_t cube, std::uint64_t missing)>& visit) {
  return decode_cubes<std::uint8_t>(run, extent, ~std::uint64_t{0}, [&](std::uint64_t cube, const auto& voxels) {
    std::uint64_t missing = 0;
    for (std::size_t i = 0; i < voxels.size(); ++i) missing |= std::uint64_t{voxels[i]} << i;
    visit(cube, missing);
  });
}

bool decode_remainder_cubes(
    const CubeRun& run, Extent extent, std::uint64_t last,
    const std::function<void(std::uint64_t cube, std::span<const std::uint32_t, kCubeSize> numbers)>& visit) {
  return decode_cubes<std::uint32_t>(run, extent, last,
                                     [&](std::uint64_t cube, const auto& numbers) { visit(cube, numbers); });
}

std::vector<std::byte> pack(const CubeRun& run) {
  std::vector<std::byte> out;
  put_number(out, run.first);
  put_number(out, run.count);
  out.insert(out.end(), run.bytes.begin(), run.bytes.end());
  return out;
}

std::optional<CubeRun> parse_run(std::span<const std::byte> payload) {
  if (payload.size() > kMaxComponentBytes) return std::nullopt;
  const auto first = take_wide_number(payload), count = take_wide_number(payload);
  if (!first || !count || *count == 0 || *count > kMostRunCubes) return std::nullopt;
  return CubeRun{*first, static_cast<std::uint32_t>(*count), {payload.begin(), payload.end()}};
}

}  // namespace gs::qnv::values
