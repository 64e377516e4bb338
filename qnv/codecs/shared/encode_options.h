#pragma once

#include "base/parallel.h"
#include "qnv/base/geometry.h"
#include "qnv/base/triangles.h"
#include "qnv/codecs/shared/spill_store.h"
#include "qnv/codecs/shared/stream_sink.h"
#include "qnv/codecs/shared/triangle_source.h"
#include "qnv/container/container.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Surface with a texture. Its triangles are the original ones; they were not subdivided to carry texture colours at
/// their corners.
struct TexturedSurface {
  std::vector<Triangle> triangles;
  std::vector<std::array<glm::vec2, 3>> coordinates;  // s, t (VRML97 4.6.11) of each triangle's corners
  std::uint32_t width = 1, height = 1;                // size of the texture, pixels
  std::vector<PictureFile> picture;                   // texture files, coarse to fine; at most exact::kMaxPictureFiles
  bool repeat_s = true, repeat_t = true;
};

/// Value of EncodeOptions::exact_bits: adds an exact tail if the surface is smooth and small enough. The tail has
/// parity, and the size of the triangles determines its bits.
inline constexpr int kExactWherePays = -1;
/// Maximum number of triangles for which kExactWherePays adds an exact tail.
inline constexpr std::size_t kMaxChosenTriangles = 300'000;

/// Error of the values that a stream may have. Without a limit, the encoder permits half a step of a display with 12
/// bits over the range of the values.
struct ValueTolerance {
  std::optional<double> error;  // maximum for every voxel, in the unit of the values
  bool of_range = false;        // `error` is a share of the range of the values
  bool lossless = false;        // restores the stored voxels bit for bit
};

class Ranks;

struct EncodeOptions {
  std::size_t vectors = 0;    // approximate number at full detail; 0 means automatic
  std::size_t max_bytes = 0;  // maximum size of the stream; 0 means unlimited
  std::uint64_t seed = 1;     // of the pseudo-random order of records
  bool two_sided = false;
  bool only_if_suited = false;     // displaced: fails with EncodeError::unsuited if an octree is better
  std::size_t most_triangles = 0;  // displaced: maximum number; larger surfaces are thinned; 0 means unlimited
  int exact_bits = 0;              // displaced: bits per axis of an exact tail, 8 to 20; 0 means no tail; or
                                   // kExactWherePays
  const TexturedSurface* textured = nullptr;  // displaced: source of the exact tail, or null; must outlive the call
  ValueTolerance tolerance;                   // values
  int splat_steps = 0;                        // gaussians: log2 of a factor of the errors, in eighths; -32 to 32
  bool fitted = true;                         // gaussians: fits merged Gaussians to pictures, half of the time
  std::size_t part_splats = 0;                // gaussians: maximum number in one tree; 0 means the default
  std::size_t memory = 0;                     // gaussians: bytes for parts that are encoded at the same time; 0 means
                                              // the default. The stream does not depend on it
  SpillStore* spill = nullptr;                // values: holds the clusters; gaussians: also parts of the source;
                                              // surfaces: passes data between `ranks`. Null means memory; must
                                              // outlive the call
  StreamSink* sink = nullptr;                 // values, gaussians: takes the stream, which then has no bytes in memory;
                                              // or null
  Ranks* ranks = nullptr;                     // values, gaussians, and surfaces in runs: processes that encode one
                                              // source together, with a common `spill`; null means only this process.
                                              // Only rank 0 gets the stream of a surface
  std::optional<double> parity;               // loss of chunks that parity restores, 0 to 0.5; nullopt: as the codec
                                              // chooses. Displaced surfaces, values and gaussians; others ignore it
  glm::dvec3 origin{0};                       // origin of triangles (Description::origin); vectors have their own
  std::vector<std::pair<std::string, std::string>> metadata;
  unsigned threads = 0;
};

/// Request for a stream, independent of the source.
struct EncodeRequest {
  std::optional<Payload> payload;  // if nullopt, encode() chooses by the source
  EncodeOptions options;           // encode() ignores `only_if_suited`
};

/// Memory per triangle during the encoding of a displaced surface, in bytes.
inline constexpr std::size_t kDisplacedTriangleBytes = 600;

struct EncodeError {
  std::string message;
  bool unsuited = false;  // another payload suits the source better
};

/// Complete stream: its bytes, unless a sink took them, and its header.
struct EncodedStream {
  StreamHeader header;
  std::vector<std::byte> bytes;
  std::uint64_t written = 0;  // number of bytes that EncodeOptions::sink took
  bool thinned = false;       // the source had more triangles than EncodeOptions::most_triangles

  [[nodiscard]] std::uint64_t size() const { return bytes.size() + written; }
};

}  // namespace gs::qnv
