#pragma once

#include "qnv/displaced/surface.h"
#include "qnv/exact/cover.h"
#include "qnv/exact/exact_tail.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// Where a displaced surface lies beside the mesh that takes its place part by part.
class TailCover {
 public:
  /// `mesh`: on its lattice; it must stay. `surface`: what is shown before the tail, at `level`.
  TailCover(const exact::ExactMesh& mesh, const displaced::Surface& surface, int level, unsigned threads);
  /// In which order pictures gain most: where normals are furthest off for what it takes to send the mesh there. Each
  /// rank has about as many vertices.
  [[nodiscard]] exact::TailRanks ranks() const;
  /// `stage`: the number of the surface; `order`: in which the mesh comes.
  [[nodiscard]] exact::Cover cover(int stage, const exact::TailOrder& order) const;

 private:
  const exact::ExactMesh& mesh_;
  std::vector<std::vector<std::uint32_t>> near_;  // a patch: triangles of the mesh nearest to its vertices
  std::vector<double> cell_errors_;               // the mean of how far off normals are, by cell; below 0: not known
};

}  // namespace gs::qnv
