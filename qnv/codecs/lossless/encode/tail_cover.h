#pragma once

#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/lossless/cover.h"
#include "qnv/codecs/lossless/exact_tail.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// Correspondence between a displaced surface and the exact mesh that replaces it part by part.
class TailCover {
 public:
  /// `mesh` is on its lattice and must outlive this object. `surface` is the stage that is drawn before the tail, at
  /// `level`.
  TailCover(const exact::ExactMesh& mesh, const displaced::Surface& surface, int level, unsigned threads);
  /// Returns the ranks of cells by benefit: cells with the largest normal error per byte of the mesh first. All ranks
  /// have about the same number of vertices.
  [[nodiscard]] exact::TailRanks ranks() const;
  /// Returns the table of covered patches. `stage` is the index of the displaced surface, `order` the decoding order of
  /// the mesh.
  [[nodiscard]] exact::Cover cover(int stage, const exact::TailOrder& order) const;

 private:
  const exact::ExactMesh& mesh_;
  std::vector<std::vector<std::uint32_t>> near_;  // per patch: triangles of the mesh nearest to its vertices
  std::vector<double> cell_errors_;  // mean normal error of each cell; negative if not measured
};

}  // namespace gs::qnv
