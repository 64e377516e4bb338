#include "app/formats/vtk/poly_data.h"

#include "app/formats/flow/flow_faces.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

constexpr float kPolyCreaseAngle = 0.5f;  // crease angle in radians for files without normals

class PolyBuilder {
 public:
  PolyBuilder(PolyBlock block, const std::optional<ColorKey>& key, MeshBuilder& builder)
      : name_(std::move(block.name)), data_(std::move(block.data)), builder_(builder) {
    by_cell_ = data_.of_points.empty() && !data_.of_cells.empty();
    PolyData::Data& shown = by_cell_ ? data_.of_cells : data_.of_points;
    if (key && shown.colors.empty() && !shown.values.empty()) {
      builder_.draw(shown.values.size() * sizeof(vrml::Color));
      shown.colors.reserve(shown.values.size());
      for (const float value : shown.values) shown.colors.push_back(key->color_of(static_cast<double>(value)));
    }
    colors_ = std::move(shown.colors);
  }

  void run() {
    std::size_t cells = 0;
    for (std::size_t kind = 0; kind < PolyData::kKinds; ++kind) {
      first_cell_[kind] = cells;
      cells += data_.cells[kind].ends.size();
    }
    faces();
    lines();
    points(cells == 0);
  }

 private:
  [[nodiscard]] vrml::Color color_of(std::size_t place) const {
    return place < colors_.size() ? colors_[place] : vrml::Color{0.5f, 0.5f, 0.5f};
  }
  // Calls `take` for each cell of a kind, with its corners and its index among the cells of all kinds.
  template <class Take>
  void each_cell(PolyData::Kind kind, Take take) const {
    const PolyCells& cells = data_.cells[kind];
    std::size_t begin = 0;
    for (std::size_t i = 0; i < cells.ends.size(); ++i) {
      take(std::span(cells.corners).subspan(begin, cells.ends[i] - begin), first_cell_[kind] + i);
      begin = cells.ends[i];
    }
  }
  void color_points(Geometry& geometry) {
    if (by_cell_ || colors_.empty()) return;
    Appender<vrml::Color> colors(builder_);
    for (std::size_t i = 0; i < data_.points.size(); ++i) colors.push(color_of(i));
    geometry.colors = colors.take();
  }
  void show(Geometry geometry) {
    Look look;
    if (geometry.kind != Geometry::Kind::faces) look = glowing(look);
    builder_.draw(geometry.positions.size() * sizeof(glm::vec3));
    builder_.add(std::move(geometry), look, name_);
  }

  void faces() {
    Appender<std::int32_t> index(builder_);
    Appender<vrml::Color> colors(builder_);
    bool convex = true;
    each_cell(PolyData::polygons, [&](std::span<const std::int32_t> corners, std::size_t cell) {
      if (corners.size() < 3) return void(++omitted_polygons_);
      convex = convex && corners.size() == 3;
      for (const std::int32_t corner : corners) index.push(corner);
      index.push(kFaceEnd);
      if (by_cell_) colors.push(color_of(cell));
    });
    // From the third on, each corner of a strip forms a triangle with the two corners before it. Every second triangle
    // is flipped.
    each_cell(PolyData::strips, [&](std::span<const std::int32_t> corners, std::size_t cell) {
      for (std::size_t i = 2; i < corners.size(); ++i) {
        const bool turned = i % 2 == 1;
        index.push(corners[turned ? i - 1 : i - 2]);
        index.push(corners[turned ? i - 2 : i - 1]);
        index.push(corners[i]);
        index.push(kFaceEnd);
        if (by_cell_) colors.push(color_of(cell));
      }
    });
    if (omitted_polygons_ > 0) builder_.note(std::to_string(omitted_polygons_) + " polygons of fewer than three corners are left out");
    if (index.empty()) return;
    Geometry geometry;
    geometry.positions = vrml::MFVec3f(std::span<const glm::vec3>(data_.points));
    if (data_.normals.size() == data_.points.size()) {
      builder_.draw(data_.normals.size() * sizeof(glm::vec3));
      geometry.normals = vrml::MFVec3f(std::span<const glm::vec3>(data_.normals));
    }
    geometry.coord_index = index.take();
    geometry.colors = colors.take();
    geometry.color_per_vertex = !by_cell_;
    geometry.convex = convex;
    geometry.crease_angle = kPolyCreaseAngle;
    color_points(geometry);
    show(std::move(geometry));
  }

  void lines() {
    Appender<std::int32_t> index(builder_);
    Appender<vrml::Color> colors(builder_);
    each_cell(PolyData::lines, [&](std::span<const std::int32_t> corners, std::size_t cell) {
      if (corners.size() < 2) return;
      for (const std::int32_t corner : corners) index.push(corner);
      index.push(kFaceEnd);
      if (by_cell_) colors.push(color_of(cell));
    });
    if (index.empty()) return;
    Geometry geometry;
    geometry.kind = Geometry::Kind::lines;
    geometry.positions = vrml::MFVec3f(std::span<const glm::vec3>(data_.points));
    geometry.coord_index = index.take();
    geometry.colors = colors.take();
    geometry.color_per_vertex = !by_cell_;
    color_points(geometry);
    show(std::move(geometry));
  }

  void points(bool all) {
    Appender<glm::vec3> places(builder_);
    Appender<vrml::Color> colors(builder_);
    const auto add = [&](std::size_t point, std::size_t colored_as) {
      places.push(data_.points[point]);
      if (!colors_.empty()) colors.push(color_of(colored_as));
    };
    for (std::size_t i = 0; all && i < data_.points.size(); ++i) add(i, i);
    std::size_t wrong = 0;
    each_cell(PolyData::vertices, [&](std::span<const std::int32_t> corners, std::size_t cell) {
      for (const std::int32_t corner : corners) {
        const auto point = static_cast<std::size_t>(corner);
        if (corner < 0 || point >= data_.points.size())
          ++wrong;
        else
          add(point, by_cell_ ? cell : point);
      }
    });
    if (wrong > 0) builder_.warn(std::to_string(wrong) + " vertices use missing points and are left out");
    if (places.empty()) return;
    Geometry geometry;
    geometry.kind = Geometry::Kind::points;
    geometry.positions = places.take();
    geometry.colors = colors.take();
    show(std::move(geometry));
  }

  std::string name_;
  PolyData data_;
  MeshBuilder& builder_;
  std::array<std::size_t, PolyData::kKinds> first_cell_{};
  std::vector<vrml::Color> colors_;  // colours of points or cells; empty if there are none
  bool by_cell_ = false;
  std::size_t omitted_polygons_ = 0;
};

/// Returns the key for the values of all blocks; nullopt if none has values without colours.
std::optional<ColorKey> key_of_blocks(std::span<const PolyBlock> blocks, MeshBuilder& builder) {
  std::vector<const PolyData::Data*> valued;
  for (const PolyBlock& block : blocks)
    if (const PolyData::Data& shown = block.data.shown(); shown.colors.empty() && !shown.values.empty())
      valued.push_back(&shown);
  if (valued.empty()) return std::nullopt;
  if (valued.size() == 1) return color_key_of_choice(valued[0]->values, valued[0]->title, builder.choice());
  std::vector<float> all;
  for (const PolyData::Data* const data : valued) {
    builder.draw(data->values.size() * sizeof(float));
    all.insert(all.end(), data->values.begin(), data->values.end());
  }
  return color_key_of_choice(all, valued[0]->title, builder.choice());
}

/// Reports whether the user chose arrows, and a block has vectors at its points.
bool has_arrows(std::span<const PolyBlock> blocks, const MeshBuilder& builder) {
  return builder.choice().flow == FlowForm::arrows &&
         std::ranges::any_of(blocks, [](const PolyBlock& block) { return !block.data.of_points.vectors.empty(); });
}

void build_arrows(std::vector<PolyBlock> blocks, MeshBuilder& builder) {
  std::string title;
  std::vector<glm::vec3> points, vectors;
  for (PolyBlock& block : blocks) {
    PolyData::Data& shown = block.data.of_points;
    builder.draw(shown.vectors.size() * 2 * sizeof(glm::vec3));
    shown.vectors.resize(std::min(shown.vectors.size(), block.data.points.size()));
    points.insert(points.end(), block.data.points.begin(),
                  block.data.points.begin() + static_cast<std::ptrdiff_t>(shown.vectors.size()));
    vectors.insert(vectors.end(), shown.vectors.begin(), shown.vectors.end());
    if (title.empty()) title = shown.title;
    block.data.of_points = block.data.of_cells = {};
    // Leaves out blocks without cells, because drawing all their points would hide the arrows.
    const auto has_cells = [](const PolyCells& cells) { return !cells.ends.empty(); };
    if (std::ranges::any_of(block.data.cells, has_cells)) PolyBuilder(std::move(block), std::nullopt, builder).run();
  }
  FlowFaces faces(builder);
  add_point_arrows(points, vectors, faces);
  faces.build(title);
}

}  // namespace

double shown_number(std::span<const double> parts, const VoxelComponent& choice) {
  if (parts.size() == 1) return parts[0];
  if (choice.chosen && !choice.magnitude) return parts[std::min<std::size_t>(choice.index, parts.size() - 1)];
  double square = 0;
  for (const double part : parts) square += part * part;
  return std::sqrt(square);
}

void append_number(std::span<const double> parts, const VoxelComponent& choice, PolyData::Data& data) {
  const std::size_t row = data.values.size();
  data.values.push_back(static_cast<float>(shown_number(parts, choice)));
  if (choice.flow != FlowForm::arrows || parts.size() < 2 || parts.size() > 3) return;
  data.vectors.resize(row, glm::vec3(NAN));
  const auto part = [&](std::size_t i) { return i < parts.size() ? static_cast<float>(parts[i]) : 0.0f; };
  data.vectors.emplace_back(part(0), part(1), part(2));
}

std::string part_text(std::size_t parts, const VoxelComponent& choice) {
  if (parts <= 1) return {};
  if (!choice.chosen || choice.magnitude) return " (length)";
  return " (component " + std::to_string(std::min<std::size_t>(choice.index, parts - 1)) + ")";
}

std::string entry_path(bool of_points, std::string_view name) {
  return (of_points ? "/PointData/" : "/CellData/") + std::string(name);
}

DatasetEntry surface_entry(bool of_points, std::string_view name, std::uint64_t rows, std::uint64_t components,
                           std::string_view type, std::string_view unit) {
  DatasetEntry entry;
  entry.path = entry_path(of_points, name);
  entry.shape = {rows};
  if (components > 1) entry.shape.push_back(components);
  entry.type = type;
  entry.unit = unit;
  entry.form = DatasetForm::mesh;
  entry.note = of_points ? "data of points" : "data of cells";
  entry.is_minor = is_bookkeeping(name);
  return entry;
}

bool choose_surface_entry(std::vector<DatasetEntry> entries, MeshBuilder& builder,
                          const std::function<void(std::size_t entry)>& choose, std::string usual) {
  const VoxelComponent& choice = builder.choice();
  const auto chosen = choice.dataset.empty() ? std::variant<std::size_t, std::string>(std::size_t{0})
                                             : choose_dataset(entries, choice.dataset);
  if (!choice.dataset.empty() && std::holds_alternative<std::size_t>(chosen)) {
    usual = entries[std::get<std::size_t>(chosen)].path;
    choose(std::get<std::size_t>(chosen));
  }
  if (choice.found) {
    *choice.found = {};
    choice.found->entries = std::move(entries);
    choice.found->shown = std::move(usual);
  }
  const auto* const problem = std::get_if<std::string>(&chosen);
  if (problem) builder.fail(*problem);
  return !problem;
}

void build_poly_data(PolyData data, MeshBuilder& builder) {
  std::vector<PolyBlock> blocks;
  blocks.push_back({{}, std::move(data)});
  build_poly_blocks(std::move(blocks), builder);
}

void build_poly_blocks(std::vector<PolyBlock> blocks, MeshBuilder& builder) {
  if (builder.choice().flow != FlowForm::values) {
    if (has_arrows(blocks, builder)) return build_arrows(std::move(blocks), builder);
    builder.warn(builder.choice().flow == FlowForm::arrows
                     ? "no vectors of 2 or 3 components at points; values are shown instead of arrows"
                     : "streamlines need the vectors of a volume; values are shown instead");
  }
  const std::optional<ColorKey> key = key_of_blocks(blocks, builder);
  for (PolyBlock& block : blocks) PolyBuilder(std::move(block), key, builder).run();
  if (key) builder.set_color_key(*key);
}

}  // namespace gs::app
