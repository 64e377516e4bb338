#pragma once

#include "qnv/decode/cluster_forest.h"
#include "qnv/decode/exact_surface.h"
#include "qnv/decode/progressive_surface.h"
#include "qnv/decode/surface_stages.h"
#include "qnv/packed/packed.h"
#include "qnv/records/records_assembly.h"
#include "qnv/stream/container.h"
#include "qnv/stream/piece_group.h"
#include "qnv/voxels/voxels.h"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Turns a stream that arrives piece by piece, or with holes, into vectors. What has arrived is always a whole
/// picture. One thread; safe for untrusted bytes; memory is bounded by `most_vectors`.
class StreamDecoder {
 public:
  explicit StreamDecoder(std::size_t most_vectors = std::size_t{1} << 26);

  /// The next bytes of the stream. False once it was refused.
  bool push(std::span<const std::byte> bytes);
  /// A chunk that came by another way (a datagram), after the header. Any order, any subset. Of a chunk of records the
  /// bytes `missing` from the payload, and those behind its end, may come another time, or never; other chunks are
  /// refused then.
  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing = {});
  /// The stream has ended: reads what waited for more bytes, and says what is missing.
  void finish();

  [[nodiscard]] const StreamHeader* header() const { return reader_.header(); }
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return reader_.problems(); }
  [[nodiscard]] std::size_t refused_chunks() const {
    return refused_chunks_ + packed_.count().refused + voxels_.count().refused + surface_.count().refused +
           exact_.count().refused + progressive_.count().refused;
  }
  /// Whether chunks were left out because of `most_vectors`.
  [[nodiscard]] bool full() const {
    return records_full_ || packed_.count().full || voxels_.count().full || surface_.count().full ||
           exact_.count().full || progressive_.count().full;
  }
  /// How many discs `cloud` has.
  [[nodiscard]] std::size_t vectors() const {
    if (exact_.whole()) return exact_.vectors();
    return records_vectors_ + packed_.count().vectors + voxels_.count().vectors +
           (progressive_.begun() ? progressive_.shown().positions.size() : surface_vectors());
  }
  /// Changes whenever `cloud` would.
  [[nodiscard]] std::uint64_t revision() const {
    return records_revision_ + packed_.count().taken + voxels_.count().taken + surface_.count().taken +
           exact_.count().taken + progressive_.count().taken;
  }
  /// Of a displaced surface, or an octree of one: the mesh itself, as far as it has come.
  [[nodiscard]] const ExactSurface& exact() const { return exact_; }
  /// The same of one that becomes the mesh vertex by vertex.
  [[nodiscard]] const ProgressiveSurface& progressive() const { return progressive_; }
  /// Whether what is there is the mesh itself, all of it.
  [[nodiscard]] bool is_mesh() const { return exact_.finest() || progressive_.mesh().whole(); }
  /// The stages of a displaced surface.
  [[nodiscard]] const SurfaceStages& stages() const { return surface_; }
  /// Whether `cloud_to_draw` gives arrays, not patches.
  [[nodiscard]] bool has_arrays() const;
  [[nodiscard]] const std::vector<DirectoryEntry>& directory() const { return directory_; }

  /// Everything that has arrived, each place at its finest; discs that were refined are gone. Of voxels in an order in
  /// which the first ones cover all of it evenly.
  [[nodiscard]] Cloud cloud() const;
  /// The same for who draws it: a displaced surface has patches in place of arrays, of which only those are worked out
  /// that have changed since the last call. Meshes have arrays.
  [[nodiscard]] Cloud cloud_to_draw();

 private:
  /// Of a displaced surface: the first stage is a part of the header, and there before any chunk.
  void begin_surface();
  void add_piece(std::span<const std::byte> payload);
  void add_records(std::span<const std::byte> payload, std::span<const ByteRange> missing);
  void append_records(Cloud& cloud) const;
  void append_surface(Cloud& cloud) const;
  /// Where a part of the mesh is shown beside the patches that it does not cover: those that it does; else empty.
  [[nodiscard]] std::vector<bool> covered() const;
  [[nodiscard]] std::size_t surface_vectors() const;

  StreamReader reader_;
  std::size_t most_vectors_, records_vectors_ = 0, refused_chunks_ = 0;
  std::uint64_t records_revision_ = 0;
  bool records_full_ = false, surface_begun_ = false;
  ClusterForest<Cluster> packed_;
  ClusterForest<VolumeCluster> voxels_;
  SurfaceStages surface_;
  ProgressiveSurface progressive_;  // in its place from the header on
  ExactSurface exact_;              // shown in the place of either once it is there
  std::map<int, PieceGroup> groups_;
  mutable std::optional<RecordsAssembly> records_;  // files what arrived only when it is asked
  std::vector<DirectoryEntry> directory_;
};

}  // namespace gs::qnv
