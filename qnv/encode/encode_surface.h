#pragma once

#include "qnv/base/parallel.h"
#include "qnv/base/triangles.h"
#include "qnv/stream/container.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Gives all triangles of a surface to a sink, the same ones in the same order every time it is called. False when it
/// could not, or the sink wanted no more.
using TriangleSource = std::function<bool(const TriangleSink&)>;

/// The surface as it is where it has a texture: triangles that are not divided to bring its colours to their corners.
struct TexturedSurface {
  std::vector<Triangle> triangles;
  std::vector<std::array<glm::vec2, 3>> coordinates;  // of each one's corners: s and t (VRML97 4.6.11)
  std::uint32_t width = 1, height = 1;                // of the picture
  std::vector<PictureFile> picture;                   // from coarse to fine, at most exact::kMostPictureFiles
  bool repeat_s = true, repeat_t = true;
};

/// In place of EncodeOptions::exact_bits: where a smooth surface is small enough for it, with bits chosen by how fine
/// its triangles are, and parity for losses.
inline constexpr int kExactWherePays = -1;
/// A surface of more triangles is not small enough.
inline constexpr std::size_t kMostChosenTriangles = 300'000;

struct EncodeOptions {
  Payload payload = Payload::packed;
  std::size_t vectors = 0;    // about so many at full detail; 0: chosen
  std::size_t max_bytes = 0;  // of the whole stream; 0: no limit
  bool compact = false;       // packed: fewer bits a vector, a rougher picture at the end
  std::uint64_t seed = 1;     // of the order of records
  bool two_sided = false;
  bool only_if_suited = false;  // displaced: give up (EncodeError::unsuited) where an octree follows the surface better
  std::size_t most_triangles = 0;  // displaced: held in memory; a surface of more is thinned to so many. 0: any number
  int exact_bits = 0;  // displaced: the mesh itself at the end, with 2^this places an axis, 8 to 20; 0: without it,
                       // or kExactWherePays
  const TexturedSurface* textured = nullptr;  // displaced: of which the mesh itself is made; else null. It must stay
  glm::dvec3 origin{0};  // of triangles: from which they count (Description::origin); vectors say it themselves
  std::vector<std::pair<std::string, std::string>> metadata;
  unsigned threads = 0;
};

/// Memory that a triangle takes while its surface is encoded as displacements.
inline constexpr std::size_t kDisplacedTriangleBytes = 600;

struct EncodeError {
  std::string message;
  bool unsuited = false;  // another payload follows such a source better
};

/// A whole stream: its bytes and what its header says.
struct EncodedStream {
  StreamHeader header;
  std::vector<std::byte> bytes;
  bool thinned = false;  // there were more triangles than EncodeOptions::most_triangles
};

/// Encodes a surface (paper, section 3.1): the triangles are cut at the voxels of an octree, whose moments give exact
/// areas, mean normals and mean colours. The source is read twice; memory grows with the vectors, not with the
/// triangles. The same bytes for the same input, options and seed, whatever the threads or the compiler.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_surface(const TriangleSource& source,
                                                                      const EncodeOptions& options,
                                                                      Progress* progress = nullptr);

/// Encodes a surface as a base mesh and displacements along its normals (displaced/surface.h), which a base cannot
/// follow where it is no surface but a heap of triangles. All triangles are held in memory, at about
/// kDisplacedTriangleBytes each; a source that may have more than `most_triangles` is read several times. With the mesh
/// itself at the end (exact/exact_tail.h) there is less of what stands before it. The same bytes for the same input and
/// options, whatever the threads.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_displaced(const TriangleSource& source,
                                                                        const EncodeOptions& options,
                                                                        Progress* progress = nullptr);

/// Encodes vectors that lie on a surface, such as points of a scan, as an octree of the surface that they are: a square
/// of its area for each, about as many voxels as there are vectors. Its pictures take fewer bytes than those of
/// records, but for the last one: a voxel does not say where in it its vectors were.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_points(const Cloud& cloud, const EncodeOptions& options,
                                                                     Progress* progress = nullptr);

/// Encodes vectors that are there already (a volume's gradients, imported splats) as records.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_cloud(const Cloud& cloud, const EncodeOptions& options,
                                                                    Progress* progress = nullptr);

}  // namespace gs::qnv
