#pragma once

#include "base/parallel.h"
#include "qnv/base/geometry.h"
#include "qnv/base/triangles.h"
#include "qnv/container/container.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Function that passes all triangles of a surface to a sink. Each call gives the same triangles in the same order.
/// Returns false if it failed or the sink requested no more.
using TriangleSource = std::function<bool(const TriangleSink&)>;

/// Surface with a texture: original triangles, not subdivided to carry texture colours at their corners.
struct TexturedSurface {
  std::vector<Triangle> triangles;
  std::vector<std::array<glm::vec2, 3>> coordinates;  // s and t (VRML97 4.6.11) of each triangle's corners
  std::uint32_t width = 1, height = 1;                // of the picture
  std::vector<PictureFile> picture;                   // coarse to fine; at most exact::kMaxPictureFiles
  bool repeat_s = true, repeat_t = true;
};

/// Value of EncodeOptions::exact_bits: add an exact tail if the surface is smooth and small enough, with bits chosen by
/// the size of its triangles, and with parity.
inline constexpr int kExactWherePays = -1;
/// Maximum number of triangles of a small surface for kExactWherePays.
inline constexpr std::size_t kMaxChosenTriangles = 300'000;

struct EncodeOptions {
  Payload payload = Payload::packed;
  std::size_t vectors = 0;    // approximate, at full detail; 0: chosen automatically
  std::size_t max_bytes = 0;  // of the whole stream; 0 means unlimited
  bool compact = false;       // packed: fewer bits per vector, a rougher final picture
  std::uint64_t seed = 1;     // of the order of records
  bool two_sided = false;
  bool only_if_suited = false;     // displaced: fail with EncodeError::unsuited if an octree follows the surface better
  std::size_t most_triangles = 0;  // displaced: maximum in memory; larger surfaces are thinned to it; 0: unlimited
  int exact_bits = 0;  // displaced: adds an exact tail with 2^this positions per axis, 8 to 20; 0: no tail; or
                       // kExactWherePays
  const TexturedSurface* textured = nullptr;  // displaced: source of the exact tail, or nullptr; must outlive the call
  glm::dvec3 origin{0};                       // of triangles (Description::origin); point sets have their own
  std::vector<std::pair<std::string, std::string>> metadata;
  unsigned threads = 0;
};

/// Request for a stream of a source.
struct EncodeRequest {
  std::optional<Payload> payload;  // nullopt: chosen for the source
  EncodeOptions options;           // `payload` and `only_if_suited` are ignored
};

/// Memory per triangle while encoding a displaced surface.
inline constexpr std::size_t kDisplacedTriangleBytes = 600;

struct EncodeError {
  std::string message;
  bool unsuited = false;  // another payload suits this source better
};

/// Whole stream: its bytes and its header.
struct EncodedStream {
  StreamHeader header;
  std::vector<std::byte> bytes;
  bool thinned = false;  // there were more triangles than EncodeOptions::most_triangles
};

}  // namespace gs::qnv
