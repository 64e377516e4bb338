#pragma once

#include "base/noncopyable.h"
#include "qnv/base/geometry.h"
#include "qnv/container/container.h"
#include "qnv/sampling/volume/volume_values.h"

#include <cstddef>
#include <memory>
#include <span>
#include <utility>

namespace gs::qnv {

/// Numbers of chunks that a decoder received, by result.
struct DecodeCount {
  std::size_t refused = 0, taken = 0;  // unusable chunks; chunks that changed the geometry
  bool full = false;                   // the maximum number of vectors was reached, and data was dropped

  DecodeCount& operator+=(const DecodeCount& other) {
    refused += other.refused;
    taken += other.taken;
    full = full || other.full;
    return *this;
  }
};

/// Progress of the mesh that a stream ends with or grows to.
struct MeshProgress {
  std::size_t bytes = 0, received = 0;                  // of an exact mesh; `bytes` is 0 until received
  std::size_t texture_bytes = 0, texture_received = 0;  // of its texture; `texture_bytes` is 0 until received
  std::size_t vertices = 0;                             // number received of a growing mesh
  std::size_t triangles = 0, all_triangles = 0;         // of an exact mesh; `all_triangles` is set if `partly`
  int bits = 0;                                         // log2 of the lattice positions per axis; 0 until received
  bool partly = false;                                  // received triangles replace a part of the surface
  bool whole = false;                                   // all triangles are drawn; their positions may still be refined
  bool growing = false;                                 // a progressive mesh is drawn
  bool final = false;                                   // the mesh is complete and exact

  [[nodiscard]] bool shown() const { return partly || whole || growing; }
};

/// Decoder of the chunks of one stream, in any order and with losses. At any time, the received part gives a complete
/// picture. Each codec has its own class; the codec's table row creates it (codecs/payloads.h). One thread at a time.
/// Safe for untrusted bytes.
class Decoder : NonCopyable {
 public:
  virtual ~Decoder() = default;

  /// Adds the payload of a chunk. The codec must support the chunk's type. The ranges `missing` in the payload, and
  /// bytes after its end, are not received. If the codec has records, a later call may add these bytes; other codecs
  /// ignore incomplete payloads.
  virtual void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) = 0;
  /// Notes that further chunks are not in the order of the stream, so that its statements about prefixes do not hold.
  virtual void leave_order() {}
  [[nodiscard]] virtual DecodeCount count() const = 0;
  /// Returns the number of vectors of geometry(), or the most that it may have if their number depends on values.
  [[nodiscard]] virtual std::size_t vectors() const = 0;
  /// Returns everything received, at its finest detail, with the properties `base`.
  [[nodiscard]] virtual Geometry geometry(GeometryBase base) const = 0;
  /// Returns the geometry for renderers. Shares unchanged parts with earlier results.
  [[nodiscard]] virtual Geometry geometry_to_draw(GeometryBase base) { return geometry(std::move(base)); }
  /// Chooses the component of voxels that geometry() shows. Codecs with one number per voxel ignore it.
  virtual void show(const ShownComponent&) {}
  [[nodiscard]] virtual MeshProgress mesh() const { return {}; }
};

// Factories of the codecs' decoders. `most_vectors` limits the number of vectors.
[[nodiscard]] std::unique_ptr<Decoder> make_records_decoder(const StreamHeader& header, std::size_t most_vectors);
[[nodiscard]] std::unique_ptr<Decoder> make_displaced_decoder(const StreamHeader& header, std::size_t most_vectors);
[[nodiscard]] std::unique_ptr<Decoder> make_octree_decoder(const StreamHeader& header, std::size_t most_vectors);
[[nodiscard]] std::unique_ptr<Decoder> make_progressive_decoder(const StreamHeader& header, std::size_t most_vectors);
[[nodiscard]] std::unique_ptr<Decoder> make_values_decoder(const StreamHeader& header, std::size_t most_vectors);
[[nodiscard]] std::unique_ptr<Decoder> make_gaussians_decoder(const StreamHeader& header, std::size_t most_vectors);
[[nodiscard]] std::unique_ptr<Decoder> make_components_decoder(const StreamHeader& header, std::size_t most_vectors);
[[nodiscard]] std::unique_ptr<Decoder> make_series_decoder(const StreamHeader& header, std::size_t most_vectors);
[[nodiscard]] std::unique_ptr<Decoder> make_labels_decoder(const StreamHeader& header, std::size_t most_vectors);
[[nodiscard]] std::unique_ptr<Decoder> make_label_series_decoder(const StreamHeader& header, std::size_t most_vectors);

}  // namespace gs::qnv
