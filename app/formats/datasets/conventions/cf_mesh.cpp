#include "app/formats/datasets/conventions/cf_mesh.h"

#include "app/formats/datasets/conventions/conventions_table.h"
#include "app/formats/vtk/poly_data.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

// Meshes of NetCDF files: UGRID (https://ugrid-conventions.github.io), cells with bounds, and grids on a globe.

namespace gs::app {
namespace {

constexpr double kTurn = 360, kMostCells = 2e8;

/// Coordinates of the elements of an array: longitudes (or x) and latitudes (or y).
struct CfCoordinates {
  std::string x, y;
};

std::optional<CfCoordinates> coordinates_in(DatasetTree& tree, const std::string& path, std::string_view attribute,
                                            std::size_t axes) {
  CfCoordinates found;
  for (const std::string& name : cf_paths(tree, path, attribute)) {
    const ArrayInfo* const array = tree.find(name);
    if (!array || array->shape.size() != axes || !is_readable(*array)) continue;
    const auto role = cf_role(tree, name, name_of_path(name));
    if (role == AxisRole::x && found.x.empty()) found.x = name;
    if (role == AxisRole::y && found.y.empty()) found.y = name;
  }
  return found.x.empty() || found.y.empty() ? std::nullopt : std::optional(found);
}

std::string first_path(DatasetTree& tree, const std::string& path, std::string_view attribute) {
  const std::vector<std::string> paths = cf_paths(tree, path, attribute);
  return paths.empty() || !tree.find(paths.front()) ? std::string() : paths.front();
}

/// Returns the mesh topology of an array by UGRID, or an empty path.
std::string topology_of(DatasetTree& tree, const ArrayInfo& array) {
  const std::string location = tree.text(array.path, "location");
  if (location != "face" && location != "node") return {};
  const std::string mesh = first_path(tree, array.path, "mesh");
  if (mesh.empty() || first_path(tree, mesh, "face_node_connectivity").empty() ||
      !coordinates_in(tree, mesh, "node_coordinates", 1))
    return {};
  return mesh;
}

/// Returns the coordinates with bounds of the cells along the last axis of an array, or nullopt.
std::optional<CfCoordinates> bounds_of(DatasetTree& tree, const ArrayInfo& array) {
  const auto coordinates = coordinates_in(tree, array.path, "coordinates", 1);
  if (!coordinates || array.shape.empty()) return std::nullopt;
  const CfCoordinates bounds{first_path(tree, coordinates->x, "bounds"), first_path(tree, coordinates->y, "bounds")};
  const ArrayInfo *const x = tree.find(bounds.x), *const y = tree.find(bounds.y);
  if (!x || !y || x->shape.size() != 2 || x->shape != y->shape || x->shape[0] != array.shape.back() || x->shape[1] < 3)
    return std::nullopt;
  return bounds;
}

/// Builder of the mesh of an array.
class CfMeshReader {
 public:
  CfMeshReader(DatasetTree& tree, const ArrayInfo& array, const VoxelComponent& choice, MeshBuilder& builder)
      : tree_(tree), array_(array), choice_(choice), builder_(builder) {}

  void run() {
    const std::string mesh = topology_of(tree_, array_);
    const bool by_node = !mesh.empty() && tree_.text(array_.path, "location") == "node";
    if (!mesh.empty())
      read_topology(mesh);
    else if (const auto bounds = bounds_of(tree_, array_))
      read_bounds(*bounds);
    else
      return read_grid();
    if (failed_) return;
    const auto values = read_values(array_.shape.size() - 1);
    if (!values) return;
    show(*values, by_node);
  }

 private:
  std::optional<std::vector<double>> numbers(const std::string& path) {
    builder_.draw(0);
    std::vector<double> found = tree_.coordinate(path);
    if (found.empty()) {
      builder_.fail(path + " cannot be read");
      failed_ = true;
      return std::nullopt;
    }
    return found;
  }

  void read_topology(const std::string& mesh) {
    const auto nodes = coordinates_in(tree_, mesh, "node_coordinates", 1);
    const std::string faces = first_path(tree_, mesh, "face_node_connectivity");
    const ArrayInfo* const array = tree_.find(faces);
    const auto x = numbers(nodes->x), y = numbers(nodes->y);
    auto read = tree_.values(faces);
    auto* const corners = std::get_if<std::vector<double>>(&read);
    if (!x || !y || !corners || x->size() != y->size() || array->shape.size() != 2) {
      if (!failed_) builder_.fail(faces + ": the mesh is not complete");
      failed_ = true;
      return;
    }
    degrees_ = is_degrees(tree_.text(nodes->x, "units"));
    builder_.draw(x->size() * sizeof(glm::dvec2));
    for (std::size_t i = 0; i < x->size(); ++i) nodes_.emplace_back((*x)[i], (*y)[i]);
    const double start = tree_.number(faces, "start_index").value_or(0);
    // Rows may be the corners of a face instead of the faces.
    const bool turned = array->shape[0] < array->shape[1] && array->shape[0] <= 8;
    const auto count = static_cast<std::size_t>(array->shape[turned ? 1 : 0]);
    const auto most = static_cast<std::size_t>(array->shape[turned ? 0 : 1]);
    builder_.draw(corners->size() * sizeof(std::int32_t) + count * sizeof(std::size_t));
    for (std::size_t face = 0; face < count; ++face) {
      for (std::size_t i = 0; i < most; ++i) {
        const double number = (*corners)[turned ? i * count + face : face * most + i] - start;
        if (number >= 0 && number < static_cast<double>(nodes_.size()))
          corners_.push_back(static_cast<std::int32_t>(number));
      }
      ends_.push_back(corners_.size());
    }
  }

  void read_bounds(const CfCoordinates& bounds) {
    const auto x = numbers(bounds.x), y = numbers(bounds.y);
    if (!x || !y) return;
    degrees_ = true;
    const auto most = static_cast<std::size_t>(tree_.find(bounds.x)->shape[1]);
    builder_.draw(x->size() * (sizeof(glm::dvec2) + sizeof(std::int32_t)));
    for (std::size_t i = 0; i < x->size(); ++i) {
      const glm::dvec2 corner((*x)[i], (*y)[i]);
      // Cells with fewer corners repeat the last one.
      const bool repeated = i % most > 0 && !nodes_.empty() && nodes_.back() == corner;
      if (!repeated) {
        nodes_.push_back(corner);
        corners_.push_back(static_cast<std::int32_t>(nodes_.size() - 1));
      }
      if (i % most == most - 1) ends_.push_back(corners_.size());
    }
  }

  /// Reads the values along the last axes from `axis` on: those of the chosen time and channel.
  std::optional<std::vector<double>> read_values(std::size_t axis) {
    const std::vector<CfAxis> axes = cf_axes(tree_, array_);
    std::vector<std::uint64_t> first(array_.shape.size(), 0), count = array_.shape;
    std::uint64_t rest = choice_.channel.value_or(0), channels = 1, bytes = size_of(array_.type);
    for (std::size_t i = axis; i-- > 0;) {
      count[i] = 1;
      if (axes[i].role == AxisRole::time) {
        if (choice_.found) choice_.found->times = axes[i].values;
        const qnv::ShownStep step = choice_.step.value_or(qnv::ShownStep());
        first[i] = std::min<std::uint64_t>(
            step.time && !axes[i].values.empty() ? qnv::step_number(step, axes[i].values) : step.number,
            array_.shape[i] - 1);
        continue;
      }
      first[i] = rest % array_.shape[i];
      rest /= array_.shape[i];
      channels *= array_.shape[i];
    }
    for (const std::uint64_t size : count) bytes *= size;
    if (choice_.found) choice_.found->channels = channels;
    if (choice_.channel && *choice_.channel >= channels) {
      builder_.fail("no channel " + std::to_string(*choice_.channel) + "; expected 0 to " +
                    std::to_string(channels - 1));
      return std::nullopt;
    }
    if (channels > 1 && !choice_.channel)
      builder_.note("channel 0 of " + std::to_string(channels) + " is shown (--channel chooses another)");
    builder_.draw(bytes + bytes / size_of(array_.type) * sizeof(double));
    std::vector<std::byte> raw(static_cast<std::size_t>(bytes));
    if (std::string problem = tree_.file()->read(*tree_.index_of(array_.path), first, count, raw); !problem.empty()) {
      builder_.fail(array_.path + ": " + problem);
      return std::nullopt;
    }
    GridSpec spec;
    read_common_attributes(tree_, array_, spec);
    std::vector<double> values = doubles_of(array_.type, raw);
    const double wrap = std::exp2(static_cast<double>(size_of(array_.type) * 8));
    for (double& value : values) {
      if (spec.reads_unsigned && value < 0) value += wrap;
      const bool missing = std::ranges::find(spec.missing, value) != spec.missing.end() ||
                           (spec.least && value < *spec.least) || (spec.most && value > *spec.most);
      value = missing ? NAN : value * spec.slope + spec.intercept;
    }
    return values;
  }

  /// Reads a grid as cells around its elements.
  void read_grid() {
    const std::vector<CfAxis> axes = cf_axes(tree_, array_);
    const std::size_t rank = array_.shape.size();
    const bool plane = rank >= 2 && ((axes[rank - 2].role == AxisRole::y && axes[rank - 1].role == AxisRole::x));
    const auto curved = cf_grid_coordinates(tree_, array_);
    if (!plane && !curved)
      return builder_.fail(array_.path + " has no longitudes and latitudes along its last two axes");
    const auto rows = static_cast<std::size_t>(array_.shape[rank - 2]),
               columns = static_cast<std::size_t>(array_.shape[rank - 1]);
    if (static_cast<double>(rows) * static_cast<double>(columns) > kMostCells)
      return builder_.fail("the grid is too large");
    degrees_ = true;
    builder_.draw(rows * columns * sizeof(glm::dvec2));
    nodes_.resize(rows * columns);
    if (curved && !(plane && is_degrees(axes[rank - 1].unit))) {
      const auto x = numbers(curved->first), y = numbers(curved->second);
      if (!x || !y) return;
      for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i] = {(*x)[i], (*y)[i]};
    } else {
      if (axes[rank - 1].values.size() != columns || axes[rank - 2].values.size() != rows ||
          !is_degrees(axes[rank - 1].unit))
        return builder_.fail(array_.path + " has no coordinates in degrees for a globe");
      for (std::size_t i = 0; i < nodes_.size(); ++i)
        nodes_[i] = {axes[rank - 1].values[i % columns], axes[rank - 2].values[i / columns]};
    }
    // The last column joins the first one on a globe.
    const double width = std::abs(nodes_[columns - 1].x - nodes_[0].x);
    const bool closes =
        !curved && columns > 2 && width + 1.5 * width / static_cast<double>(columns - 1) >= kTurn && width < kTurn;
    const std::size_t across = columns - (closes ? 0 : 1);
    builder_.draw(rows * columns * (4 * sizeof(std::int32_t) + sizeof(std::size_t)));
    const auto at = [&](std::size_t row, std::size_t column) {
      return static_cast<std::int32_t>(row * columns + column % columns);
    };
    for (std::size_t row = 0; row + 1 < rows; ++row)
      for (std::size_t column = 0; column < across; ++column) {
        for (const std::int32_t corner :
             {at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column)})
          corners_.push_back(corner);
        ends_.push_back(corners_.size());
      }
    if (const auto values = read_values(rank - 2)) show(*values, true);
  }

  [[nodiscard]] bool covers_globe() const {
    glm::dvec2 least(1e9), most(-1e9);
    for (const glm::dvec2& node : nodes_) least = glm::min(least, node), most = glm::max(most, node);
    constexpr glm::dvec2 kNearly(300, 150);
    return degrees_ && most.x - least.x >= kNearly.x && most.y - least.y >= kNearly.y;
  }

  /// Adds the mesh with the colours of values. On a globe of radius 1, the north pole is at +y and longitude 0 at +z.
  void show(const std::vector<double>& values, bool by_node) {
    const bool globe = degrees_ && choice_.globe.value_or(covers_globe());
    PolyData data;
    builder_.draw(nodes_.size() * sizeof(glm::vec3) + values.size() * sizeof(float));
    PolyCells& cells = data.cells[PolyData::polygons];
    PolyData::Data& shown = by_node ? data.of_points : data.of_cells;
    const std::string unit = tree_.text(array_.path, "units"), title = tree_.text(array_.path, "long_name");
    shown.title = (title.empty() ? name_of_path(array_.path) : title) + (unit.empty() ? "" : " (" + unit + ")");
    for (const glm::dvec2& node : nodes_) {
      const glm::dvec2 angle = node * (std::numbers::pi / 180);
      data.points.push_back(globe ? glm::vec3(std::cos(angle.y) * std::sin(angle.x), std::sin(angle.y),
                                              std::cos(angle.y) * std::cos(angle.x))
                                  : glm::vec3(node.x, node.y, 0));
      if (globe) data.normals.push_back(data.points.back());
    }
    for (const double value : values) shown.values.push_back(static_cast<float>(value));
    std::size_t begin = 0, dropped = 0;
    std::vector<float> kept;
    for (std::size_t face = 0; face < ends_.size(); ++face) {
      const auto corners = std::span(corners_).subspan(begin, ends_[face] - begin);
      begin = ends_[face];
      const bool missing = by_node ? std::ranges::any_of(corners,
                                                         [&](std::int32_t corner) {
                                                           return static_cast<std::size_t>(corner) >= values.size() ||
                                                                  std::isnan(values[static_cast<std::size_t>(corner)]);
                                                         })
                                   : face >= values.size() || std::isnan(values[face]);
      if (missing || corners.size() < 3) {
        ++dropped;
        continue;
      }
      add_face(corners, globe, cells, data, shown, by_node);
      if (!by_node) kept.push_back(static_cast<float>(values[face]));
    }
    if (!by_node) shown.values = std::move(kept);
    if (dropped > 0)
      builder_.note(std::to_string(dropped) + " of " + std::to_string(ends_.size()) + " cells have no value");
    if (cells.ends.empty()) return builder_.fail(array_.path + " has no cells with values");
    build_poly_data(std::move(data), builder_);
  }

  /// Adds a face. On a plane, moves corners across the edge of the map, so that no face spans the whole map.
  void add_face(std::span<const std::int32_t> corners, bool globe, PolyCells& cells, PolyData& data,
                PolyData::Data& shown, bool by_node) {
    const auto place = [&](std::int32_t corner) { return nodes_[static_cast<std::size_t>(corner)]; };
    for (const std::int32_t corner : corners) {
      std::int32_t used = corner;
      if (!globe && degrees_) {
        const double apart = place(corner).x - place(corners[0]).x;
        const double moved = std::round(apart / kTurn) * kTurn;
        if (moved != 0) {
          builder_.draw(sizeof(glm::vec3));
          used = static_cast<std::int32_t>(data.points.size());
          data.points.emplace_back(place(corner).x - moved, place(corner).y, 0);
          if (by_node) shown.values.push_back(shown.values[static_cast<std::size_t>(corner)]);
        }
      }
      cells.corners.push_back(used);
    }
    cells.ends.push_back(cells.corners.size());
  }

  DatasetTree& tree_;
  const ArrayInfo& array_;
  const VoxelComponent& choice_;
  MeshBuilder& builder_;
  std::vector<glm::dvec2> nodes_;      // longitude and latitude, or x and y
  std::vector<std::int32_t> corners_;  // of all faces
  std::vector<std::size_t> ends_;      // of each face
  bool degrees_ = false, failed_ = false;
};

}  // namespace

bool is_cf_mesh(DatasetTree& tree, const ArrayInfo& array) {
  return !array.shape.empty() && (!topology_of(tree, array).empty() || bounds_of(tree, array).has_value());
}

std::optional<std::pair<std::string, std::string>> cf_grid_coordinates(DatasetTree& tree, const ArrayInfo& array) {
  const auto found = array.shape.size() >= 2 ? coordinates_in(tree, array.path, "coordinates", 2) : std::nullopt;
  if (!found) return std::nullopt;
  const auto last = std::span(array.shape).last(2);
  const ArrayInfo *const x = tree.find(found->x), *const y = tree.find(found->y);
  const bool fits = std::ranges::equal(x->shape, last) && std::ranges::equal(y->shape, last);
  return fits && is_degrees(tree.text(found->x, "units")) ? std::optional(std::pair(found->x, found->y)) : std::nullopt;
}

void cf_mesh(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice, MeshBuilder& builder) {
  if (const ArrayInfo* const array = tree.find(entry.path)) CfMeshReader(tree, *array, choice, builder).run();
}

}  // namespace gs::app
