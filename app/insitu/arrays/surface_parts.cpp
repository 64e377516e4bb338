#include "app/insitu/arrays/surface_parts.h"

#include "app/insitu/arrays/gather_records.h"
#include "app/insitu/arrays/value_colors.h"
#include "qnv/codecs/encode.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <new>
#include <unordered_map>

namespace gs::app::insitu {
namespace {

// Face of a cell: its corners as indices into the points of the cell, counter-clockwise seen from outside.
struct CellFace {
  std::uint8_t count = 0;
  std::array<std::uint8_t, 4> corners{};
};
// Cell type of VTK: the minimum number of points of a cell, and its faces. A flat cell has itself as the only
// face.
struct CellTypeRow {
  std::uint8_t type = 0, points = 0;
  bool solid = true;
  std::uint8_t faces = 0;
  std::array<CellFace, 6> face{};
};
constexpr CellFace corner3(std::uint8_t a, std::uint8_t b, std::uint8_t c) { return {3, {a, b, c, 0}}; }
constexpr CellFace corner4(std::uint8_t a, std::uint8_t b, std::uint8_t c, std::uint8_t d) { return {4, {a, b, c, d}}; }

// Cells of higher order have the faces of their corners, which are the first points.
constexpr CellTypeRow triangle_row(std::uint8_t type, std::uint8_t points) {
  return {type, points, false, 1, {corner3(0, 1, 2)}};
}
constexpr CellTypeRow quad_row(std::uint8_t type, std::uint8_t points) {
  return {type, points, false, 1, {corner4(0, 1, 2, 3)}};
}
constexpr CellTypeRow tetra_row(std::uint8_t type, std::uint8_t points) {
  return {type, points, true, 4, {corner3(0, 1, 3), corner3(1, 2, 3), corner3(2, 0, 3), corner3(0, 2, 1)}};
}
constexpr CellTypeRow hexahedron_row(std::uint8_t type, std::uint8_t points) {
  return {type,
          points,
          true,
          6,
          {corner4(0, 4, 7, 3), corner4(1, 2, 6, 5), corner4(0, 1, 5, 4), corner4(3, 7, 6, 2), corner4(0, 3, 2, 1),
           corner4(4, 5, 6, 7)}};
}
constexpr CellTypeRow wedge_row(std::uint8_t type, std::uint8_t points) {
  return {type,
          points,
          true,
          5,
          {corner3(0, 1, 2), corner3(3, 5, 4), corner4(0, 3, 4, 1), corner4(1, 4, 5, 2), corner4(2, 5, 3, 0)}};
}
constexpr CellTypeRow pyramid_row(std::uint8_t type, std::uint8_t points) {
  return {type,
          points,
          true,
          5,
          {corner4(0, 3, 2, 1), corner3(0, 1, 4), corner3(1, 2, 4), corner3(2, 3, 4), corner3(3, 0, 4)}};
}
constexpr std::array<CellTypeRow, 16> kCellTypes{{
    triangle_row(5, 3),
    {8, 4, false, 1, {corner4(0, 1, 3, 2)}},  // pixel
    quad_row(9, 4),
    tetra_row(10, 4),
    {11,  // voxel
     8,
     true,
     6,
     {corner4(0, 4, 6, 2), corner4(1, 3, 7, 5), corner4(0, 1, 5, 4), corner4(2, 6, 7, 3), corner4(0, 2, 3, 1),
      corner4(4, 5, 7, 6)}},
    hexahedron_row(12, 8),
    wedge_row(13, 6),
    pyramid_row(14, 5),
    triangle_row(22, 6),
    quad_row(23, 8),
    tetra_row(24, 10),
    hexahedron_row(25, 20),
    wedge_row(26, 15),
    pyramid_row(27, 13),
    quad_row(28, 9),
    hexahedron_row(29, 27),
}};
constexpr std::uint8_t kPolygonType = 7;

const CellTypeRow* cell_type_row(std::uint8_t type) {
  for (const CellTypeRow& row : kCellTypes)
    if (row.type == type) return &row;
  return nullptr;
}

using FaceKey = std::array<std::int64_t, 4>;  // sorted points; the last is -1 for a triangle
struct FaceKeyHash {
  std::size_t operator()(const FaceKey& key) const {
    std::uint64_t hash = 0x9e3779b97f4a7c15U;
    for (const std::int64_t part : key) {
      hash ^= static_cast<std::uint64_t>(part);
      hash *= 0xff51afd7ed558ccdU;
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash);
  }
};
struct OpenFace {
  std::array<std::int64_t, 4> points{};
  std::uint8_t count = 0;
  bool ghost = false;
  std::size_t cell = 0;
};

std::int64_t index_at(std::int32_t type, const void* array, std::size_t i) {
  return type == GS_INSITU_INT64 ? static_cast<const std::int64_t*>(array)[i]
                                 : std::int64_t{static_cast<const std::int32_t*>(array)[i]};
}

std::array<double, 3> point_at(const gs_insitu_cells& cells, std::int64_t i) {
  std::array<double, 3> point{};
  const std::size_t bytes = bytes_of(cells.point_type);
  copy_doubles(cells.point_type, static_cast<const std::byte*>(cells.points) + static_cast<std::size_t>(i) * 3 * bytes,
               static_cast<std::int64_t>(bytes), 3, point.data());
  return point;
}

// Approximate bytes of a face in a hash table.
constexpr std::size_t kOpenFaceBytes = 150;

// Collector of the outer faces of cells, as triangles. Reads cells one after the other.
class SkinBuilder {
 public:
  SkinBuilder(const CellsView& view, const FieldFacts& facts, const std::array<double, 3>& origin,
              std::vector<SurfaceTriangle>& out, std::uint64_t most_bytes)
      : cells_(view.cells),
        field_(find_field(view.fields, facts)),
        origin_(origin),
        out_(out),
        most_bytes_(most_bytes) {}

  // Returns the number of cells that were left out.
  std::uint64_t run() {
    std::uint64_t left_out = 0;
    std::int64_t begin = 0;
    for (std::size_t c = 0; c < cells_.cell_count; ++c) {
      const std::int64_t end = index_at(cells_.index_type, cells_.offsets, c + 1);
      if (end < begin || end > static_cast<std::int64_t>(cells_.connectivity_count)) {
        left_out += cells_.cell_count - c;
        break;
      }
      if (!add_cell(c, begin, end)) ++left_out;
      if (open_.size() * kOpenFaceBytes + out_.size() * sizeof(SurfaceTriangle) > most_bytes_) throw std::bad_alloc();
      begin = end;
    }
    for (const auto& [key, face] : open_)
      if (!face.ghost) emit(face, true);
    return left_out;
  }

 private:
  bool add_cell(std::size_t c, std::int64_t begin, std::int64_t end) {
    points_.clear();
    for (std::int64_t i = begin; i < end; ++i) {
      points_.push_back(index_at(cells_.index_type, cells_.connectivity, static_cast<std::size_t>(i)));
      if (points_.back() < 0 || points_.back() >= static_cast<std::int64_t>(cells_.point_count)) return false;
    }
    const bool ghost = cells_.ghosts && cells_.ghosts[c] != 0;
    if (cells_.types[c] == kPolygonType) {
      if (points_.size() < 3) return false;
      for (std::size_t i = 1; !ghost && i + 1 < points_.size(); ++i)
        emit({{points_[0], points_[i], points_[i + 1], -1}, 3, false, c}, false);
      return true;
    }
    const CellTypeRow* const row = cell_type_row(cells_.types[c]);
    if (!row || points_.size() < row->points) return false;
    for (std::size_t f = 0; f < row->faces; ++f) {
      OpenFace face{{-1, -1, -1, -1}, row->face[f].count, ghost, c};
      for (std::size_t i = 0; i < face.count; ++i) face.points[i] = points_[row->face[f].corners[i]];
      if (!row->solid) {
        if (!ghost) emit(face, false);
        continue;
      }
      FaceKey key = face.points;
      std::ranges::sort(key);
      const auto [found, added] = open_.try_emplace(key, face);
      if (!added) open_.erase(found);
    }
    return true;
  }

  void emit(const OpenFace& face, bool solid) {
    std::array<std::array<float, 3>, 4> at{};
    std::array<float, 4> value{};
    for (std::size_t i = 0; i < face.count; ++i) {
      const auto point = point_at(cells_, face.points[i]);
      for (std::size_t a = 0; a < 3; ++a) at[i][a] = static_cast<float>(point[a] - origin_[a]);
      value[i] = value_of(field_ && field_->of_cells ? static_cast<std::int64_t>(face.cell) : face.points[i]);
    }
    // Two ranks must split a shared quadrilateral along the same diagonal. It begins at the corner with the lexically
    // smallest position.
    const auto first = static_cast<std::size_t>(std::min_element(at.begin(), at.begin() + face.count) - at.begin());
    for (std::size_t i = 1; i + 1 < face.count; ++i) {
      const std::size_t b = (first + i) % face.count, c = (first + i + 1) % face.count;
      out_.push_back({{at[first], at[b], at[c]}, {value[first], value[b], value[c]}, solid ? 1U : 0U});
    }
  }

  // Returns the value of an element, or the length of its vector.
  [[nodiscard]] float value_of(std::int64_t element) const {
    if (!field_) return std::numeric_limits<float>::quiet_NaN();
    double sum = 0, one = 0;
    for (std::uint32_t c = 0; c < field_->components; ++c) {
      copy_doubles(field_->type, field_->at(element, 0, 0, c), 0, 1, &one);
      sum += one * one;
    }
    return static_cast<float>(field_->components == 1 ? one : std::sqrt(sum));
  }

  const gs_insitu_cells& cells_;
  const FieldView* field_;
  const std::array<double, 3>& origin_;
  std::vector<SurfaceTriangle>& out_;
  std::uint64_t most_bytes_;
  std::vector<std::int64_t> points_;
  std::unordered_map<FaceKey, OpenFace, FaceKeyHash> open_;
};

// Removes faces of solid cells that occur twice, because they lie between cells of two ranks.
void remove_shared(std::vector<SurfaceTriangle>& triangles) {
  using Corners = std::array<std::array<float, 3>, 3>;
  std::vector<std::pair<Corners, std::size_t>> order;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (triangles[i].of_solid == 0) continue;
    Corners corners = triangles[i].positions;
    std::ranges::sort(corners);
    order.emplace_back(corners, i);
  }
  std::ranges::sort(order);
  std::vector<bool> drop(triangles.size(), false);
  for (std::size_t i = 1; i < order.size(); ++i)
    if (order[i].first == order[i - 1].first) drop[order[i].second] = drop[order[i - 1].second] = true;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (!drop[i]) triangles[kept++] = triangles[i];
  triangles.resize(kept);
}

}  // namespace

std::variant<CellsView, std::string> cells_view(const gs_insitu_cells& cells) {
  CellsView view;
  view.cells = cells;
  if (cells.point_type != GS_INSITU_FLOAT32 && cells.point_type != GS_INSITU_FLOAT64)
    return "the points of cells have an unknown type; expected GS_INSITU_FLOAT32 or GS_INSITU_FLOAT64";
  if (cells.index_type != GS_INSITU_INT32 && cells.index_type != GS_INSITU_INT64)
    return "the indices of cells have an unknown type; expected GS_INSITU_INT32 or GS_INSITU_INT64";
  if (cells.point_count > 0 && !cells.points) return "the points of cells are missing; expected their address";
  if (cells.cell_count > 0 && !(cells.connectivity && cells.offsets && cells.types))
    return "an array of cells is missing; expected connectivity, offsets and types";
  if (cells.cell_count > 0 && index_at(cells.index_type, cells.offsets, 0) != 0)
    return "the first offset of cells is not 0; expected cell_count + 1 offsets that begin with 0";
  if (cells.field_count > kMaxFields) return "cells have more than 16 fields; expected at most 16";
  if (cells.field_count > 0 && !cells.fields) return "the fields of cells are missing; expected their address";
  for (std::size_t i = 0; i < cells.field_count; ++i) {
    const bool of_cells = cells.fields[i].association == GS_INSITU_CELLS;
    auto field =
        field_view(cells.fields[i], {static_cast<std::int64_t>(of_cells ? cells.cell_count : cells.point_count), 1, 1});
    if (auto* problem = std::get_if<std::string>(&field)) return std::move(*problem);
    view.fields.push_back(std::move(std::get<FieldView>(field)));
  }
  return view;
}

void add_bounds(const CellsView& view, PartFacts& facts) {
  for (std::size_t i = 0; i < view.cells.point_count; ++i) {
    const auto point = point_at(view.cells, static_cast<std::int64_t>(i));
    if (!std::ranges::all_of(point, [](double part) { return std::isfinite(part); })) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      facts.low[a] = facts.count == 0 ? point[a] : std::min(facts.low[a], point[a]);
      facts.high[a] = facts.count == 0 ? point[a] : std::max(facts.high[a], point[a]);
    }
    ++facts.count;
  }
}

std::vector<SurfaceTriangle> outer_triangles(std::span<const CellsView> parts, const FieldFacts& field,
                                             const std::array<double, 3>& origin, std::uint64_t& left_out,
                                             std::uint64_t most_bytes) {
  std::vector<SurfaceTriangle> triangles;
  for (const CellsView& part : parts) left_out += SkinBuilder(part, field, origin, triangles, most_bytes).run();
  std::erase_if(triangles, [](const SurfaceTriangle& one) {
    return !std::ranges::all_of(one.positions, [](const std::array<float, 3>& at) {
      return std::ranges::all_of(at, [](float part) { return std::isfinite(part); });
    });
  });
  return triangles;
}

bool gather_surface(Ranks& ranks, std::span<const CellsView> parts, const StepPlan& plan, SurfaceValues& values,
                    std::uint64_t& left_out) {
  values.field = plan.cell_field;
  values.origin = plan.origin;
  const bool whole = ranks.attempt("cells", [&] {
    values.triangles = outer_triangles(parts, plan.cell_field, plan.origin, left_out, plan.max_memory);
  });
  bool fits = true;
  if (!gather_records(ranks, values.triangles, plan.max_memory, whole, fits)) return false;
  const bool joined = ranks.attempt("surface", [&] {
    if (ranks.is_first() && (ranks.count() > 1 || parts.size() > 1)) remove_shared(values.triangles);
  });
  values.too_large = !fits || !joined;
  return true;
}

std::optional<std::string> encode_surface(const SurfaceValues& surface, double relative_error,
                                          qnv::EncodeOptions options, std::vector<std::byte>& bytes) {
  if (surface.too_large) return "its triangles exceed max_memory; raise max_memory";
  if (surface.triangles.empty()) return "the cells have no surface";
  ValueColors colors;
  colors.title = surface.field.name.data();
  if (surface.field.unit[0] != 0) colors.title += std::string(" (") + surface.field.unit.data() + ")";
  for (const SurfaceTriangle& triangle : surface.triangles)
    for (const float value : triangle.values) colors.include(value);
  if (surface.field.name[0] != 0) options.metadata.push_back(colors.metadata());
  options.origin = {surface.origin[0], surface.origin[1], surface.origin[2]};
  options.two_sided = true;
  constexpr int kLeastBits = 8, kMostBits = 20;
  const double share = std::clamp(relative_error, 1e-9, 0.5);
  options.exact_bits = std::clamp(static_cast<int>(std::ceil(std::log2(1 / share))), kLeastBits, kMostBits);
  const qnv::TriangleSource source = [&](const qnv::TriangleSink& sink) {
    constexpr std::size_t kBatch = 1024;
    std::vector<qnv::Triangle> batch;
    for (std::size_t at = 0; at < surface.triangles.size(); at += kBatch) {
      batch.clear();
      for (std::size_t i = at; i < std::min(at + kBatch, surface.triangles.size()); ++i) {
        const SurfaceTriangle& from = surface.triangles[i];
        qnv::Triangle to;
        for (std::size_t k = 0; k < 3; ++k) {
          to.positions[k] = {from.positions[k][0], from.positions[k][1], from.positions[k][2]};
          to.colors[k] = colors.color_of(from.values[k]);
        }
        batch.push_back(to);
      }
      if (!sink(batch)) return false;
    }
    return true;
  };
  auto encoded = qnv::encode(std::cref(source), {std::nullopt, std::move(options)});
  if (auto* problem = std::get_if<qnv::EncodeError>(&encoded)) return std::move(problem->message);
  bytes = std::move(std::get<qnv::Encoding>(encoded).stream.bytes);
  return std::nullopt;
}

}  // namespace gs::app::insitu
