#include "qnv/codecs/values/cube_runs.h"

#include "qnv/base/short_number.h"
#include "qnv/codecs/values/block.h"
#include "qnv/codecs/values/cluster.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace gs::qnv::values {

namespace {

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

template <class Numbers>
bool all_zero(const CubeBox& box, Extent extent, const Numbers& numbers) {
  bool any = false;
  each_voxel(box, extent, [&](std::uint32_t, std::size_t i) { any = any || numbers[i] != 0; });
  return !any;
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

  template <class Coder>
  void code_cube(Coder& coder, const CubeBox& box, Extent extent, std::span<std::uint8_t> missing) {
    [[maybe_unused]] std::size_t state = 0;
    if constexpr (std::is_same_v<Coder, BinaryEncoder>) {
      bool any = false, all = true;
      each_voxel(box, extent, [&](std::uint32_t, std::size_t i) {
        any = any || missing[i] != 0;
        all = all && missing[i] != 0;
      });
      state = all ? 1 : any ? 2 : 0;
    }
    const bool mixed = code(coder, same[before], state == 2);
    const bool whole = !mixed && code(coder, full[before], state == 1);
    std::array<bool, kCubeSize> near{};
    each_voxel(box, extent, [&](std::uint32_t k, std::size_t i) {
      if (!mixed) {
        missing[i] = whole ? 1 : 0;
        return;
      }
      const std::size_t context = (k % 4 > 0 && near[k - 1] ? 1 : 0) + (k / 4 % 4 > 0 && near[k - 4] ? 2 : 0) +
                                  (k >= 16 && near[k - 16] ? 4 : 0);
      near[k] = code(coder, voxel[context], missing[i] != 0);
      missing[i] = near[k] ? 1 : 0;
    });
    before = mixed ? 2 : whole ? 1 : 0;
  }
};

/// Estimates of a run of remainders.
struct RemainderModels {
  std::array<Estimate, 12> zero;                     // by the bit length before
  std::array<std::array<Estimate, 32>, 12> lengths;  // binary tree of the bit length less 1
  std::uint32_t before = 0;

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

/// Cuts all cubes of a volume into runs. `skip(box)` reports a cube that needs no data; `put(encoder, box)` codes one.
template <class Models, class Skip, class Put>
std::vector<CubeRun> encode_runs(Extent extent, Skip&& skip, Put&& put) {
  const Extent cubes = cube_extent(extent);
  const std::uint64_t all = std::uint64_t{cubes[0]} * cubes[1] * cubes[2];
  constexpr std::uint32_t kMostSkipped = 512;           // cubes without data inside of a run
  constexpr std::size_t kEnd = kMaxClusterBytes - 300;  // a cube adds at most 280 bytes
  std::vector<CubeRun> runs;
  for (std::uint64_t at = 0; at < all;) {
    if (skip(cube_box(at, extent, cubes))) {
      ++at;
      continue;
    }
    CubeRun run{at, 0, {}};
    BinaryEncoder encoder;
    Models models;
    std::uint32_t skipped = 0;
    while (at < all && encoder.size() < kEnd && run.count < kMostRunCubes && skipped < kMostSkipped) {
      const CubeBox box = cube_box(at, extent, cubes);
      skipped = skip(box) ? skipped + 1 : 0;
      put(models, encoder, box);
      ++at;
      ++run.count;
    }
    run.bytes = encoder.finish();
    runs.push_back(std::move(run));
  }
  return runs;
}

// Calls take(models, decoder, box) for each cube of a run. Returns false if the run is not in the volume, or truncated.
template <class Models, class Take>
bool decode_run(const CubeRun& run, Extent extent, Take&& take) {
  const Extent cubes = cube_extent(extent);
  const std::uint64_t all = std::uint64_t{cubes[0]} * cubes[1] * cubes[2];
  if (run.first >= all || run.count > all - run.first) return false;
  BinaryDecoder decoder(run.bytes);
  Models models;
  for (std::uint32_t i = 0; i < run.count && !decoder.exhausted(); ++i)
    take(models, decoder, cube_box(run.first + i, extent, cubes));
  return !decoder.exhausted();
}

}  // namespace

Extent cube_extent(Extent extent) {
  for (std::uint32_t& n : extent) n = n / kCubeEdge + (n % kCubeEdge != 0 ? 1 : 0);
  return extent;
}

std::vector<CubeRun> encode_gaps(std::span<std::uint8_t> missing, Extent extent) {
  return encode_runs<GapModels>(
      extent, [&](const CubeBox& box) { return all_zero(box, extent, missing); },
      [&](GapModels& models, BinaryEncoder& encoder, const CubeBox& box) {
        models.code_cube(encoder, box, extent, missing);
      });
}

bool decode_gaps(const CubeRun& run, Extent extent, std::span<std::uint8_t> missing) {
  return decode_run<GapModels>(run, extent, [&](GapModels& models, BinaryDecoder& decoder, const CubeBox& box) {
    models.code_cube(decoder, box, extent, missing);
  });
}

std::vector<CubeRun> encode_remainders(std::span<const std::uint32_t> remainders, Extent extent) {
  return encode_runs<RemainderModels>(
      extent, [&](const CubeBox& box) { return all_zero(box, extent, remainders); },
      [&](RemainderModels& models, BinaryEncoder& encoder, const CubeBox& box) {
        each_voxel(box, extent, [&](std::uint32_t, std::size_t i) {
          (void)models.code_number(encoder, zigzag(static_cast<std::int32_t>(remainders[i])));
        });
      });
}

bool decode_remainders(const CubeRun& run, Extent extent, std::span<std::uint32_t> codes) {
  return decode_run<RemainderModels>(
      run, extent, [&](RemainderModels& models, BinaryDecoder& decoder, const CubeBox& box) {
        each_voxel(box, extent, [&](std::uint32_t, std::size_t i) {
          codes[i] += static_cast<std::uint32_t>(unzigzag(models.code_number(decoder, 0)));
        });
      });
}

std::vector<std::byte> pack(const CubeRun& run) {
  std::vector<std::byte> out;
  put_number(out, run.first);
  put_number(out, run.count);
  out.insert(out.end(), run.bytes.begin(), run.bytes.end());
  return out;
}

std::optional<CubeRun> parse_run(std::span<const std::byte> payload) {
  if (payload.size() > kMaxClusterBytes) return std::nullopt;
  const auto first = take_wide_number(payload), count = take_wide_number(payload);
  if (!first || !count || *count == 0 || *count > kMostRunCubes) return std::nullopt;
  return CubeRun{*first, static_cast<std::uint32_t>(*count), {payload.begin(), payload.end()}};
}

}  // namespace gs::qnv::values
