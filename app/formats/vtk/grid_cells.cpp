#include "app/formats/vtk/grid_cells.h"

#include "app/formats/vtk/cell_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <span>
#include <string>
#include <utility>

namespace gs::app {
namespace {

/// Key of a face, independent of the order of its corners. Consists of the number of corners, the four smallest
/// corners, and the sum of all corners. Different faces have equal keys only if cells overlap.
struct GridFaceKey {
  std::array<std::int32_t, 4> least{};
  std::uint64_t count = 0, sum = 0;

  auto operator<=>(const GridFaceKey&) const = default;
};
struct GridFace {
  GridFaceKey key;
  std::size_t begin = 0, end = 0;  // range of the face's corners in `face_corners_`
  std::size_t cell = 0;
  bool inner = false;  // true if two cells share the face
};

constexpr std::size_t kGridBetweenLooks = std::size_t{1} << 17;  // steps between two checks for cancellation

class GridSurface {
 public:
  GridSurface(const GridCells& grid, PolyData& data, MeshBuilder& builder)
      : grid_(grid), data_(data), builder_(builder) {}

  void run() {
    std::size_t faces = 0, face_corners = 0, corners = 0;
    each_cell([&](std::size_t, const GridShape& shape, std::span<const std::int32_t> of_cell) {
      if (shape.as == GridShape::As::polyhedron) {
        faces += static_cast<std::size_t>(of_cell[0]);
        face_corners += of_cell.size();
      } else if (shape.as == GridShape::As::solid) {
        faces += shape.faces.size();
        face_corners += shape.faces.size() * 4;
      } else {
        corners += of_cell.size() + 2;
      }
    });
    // Memory for the faces, their order by key, and the output.
    builder_.draw(faces * (sizeof(GridFace) + sizeof(std::size_t) * 3) + face_corners * sizeof(std::int32_t) * 2 +
                  corners * (sizeof(std::int32_t) + 2 * sizeof(std::size_t)));
    faces_.reserve(faces);
    face_corners_.reserve(face_corners);
    each_cell([&](std::size_t cell, const GridShape& shape, std::span<const std::int32_t> of_cell) {
      add_cell(cell, shape, of_cell);
    });
    add_faces();
    if (unknown_ > 0) builder_.warn(std::to_string(unknown_) + " cells of unsupported types are left out");
    if (short_ > 0) builder_.warn(std::to_string(short_) + " cells without all of their corners are left out");
    sort_data();
  }

 private:
  template <class Take>
  void each_cell(Take take) {
    std::size_t begin = 0;
    unknown_ = short_ = 0;
    const std::size_t count = grid_.cells.ends.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (i % kGridBetweenLooks == 0) builder_.draw(0);
      const auto corners = std::span(grid_.cells.corners).subspan(begin, grid_.cells.ends[i] - begin);
      begin = grid_.cells.ends[i];
      const GridShape shape = grid_shape(i < grid_.types.size() ? grid_.types[i] : std::uint8_t{0});
      if (shape.as == GridShape::As::nothing) {
        if (i >= grid_.types.size() || grid_.types[i] != 0) ++unknown_;  // type 0 is an empty cell
      } else if (corners.size() < shape.corners || (shape.as == GridShape::As::polyhedron && !has_faces(corners))) {
        ++short_;
      } else {
        take(i, shape, shape.any_number ? corners : corners.first(shape.corners));
      }
    }
  }

  // Returns true if a polyhedron is complete and each face has at least three corners.
  static bool has_faces(std::span<const std::int32_t> cell) {
    std::size_t next = 1;
    for (std::int32_t left = cell[0]; left > 0; --left) {
      if (next >= cell.size() || cell[next] < 3 || static_cast<std::size_t>(cell[next]) > cell.size() - next - 1)
        return false;
      next += static_cast<std::size_t>(cell[next]) + 1;
    }
    return cell[0] > 0;
  }

  void add(PolyData::Kind kind, std::span<const std::int32_t> corners, std::size_t cell) {
    PolyCells& cells = data_.cells[kind];
    cells.corners.insert(cells.corners.end(), corners.begin(), corners.end());
    cells.ends.push_back(cells.corners.size());
    owners_[kind].push_back(cell);
  }

  void add_cell(std::size_t cell, const GridShape& shape, std::span<const std::int32_t> corners) {
    using As = GridShape::As;
    switch (shape.as) {
      case As::nothing:
        return;
      case As::vertices:
        return add(PolyData::vertices, corners, cell);
      case As::line:
        return add(PolyData::lines, corners, cell);
      case As::polygon:
        return add(PolyData::polygons, corners, cell);
      case As::pixel:
        return add(PolyData::polygons, std::array{corners[0], corners[1], corners[3], corners[2]}, cell);
      case As::strip:
        return add(PolyData::strips, corners, cell);
      case As::polyhedron:
        for (std::size_t next = 1, left = static_cast<std::size_t>(corners[0]); left > 0; --left) {
          const auto count = static_cast<std::size_t>(corners[next]);
          add_face(corners.subspan(next + 1, count), cell);
          next += count + 1;
        }
        return;
      case As::solid:
        for (const GridFaceCorners& local : shape.faces) {
          std::array<std::int32_t, 4> face{};
          std::size_t count = 0;
          for (const std::int8_t corner : local)
            if (corner != kNoGridCorner) face[count++] = corners[static_cast<std::size_t>(corner)];
          add_face(std::span(face).first(count), cell);
        }
        return;
    }
  }

  void add_face(std::span<const std::int32_t> corners, std::size_t cell) {
    GridFace face;
    face.cell = cell;
    face.begin = face_corners_.size();
    // Some writers store wedges as hexahedra with coinciding corners. A face may then collapse to an edge.
    for (const std::int32_t corner : corners)
      if (face_corners_.size() == face.begin || face_corners_.back() != corner) face_corners_.push_back(corner);
    while (face_corners_.size() > face.begin + 1 && face_corners_.back() == face_corners_[face.begin])
      face_corners_.pop_back();
    face.end = face_corners_.size();
    if (face.end - face.begin < 3) return face_corners_.resize(face.begin);
    sorted_.assign(face_corners_.begin() + static_cast<std::ptrdiff_t>(face.begin), face_corners_.end());
    std::sort(sorted_.begin(), sorted_.end());
    face.key.least.fill(kFaceEnd);
    std::copy_n(sorted_.begin(), std::min(sorted_.size(), face.key.least.size()), face.key.least.begin());
    face.key.count = sorted_.size();
    for (const std::int32_t corner : sorted_) face.key.sum += static_cast<std::uint64_t>(corner);
    faces_.push_back(face);
  }

  void add_faces() {
    std::vector<std::size_t> order(faces_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::size_t steps = 0;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      if (++steps % kGridBetweenLooks == 0) builder_.draw(0);
      return faces_[a].key < faces_[b].key;
    });
    for (std::size_t i = 1; i < order.size(); ++i) {
      GridFace &one = faces_[order[i]], &before = faces_[order[i - 1]];
      if (one.key == before.key) one.inner = before.inner = true;
    }
    for (const GridFace& face : faces_) {
      if (!face.inner)
        add(PolyData::polygons, std::span(face_corners_).subspan(face.begin, face.end - face.begin), face.cell);
    }
  }

  // Reorders cell data to the order of the output: all vertices, all lines, and so on.
  void sort_data() {
    if (data_.of_cells.empty()) return;
    const PolyData::Data of_grid = std::move(data_.of_cells);
    data_.of_cells = {};
    data_.of_cells.title = of_grid.title;
    for (const std::vector<std::size_t>& owners : owners_) {
      builder_.draw(owners.size() * (of_grid.colors.empty() ? sizeof(float) : sizeof(vrml::Color)));
      for (const std::size_t cell : owners)
        if (!of_grid.colors.empty())
          data_.of_cells.colors.push_back(cell < of_grid.colors.size() ? of_grid.colors[cell]
                                                                       : vrml::Color{0.5f, 0.5f, 0.5f});
        else
          data_.of_cells.values.push_back(cell < of_grid.values.size() ? of_grid.values[cell] : NAN);
    }
  }

  const GridCells& grid_;
  PolyData& data_;
  MeshBuilder& builder_;
  std::vector<GridFace> faces_;
  std::vector<std::int32_t> face_corners_, sorted_;
  std::array<std::vector<std::size_t>, PolyData::kKinds> owners_;  // source cell of each output cell, by kind
  std::size_t unknown_ = 0, short_ = 0;
};

}  // namespace

void add_grid(const GridCells& grid, PolyData& data, MeshBuilder& builder) { GridSurface(grid, data, builder).run(); }

}  // namespace gs::app
