#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/shared_records.h"
#include "qnv/mesh/survey.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <variant>

namespace gs::qnv {

/// Grid of cubic cells over a box.
struct CellLattice {
  static constexpr int kBits = 20;  // bits of a cell's index along an axis

  glm::vec3 lower{0};
  float edge = 1;

  /// Returns the Morton code of the cell that contains a point. `local` is the position in the cell, in cell edges from
  /// the middle of the cell.
  [[nodiscard]] std::uint64_t cell_of(const glm::vec3& p, glm::vec3& local) const;
  [[nodiscard]] glm::vec3 middle_of(std::uint64_t key) const;
};

/// Returns the edge of the finest cells with at most `most` cells, and at most `most` triangles that have their corners
/// in three cells. Estimates both numbers from a sample of the cells of six or more grids. Usually reads the source
/// once. Needs about 10 MB. Does not depend on the order of the triangles. Collective.
[[nodiscard]] std::variant<float, EncodeError> estimated_cell_edge(EncodeRanks& shared, const TriangleSource& source,
                                                                   const SurfaceSurvey& survey, std::size_t most,
                                                                   Progress* progress);

/// Returns the edge of the largest useful cells: twice the longest edge of the box.
[[nodiscard]] double coarsest_cell_edge(const Box& box);

}  // namespace gs::qnv
