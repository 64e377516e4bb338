#include "app/formats/common/geometry_check.h"
#include "base/finite.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace gs::app {
namespace {

/// Numbers of elements that were removed from a Geometry.
struct GeometryLoss {
  std::size_t bad_index = 0;   // faces, lines or points with indices out of range
  std::size_t not_finite = 0;  // faces, lines or points with infinite or NaN coordinates
};

template <class Vector>
bool all_finite(const Array<Vector>& values) {
  return std::all_of(values.begin(), values.end(), [](const Vector& v) { return finite(v); });
}

template <class Vector>
void clear_not_finite(Array<Vector>& values) {
  if (all_finite(values)) return;
  Vector* v = values.mutable_data();
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!finite(v[i])) v[i] = Vector(0);
}

void clamp_colors(vrml::MFColor& colors) {
  const auto good = [](float c) { return c >= 0 && c <= 1; };
  if (std::all_of(colors.begin(), colors.end(),
                  [&](const vrml::Color& c) { return good(c.r) && good(c.g) && good(c.b); }))
    return;
  const auto clamped = [](float c) { return c > 0 ? std::min(c, 1.0f) : 0.0f; };
  vrml::Color* c = colors.mutable_data();
  for (std::size_t i = 0; i < colors.size(); ++i) c[i] = {clamped(c[i].r), clamped(c[i].g), clamped(c[i].b)};
}

/// Returns true if the index array does not fit `values`. If `index` is empty, uses coord_index instead.
template <class T>
bool unfit(const Geometry& data, const vrml::MFInt32& index, const Array<T>& values) {
  if (index.empty()) return values.size() < data.positions.size();
  return values.empty() || index.size() != data.coord_index.size();
}

/// Clears attribute arrays that do not fit their index array.
void drop_unfit(Geometry& data) {
  if (unfit(data, data.normal_index, data.normals)) {
    data.normals.clear();
    data.normal_index.clear();
  }
  if (unfit(data, data.texture_index, data.texture_coordinates)) {
    data.texture_coordinates.clear();
    data.texture_index.clear();
  }
  if (data.color_per_vertex && data.colors.size() < data.positions.size()) data.colors.clear();
}

GeometryLoss check_points(Geometry& data) {
  GeometryLoss loss;
  if (data.colors.size() < data.positions.size()) data.colors.clear();
  if (all_finite(data.positions)) return loss;
  std::size_t kept = 0;
  glm::vec3* positions = data.positions.mutable_data();
  vrml::Color* colors = data.colors.mutable_data();
  for (std::size_t i = 0; i < data.positions.size(); ++i) {
    if (!finite(positions[i])) continue;
    positions[kept] = positions[i];
    if (colors) colors[kept] = colors[i];
    ++kept;
  }
  loss.not_finite = data.positions.size() - kept;
  data.positions.resize(kept);
  if (colors) data.colors.resize(kept);
  return loss;
}

enum class Verdict : std::uint8_t { good, too_small, bad_index, not_finite };

/// View of the index arrays, for checks of single faces.
struct Corners {
  const Geometry& data;
  bool known_finite;  // true if all positions are finite, so that none needs a check

  [[nodiscard]] Verdict judge(std::size_t first, std::size_t end) const {
    const std::size_t least = data.kind == Geometry::Kind::faces ? 3 : 2;
    if (end - first < least) return Verdict::too_small;
    Verdict verdict = Verdict::good;
    for (std::size_t i = first; i < end; ++i) {
      if (beyond(data.coord_index[i], data.positions.size()) ||
          (!data.normal_index.empty() && beyond(data.normal_index[i], data.normals.size())) ||
          (!data.texture_index.empty() && beyond(data.texture_index[i], data.texture_coordinates.size())))
        return Verdict::bad_index;
      if (!known_finite && !finite(data.positions[static_cast<std::size_t>(data.coord_index[i])]))
        verdict = Verdict::not_finite;
    }
    return verdict;
  }
  static bool beyond(std::int32_t index, std::size_t size) {
    return index < 0 || static_cast<std::size_t>(index) >= size;
  }
};

/// Removes the faces for which `keep` is false.
void compact(Geometry& data, const std::vector<bool>& keep) {
  std::vector<std::int32_t*> arrays = {data.coord_index.mutable_data()};
  if (!data.normal_index.empty()) arrays.push_back(data.normal_index.mutable_data());
  if (!data.texture_index.empty()) arrays.push_back(data.texture_index.mutable_data());
  vrml::Color* face_colors = data.color_per_vertex ? nullptr : data.colors.mutable_data();

  std::size_t face = 0, kept_faces = 0, kept = 0;
  const std::size_t corners = data.coord_index.size();
  for (std::size_t i = 0; i < corners; ++face) {
    std::size_t end = i;
    while (end < corners && arrays[0][end] != kFaceEnd) ++end;
    end = std::min(end + 1, corners);
    if (keep[face]) {
      for (std::int32_t* array : arrays) std::copy(array + i, array + end, array + kept);
      kept += end - i;
      if (face_colors) face_colors[kept_faces] = face_colors[face];
      ++kept_faces;
    }
    i = end;
  }
  data.coord_index.resize(kept);
  if (!data.normal_index.empty()) data.normal_index.resize(kept);
  if (!data.texture_index.empty()) data.texture_index.resize(kept);
  if (face_colors) data.colors.resize(kept_faces);
}

GeometryLoss check_faces(Geometry& data) {
  GeometryLoss loss;
  const Corners walker{data, all_finite(data.positions)};
  std::vector<bool> keep;
  std::size_t dropped = 0;
  const std::size_t corners = data.coord_index.size();
  for (std::size_t i = 0; i < corners;) {
    std::size_t end = i;
    while (end < corners && data.coord_index[end] != kFaceEnd) ++end;
    const Verdict verdict = walker.judge(i, end);
    keep.push_back(verdict == Verdict::good);
    dropped += verdict != Verdict::good ? 1 : 0;
    loss.bad_index += verdict == Verdict::bad_index ? 1 : 0;
    loss.not_finite += verdict == Verdict::not_finite ? 1 : 0;
    i = end + 1;
  }
  if (!data.color_per_vertex && data.colors.size() < keep.size()) data.colors.clear();
  if (dropped > 0) compact(data, keep);
  return loss;
}

GeometryLoss drop_what_is_broken(Geometry& data) {
  GeometryLoss loss;
  if (data.kind == Geometry::Kind::points) {
    loss = check_points(data);
  } else {
    drop_unfit(data);
    loss = check_faces(data);
    clear_not_finite(data.positions);
    clear_not_finite(data.normals);
    clear_not_finite(data.texture_coordinates);
  }
  clamp_colors(data.colors);
  return loss;
}

}  // namespace

bool keep_drawable(Geometry& data, ImportContext& context) {
  const GeometryLoss loss = drop_what_is_broken(data);
  const char* what = data.kind == Geometry::Kind::faces   ? "faces"
                     : data.kind == Geometry::Kind::lines ? "lines"
                                                          : "points";
  if (loss.bad_index > 0)
    context.fail(std::to_string(loss.bad_index) + " " + what +
                 " left out, because they use missing vertices; expected indices below " +
                 std::to_string(data.positions.size()));
  if (loss.not_finite > 0)
    context.warn(std::to_string(loss.not_finite) + " " + what + " left out, because their coordinates are not finite");
  return !data.positions.empty() && (data.kind == Geometry::Kind::points || !data.coord_index.empty());
}

}  // namespace gs::app
