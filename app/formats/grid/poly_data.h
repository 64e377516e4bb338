#pragma once

#include "app/formats/common/scene_builder.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace gs::app {

/// Cells of one kind: the corners of one after the other, and where each ends among them.
struct PolyCells {
  std::vector<std::int32_t> corners;
  std::vector<std::size_t> ends;
};

/// What VTK calls PolyData, as its files have it.
struct PolyData {
  enum Kind : std::uint8_t { vertices, lines, polygons, strips };  // the order in which VTK counts cells
  static constexpr std::size_t kKinds = 4;

  std::vector<glm::vec3> points, normals;  // normals: empty, or one a point
  std::array<PolyCells, kKinds> cells;
  /// Numbers of points or cells, of all or of none, and what they are called; or colours, which go before numbers.
  struct Data {
    std::vector<float> values;
    std::vector<vrml::Color> colors;
    std::string title;

    [[nodiscard]] bool empty() const { return values.empty() && colors.empty(); }
  };
  Data of_points, of_cells;
};

/// Adds it to the scene: polygons and strips as an IndexedFaceSet, lines as an IndexedLineSet, vertices (or all points,
/// where there are no cells) as a PointSet. Numbers colour them by viridis, those of points before those of cells, and
/// a WorldInfo says what they stand for (color_key.h). Throws OutOfBudget.
void build_poly_data(PolyData data, SceneBuilder& builder);

}  // namespace gs::app
