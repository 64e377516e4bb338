#pragma once

#include "qnv/codecs/displaced/decode/surface_stages.h"
#include "qnv/codecs/lossless/decode/exact_surface.h"
#include "qnv/codecs/octree/decode/cluster_forest.h"
#include "qnv/codecs/octree/packed.h"
#include "qnv/codecs/progressive/decode/progressive_surface.h"
#include "qnv/codecs/records/decode/records_assembly.h"
#include "qnv/codecs/voxels/voxels.h"
#include "qnv/container/container.h"
#include "qnv/container/piece_group.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Decodes a stream, received in pieces or with losses, into vectors or a surface. At any time, the received part is a
/// complete picture. Not thread-safe; safe for untrusted bytes; memory is bounded by `most_vectors`.
class StreamDecoder {
 public:
  explicit StreamDecoder(std::size_t most_vectors = std::size_t{1} << 26);

  /// Decodes the next bytes of the stream. Returns false once the stream is rejected.
  bool push(std::span<const std::byte> bytes);
  /// Adds a chunk received separately (as a datagram), after the header, in any order. Of a records chunk, the bytes
  /// `missing` in the payload and those after its end may be added later or never. Chunks of other types must be
  /// complete.
  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing = {});
  /// Ends the stream: decodes waiting bytes, and reports missing ones.
  void finish();

  [[nodiscard]] const StreamHeader* header() const { return reader_.header(); }
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return reader_.problems(); }
  [[nodiscard]] std::size_t refused_chunks() const {
    return refused_chunks_ + packed_.count().refused + voxels_.count().refused + surface_.count().refused +
           exact_.count().refused + progressive_.count().refused;
  }
  /// Reports whether chunks were dropped because of `most_vectors`.
  [[nodiscard]] bool full() const {
    return records_full_ || packed_.count().full || voxels_.count().full || surface_.count().full ||
           exact_.count().full || progressive_.count().full;
  }
  /// Returns the number of vectors of cloud().
  [[nodiscard]] std::size_t vectors() const {
    if (exact_.whole()) return exact_.vectors();
    return records_vectors_ + packed_.count().vectors + voxels_.count().vectors +
           (progressive_.begun() ? progressive_.shown().positions.size() : surface_vectors());
  }
  /// Returns a number that changes whenever cloud() would.
  [[nodiscard]] std::uint64_t revision() const {
    return records_revision_ + packed_.count().taken + voxels_.count().taken + surface_.count().taken +
           exact_.count().taken + progressive_.count().taken;
  }
  /// Returns the exact mesh at the end of a displaced surface or an octree, as far as received.
  [[nodiscard]] const ExactSurface& exact() const { return exact_; }
  /// Returns the mesh of a stream with splits, as far as received.
  [[nodiscard]] const ProgressiveSurface& progressive() const { return progressive_; }
  /// Reports whether the complete exact mesh is shown.
  [[nodiscard]] bool is_mesh() const { return exact_.finest() || progressive_.mesh().whole(); }
  /// Returns the stages of a displaced surface.
  [[nodiscard]] const SurfaceStages& stages() const { return surface_; }
  /// Reports whether cloud_to_draw() returns arrays instead of patches.
  [[nodiscard]] bool has_arrays() const;
  [[nodiscard]] const std::vector<DirectoryEntry>& directory() const { return directory_; }

  /// Returns everything received, at its finest detail; refined vectors are left out. The first voxels of a volume
  /// cover it evenly.
  [[nodiscard]] Cloud cloud() const;
  /// Like cloud(), for renderers: a displaced surface has patches instead of arrays, and only those changed since the
  /// last call are re-evaluated. Meshes have arrays.
  [[nodiscard]] Cloud cloud_to_draw();

 private:
  /// Starts a displaced surface from its first stage, which is in the header.
  void begin_surface();
  void add_records(std::span<const std::byte> payload, std::span<const ByteRange> missing);
  void append_records(Cloud& cloud) const;
  void append_surface(Cloud& cloud) const;
  /// Returns the patches that received triangles cover, if a part of the mesh is shown; else an empty list.
  [[nodiscard]] std::vector<bool> covered() const;
  [[nodiscard]] std::size_t surface_vectors() const;

  StreamReader reader_;
  std::size_t most_vectors_, records_vectors_ = 0, refused_chunks_ = 0;
  std::uint64_t records_revision_ = 0;
  bool records_full_ = false, surface_begun_ = false;
  ClusterForest<Cluster> packed_;
  ClusterForest<VolumeCluster> voxels_;
  SurfaceStages surface_;
  ProgressiveSurface progressive_;  // replaces the stages, from the header on
  ExactSurface exact_;              // replaces either of them once received
  PieceGroups groups_;
  mutable std::optional<RecordsAssembly> records_;  // inserts received chunks only on request
  std::vector<DirectoryEntry> directory_;
};

}  // namespace gs::qnv
