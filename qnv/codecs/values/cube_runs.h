#pragma once

#include "qnv/codecs/values/block_places.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::values {

// Per-voxel data outside of the transform: gaps, and remainders of exact or corrected values. Both visit the volume in
// cubes of kCubeEdge voxels per axis, x first. A run of cubes is one chunk, which is decoded alone. FORMAT.md, "Gaps"
// and "Remainders".

/// Run of cubes as the payload of a chunk.
struct CubeRun {
  std::uint64_t first = 0;  // number of the first cube
  std::uint32_t count = 0;
  std::vector<std::byte> bytes;
};

/// Maximum number of cubes of a run.
inline constexpr std::uint32_t kMostRunCubes = 1u << 20;
/// Number of slices in a slab. Encoders end runs at the end of each slab, so that slabs are independent.
inline constexpr std::uint32_t kSlabSlices = 32;

/// Returns the number of cubes per axis.
[[nodiscard]] Extent cube_extent(Extent extent);

[[nodiscard]] std::vector<std::byte> pack(const CubeRun& run);
/// Safe for untrusted bytes.
[[nodiscard]] std::optional<CubeRun> parse_run(std::span<const std::byte> payload);

/// Function that takes a finished run.
using TakeRun = std::function<void(CubeRun&&)>;

/// Encoder of runs for a volume that arrives in layers of kCubeEdge slices. Runs without content are left out.
/// `Number` is std::uint8_t for gaps (1 for missing voxels), and std::uint32_t for remainders.
template <class Number>
class RunEncoder {
 public:
  /// `first_slab` is the number of the first slab that the caller adds.
  RunEncoder(Extent extent, TakeRun take, std::uint64_t first_slab = 0);
  RunEncoder(RunEncoder&&) noexcept;
  ~RunEncoder();

  /// Adds the next layer; the last one may have fewer slices.
  void add(std::span<const Number> layer);
  /// Ends the last run.
  void finish();

 private:
  struct Open;  // run that is not finished
  void close();

  Extent extent_;
  TakeRun take_;
  std::uint64_t next_ = 0;  // number of the next cube
  std::unique_ptr<Open> open_;
};
using GapEncoder = RunEncoder<std::uint8_t>;
using RemainderEncoder = RunEncoder<std::uint32_t>;

/// Decoder of one run, layer by layer. Safe for untrusted runs.
template <class Number>
class RunDecoder {
 public:
  RunDecoder(CubeRun run, Extent extent);
  RunDecoder(RunDecoder&&) noexcept;
  RunDecoder& operator=(RunDecoder&&) noexcept;
  ~RunDecoder();

  /// Decodes the cubes of the run in a layer: sets which voxels are missing, or adds remainders. Layers must come in
  /// order. Returns false if the run is truncated.
  bool decode(std::uint64_t layer, std::span<Number> voxels);
  /// Reports whether all cubes of the run are decoded.
  [[nodiscard]] bool done() const;

 private:
  struct State;
  Extent extent_;
  std::unique_ptr<State> state_;
};

/// Encodes which voxels of a whole volume are missing, and remainders, one per voxel.
[[nodiscard]] std::vector<CubeRun> encode_gaps(std::span<const std::uint8_t> missing, Extent extent);
[[nodiscard]] std::vector<CubeRun> encode_remainders(std::span<const std::uint32_t> remainders, Extent extent);
/// Decodes a run of a whole volume: sets which voxels are missing, or adds remainders to the codes. Voxels outside of
/// the volume do not matter. Returns false if the run is not in the volume, or truncated.
bool decode_gaps(const CubeRun& run, Extent extent, std::span<std::uint8_t> missing);
bool decode_remainders(const CubeRun& run, Extent extent, std::span<std::uint32_t> codes);
/// Decodes the gaps of a run cube by cube. Calls visit(cube, missing): voxel (x, y, z) of the cube is missing if bit
/// x + 4 y + 16 z is set. Returns false if the run is not in the volume, or truncated.
bool decode_gap_cubes(const CubeRun& run, Extent extent,
                      const std::function<void(std::uint64_t cube, std::uint64_t missing)>& visit);
/// Decodes the remainders of a run cube by cube, up to the cube `last`. Calls visit(cube, numbers): that of voxel (x,
/// y, z) of the cube has the index x + 4 y + 16 z. Returns false if the run is not in the volume, or truncated before.
bool decode_remainder_cubes(
    const CubeRun& run, Extent extent, std::uint64_t last,
    const std::function<void(std::uint64_t cube, std::span<const std::uint32_t, kCubeSize> numbers)>& visit);

}  // namespace gs::qnv::values
