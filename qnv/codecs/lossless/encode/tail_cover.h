#pragma once

#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/lossless/cover.h"
#include "qnv/codecs/lossless/exact_tail.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// Correspondence between a displaced surface and the mesh that replaces it part by part.
class TailCover {
 public:
  /// `mesh` is on its lattice and must outlive this object. `surface` is the stage shown before the tail, at `level`.
  TailCover(const exact::ExactMesh& mesh, const displaced::Surface& surface, int level, unsigned threads);
  /// Returns the ranks of cells by benefit: the largest normal errors per byte of the mesh first. Each rank has about
  /// as many vertices.
  [[nodiscard]] exact::TailRanks ranks() const;
  /// Returns the table of covered patches. `stage` is the surface's number; `order` is the mesh's decoding order.
  [[nodiscard]] exact::Cover cover(int stage, const exact::TailOrder& order) const;

 private:
  const exact::ExactMesh& mesh_;
  std::vector<std::vector<std::uint32_t>> near_;  // by patch: the triangles of the mesh nearest to its vertices
  std::vector<double> cell_errors_;               // mean normal error of each cell; negative if unknown
};

}  // namespace gs::qnv
