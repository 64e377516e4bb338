#include "app/formats/vtk/polyhedra.h"

#include <algorithm>
#include <optional>

namespace gs::app {
namespace {

using Indices = std::span<const std::int32_t>;

/// Returns the part of `list` from `begin` to `end`, or nullopt if the range is invalid.
std::optional<Indices> part_of(Indices list, std::size_t begin, std::size_t end) {
  if (begin > end || end > list.size()) return std::nullopt;
  return list.subspan(begin, end - begin);
}

class PolyhedronWriter {
 public:
  PolyhedronWriter(const PolyhedronArrays& arrays, std::size_t first_point, std::size_t points, PolyCells& to,
                   ImportContext& context)
      : arrays_(arrays), first_point_(first_point), points_(points), to_(to), context_(context) {}

  /// Adds the faces of a cell. If it returns false, the caller must discard the added data.
  bool add(Indices faces) { return arrays_.numbered ? numbered(faces) : one_by_one(faces); }

 private:
  bool numbered(Indices faces) {
    to_.corners.push_back(static_cast<std::int32_t>(faces.size()));
    for (const std::int32_t number : faces) {
      const auto face = static_cast<std::size_t>(number);
      if (face >= arrays_.face_ends.size()) return false;
      const std::size_t begin = face == 0 ? 0 : static_cast<std::size_t>(arrays_.face_ends[face - 1]);
      const auto corners = part_of(arrays_.corners, begin, static_cast<std::size_t>(arrays_.face_ends[face]));
      if (!corners) return false;
      // Several cells may share the same long face. Charge its memory for each use.
      context_.draw((corners->size() + 1) * sizeof(std::int32_t));
      add_face(*corners);
    }
    return true;
  }
  bool one_by_one(Indices faces) {
    if (faces.empty()) return false;
    to_.corners.push_back(faces[0]);
    std::size_t next = 1;
    for (std::int32_t left = faces[0]; left > 0; --left) {
      if (next >= faces.size()) return false;
      const auto count = static_cast<std::size_t>(faces[next]);
      const auto corners = part_of(faces, next + 1, next + 1 + count);
      if (!corners) return false;
      add_face(*corners);
      next += count + 1;
    }
    return true;
  }
  void add_face(Indices corners) {
    to_.corners.push_back(static_cast<std::int32_t>(corners.size()));
    for (const std::int32_t corner : corners)
      to_.corners.push_back(static_cast<std::size_t>(corner) < points_
                                ? static_cast<std::int32_t>(first_point_ + static_cast<std::size_t>(corner))
                                : kBadIndex);
  }

  const PolyhedronArrays& arrays_;
  std::size_t first_point_, points_;
  PolyCells& to_;
  ImportContext& context_;
};

}  // namespace

std::size_t greatest_index(Indices indices) {
  std::int32_t greatest = 0;
  for (const std::int32_t index : indices)
    if (index != kBadIndex) greatest = std::max(greatest, index);
  return static_cast<std::size_t>(greatest);
}

std::size_t faces_below(Indices numbers) { return numbers.empty() ? 0 : greatest_index(numbers) + 1; }

void place_polyhedra(const PolyhedronArrays& arrays, std::size_t first_cell, std::size_t first_point,
                     std::size_t points, GridCells& grid, ImportContext& context) {
  PolyCells& to = grid.cells;
  const std::size_t kept = first_cell == 0 ? 0 : to.ends[first_cell - 1];
  const std::vector<std::int32_t> old_corners(to.corners.begin() + static_cast<std::ptrdiff_t>(kept), to.corners.end());
  const std::vector<std::size_t> old_ends(to.ends.begin() + static_cast<std::ptrdiff_t>(first_cell), to.ends.end());
  context.draw((old_corners.size() + arrays.faces.size()) * sizeof(std::int32_t) +
               old_ends.size() * sizeof(std::size_t));
  to.corners.resize(kept);
  to.ends.resize(first_cell);
  PolyhedronWriter writer(arrays, first_point, points, to, context);
  std::size_t begin = 0, face = 0;
  for (std::size_t number = 0; number < old_ends.size(); ++number) {
    const std::size_t end_of_corners = old_ends[number] - kept;
    const auto corners = Indices(old_corners).subspan(begin, end_of_corners - begin);
    begin = end_of_corners;
    if (grid.types[first_cell + number] != kGridPolyhedron) {
      to.corners.insert(to.corners.end(), corners.begin(), corners.end());
    } else if (number < arrays.ends.size()) {
      const auto end = static_cast<std::size_t>(arrays.ends[number]);
      const auto faces = part_of(arrays.faces, face, end);
      const std::size_t before = to.corners.size();
      if (!faces || !writer.add(*faces)) to.corners.resize(before);
      if (faces) face = end;
    }
    to.ends.push_back(to.corners.size());
  }
}

}  // namespace gs::app
