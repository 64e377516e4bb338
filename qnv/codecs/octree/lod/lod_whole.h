#pragma once

#include "qnv/codecs/octree/lod/lod_chunks.h"
#include "qnv/codecs/octree/packed.h"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace gs::qnv {

/// Visitor of the finest received voxels of an octree stream. Decodes each cluster once, and keeps only the ancestors
/// of the current cluster.
class LodWhole {
 public:
  /// Callback that receives `count` voxels of a cluster, from index `first` on. They have no finer voxels.
  using OnVoxels = std::function<void(const Cluster& cluster, std::size_t first, std::size_t count)>;

  /// Visits coarser voxels where the number of splats would exceed `most_discs`. `chunks` must outlive this object.
  LodWhole(LodChunks& chunks, std::size_t most_discs) : chunks_(chunks), most_discs_(most_discs) {}

  /// Visits the voxels. Call it once. Returns the number of splats.
  std::size_t visit(const OnVoxels& on_voxels);
  /// Reports whether coarser voxels were visited because of the limit.
  [[nodiscard]] bool cut_short() const { return cut_short_; }

 private:
  void visit_below(std::uint32_t node, const Cluster& cluster, const OnVoxels& on_voxels);

  LodChunks& chunks_;
  std::size_t most_discs_, discs_ = 0;
  bool cut_short_ = false;
};

}  // namespace gs::qnv
