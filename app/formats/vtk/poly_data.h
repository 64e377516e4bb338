#pragma once

#include "app/formats/common/mesh_asset.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace gs::app {

/// Cells of one kind: concatenated corners, and the end of each cell in them.
struct PolyCells {
  std::vector<std::int32_t> corners;
  std::vector<std::size_t> ends;
};

/// VTK PolyData, as in its files.
struct PolyData {
  enum Kind : std::uint8_t { vertices, lines, polygons, strips };  // in VTK's cell order
  static constexpr std::size_t kKinds = 4;

  std::vector<glm::vec3> points, normals;  // normals are empty, or one per point
  std::array<PolyCells, kKinds> cells;
  /// Scalars of all points or cells with their name, or colours, which take precedence. Empty if there are none.
  struct Data {
    std::vector<float> values;
    std::vector<vrml::Color> colors;
    std::string title;

    [[nodiscard]] bool empty() const { return values.empty() && colors.empty(); }
  };
  Data of_points, of_cells;
};

/// Adds the data to the mesh: polygons and strips as faces, lines, vertices (or all points, if there are no cells) as
/// points. Scalars are coloured with Viridis; point scalars take precedence over
/// cell scalars. The colour key describes their range. Throws OutOfBudget.
void build_poly_data(PolyData data, MeshBuilder& builder);

}  // namespace gs::app
