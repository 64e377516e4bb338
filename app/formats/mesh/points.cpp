#include "app/formats/mesh/points.h"

#include "app/formats/common/local_places.h"
#include "app/formats/common/ply_table.h"
#include "app/formats/common/ranges.h"
#include "app/formats/mesh/point_areas.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>

namespace gs::app {
namespace {

/// Points as read from a file. `areas` and `colors` may be empty.
struct Points {
  const char* format = "";
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals, colors;  // colours are 0..255
  std::vector<float> areas;
  std::size_t announced = 0;
  Share share;

  /// Charges memory for `count` more points. Returns a message if the budget is exceeded.
  [[nodiscard]] std::optional<std::string> draw(const WorldBudget& budget, std::uint64_t count) {
    constexpr std::uint64_t kBytes = 230;
    if (share.amount() == 0) share = Share(budget, Resource::vectors);
    if (share.grow(count * kBytes)) return std::nullopt;
    return std::string(format) + ": the points take " + budget->refusal(Resource::vectors);
  }
};

/// Marks points at the position of an earlier point.
std::vector<bool> doubles(std::span<const glm::dvec3> points) {
  const auto bits = [&](std::size_t i) {
    std::array<std::uint64_t, 3> key{};
    for (std::size_t k = 0; k < 3; ++k) key[k] = std::bit_cast<std::uint64_t>(points[i][static_cast<int>(k)] + 0.0);
    return key;  // adding 0 has turned -0 into 0
  };
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const auto x = bits(a), y = bits(b);
    return x != y ? x < y : a < b;
  });
  std::vector<bool> result(points.size());
  for (std::size_t i = 1; i < order.size(); ++i) result[order[i]] = bits(order[i]) == bits(order[i - 1]);
  return result;
}

/// Converter of points to vectors. Drops invalid points. If the file has no areas, also drops duplicate positions.
class Gatherer {
 public:
  explicit Gatherer(const Points& points) : points_(points) {
    if (points.areas.empty()) doubled_places_ = doubles(points.positions);
    for (std::size_t i = 0; i < points.positions.size(); ++i) add(i);
  }

  ImportedVectors take() {
    if (places_.empty()) return std::string(points_.format) + ": no usable point; expected finite x y z and nx ny nz";
    set_places(splats_, places_);
    if (points_.areas.empty()) splats_.weights = point_areas(splats_.positions);
    qnv::Description& description = splats_.description;
    description.two_sided = true;
    for (std::size_t i = 0; i < splats_.size(); ++i) {
      // In float precision, close points may have area 0. Give them the smallest area.
      if (!std::isnormal(splats_.weights[i])) splats_.weights[i] = std::numeric_limits<float>::min();
      description.total += splats_.weights[i];
    }
    description.metadata.emplace_back("source", points_.format);
    count("points broken", broken_);
    count("points doubled", doubled_);
    const std::size_t there = points_.positions.size();
    count("points missing", points_.announced > there ? points_.announced - there : 0);
    return std::move(splats_);
  }

 private:
  void add(std::size_t i) {
    const glm::dvec3 p = points_.positions[i];
    const glm::vec3 n = points_.normals[i];
    const float length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    const bool placed =
        std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate && std::abs(p.z) <= kMaxCoordinate;
    if (!placed || !std::isnormal(length) ||
        (!points_.areas.empty() &&
         !(points_.areas[i] > 0 && points_.areas[i] <= 1e36f && std::isnormal(points_.areas[i])))) {
      ++broken_;
      return;
    }
    if (points_.areas.empty() && doubled_places_[i]) {
      ++doubled_;
      return;
    }
    places_.push_back(p);
    splats_.normals.push_back(n / length);
    if (!points_.areas.empty()) splats_.weights.push_back(points_.areas[i]);
    if (!points_.colors.empty()) {
      const auto part = [](float c) {
        return static_cast<std::uint8_t>(std::lround(c > 0 ? std::min(c, 255.0f) : 0.0f));
      };
      const glm::vec3 c = points_.colors[i];
      splats_.colors.push_back({part(c.x), part(c.y), part(c.z)});
    }
  }
  void count(const char* name, std::size_t number) {
    if (number > 0) splats_.description.metadata.emplace_back(name, std::to_string(number));
  }

  const Points& points_;
  qnv::Splats splats_;
  std::vector<glm::dvec3> places_;
  std::vector<bool> doubled_places_;
  std::size_t broken_ = 0, doubled_ = 0;
};

/// Combines three columns into vectors. Returns an empty list if a column is missing.
std::vector<glm::vec3> vectors(const PlyTable& table, const std::array<const char*, 3>& names, float scale = 1) {
  for (const char* name : names)
    if (!table.has(name)) return {};
  std::vector<glm::vec3> result(table.rows);
  for (int k = 0; k < 3; ++k) {
    const std::vector<float> values = table.column(names[static_cast<std::size_t>(k)]);
    for (std::size_t i = 0; i < values.size(); ++i) result[i][k] = values[i] * scale;
  }
  return result;
}

std::vector<glm::dvec3> places(const PlyTable& table) {
  std::vector<glm::dvec3> result(table.rows);
  int k = 0;
  for (const char* name : {"x", "y", "z"}) {
    const std::vector<double> values = table.wide_column(name);
    for (std::size_t i = 0; i < values.size(); ++i) result[i][k] = values[i];
    ++k;
  }
  return result;
}

/// Returns the factor that maps the colours of the file to 0..255.
float color_scale(const PlyTable& table) {
  for (const PlyProperty& p : table.element.properties)
    if (p.name == "red") return is_float(p.type) ? 255.0f : p.type == PlyType::uint16 ? 1.0f / 257 : 1.0f;
  return 1;
}

/// Reads up to nine numbers of a line. Returns how many there are, or -1 if the line contains other text.
int point_numbers(std::string_view line, std::array<double, 9>& numbers) {
  TextCursor cursor(line.data(), line.data() + line.size());
  int count = 0;
  while (cursor.skip_space() && count < 9)
    if (!cursor.number(numbers[static_cast<std::size_t>(count++)])) return -1;
  return count;
}

}  // namespace

bool is_points_ply(std::span<const std::byte> bytes) {
  const auto header = ply_header_of(bytes);
  if (!header) return false;
  bool normals = false;
  for (const PlyElement& element : header->elements) {
    if (element.count > 0 && (element.name == "face" || element.name == "edge" || element.name == "tristrips"))
      return false;
    if (element.name != "vertex") continue;
    PlyTable table;
    table.element = element;
    normals = table.has("nx") && table.has("ny") && table.has("nz");
  }
  return normals;
}

ImportedVectors import_points_ply(std::span<const std::byte> bytes, const WorldBudget& budget) {
  auto opened = open_ply_table(bytes, "vertex", budget);
  if (auto* problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  const PlyTable& table = std::get<PlyTable>(opened);
  Points points;
  if (auto problem = points.draw(budget, table.rows)) return std::move(*problem);
  points.format = "PLY points";
  points.announced = static_cast<std::size_t>(std::min<std::uint64_t>(table.element.count, SIZE_MAX));
  points.positions = places(table);
  points.normals = vectors(table, {"nx", "ny", "nz"});
  points.colors = vectors(table, {"red", "green", "blue"}, color_scale(table));
  points.areas = table.column("area");
  if (!table.has("x") || !table.has("y") || !table.has("z")) return "PLY points: expected the properties x, y and z";
  if (!table.has("nx") || !table.has("ny") || !table.has("nz"))
    return "PLY points: expected the properties nx, ny and nz, because splats need normals";
  return Gatherer(points).take();
}

ImportedVectors import_points_xyz(std::span<const std::byte> bytes, const WorldBudget& budget) {
  Points points;
  points.format = "xyz points";
  TextCursor cursor(bytes);
  bool colored = true;
  for (std::size_t number = 1; !cursor.at_end(); ++number) {
    const std::string_view line = trimmed(cursor.line());
    constexpr std::size_t kStep = 4096;
    if (points.positions.size() % kStep == 0)
      if (auto problem = points.draw(budget, kStep)) return std::move(*problem);
    if (line.empty() || line.front() == '#') continue;
    std::array<double, 9> values{};
    const int count = point_numbers(line, values);
    if (count < 6)
      return "xyz points: line " + std::to_string(number) + ": expected x y z nx ny nz, six numbers or more";
    points.positions.emplace_back(values[0], values[1], values[2]);
    points.normals.emplace_back(glm::dvec3(values[3], values[4], values[5]));
    colored = colored && count == 9;
    if (colored) points.colors.emplace_back(glm::dvec3(values[6], values[7], values[8]));
  }
  if (!colored) points.colors.clear();
  return Gatherer(points).take();
}

}  // namespace gs::app
