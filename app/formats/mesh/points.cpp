#include "app/formats/mesh/points.h"

#include "app/formats/mesh/point_vectors.h"
#include "app/formats/ply/ply_table.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace gs::app {
namespace {

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
  PointVectors points;
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
  return vectors_of_points(points);
}

ImportedVectors import_points_xyz(std::span<const std::byte> bytes, const WorldBudget& budget) {
  PointVectors points;
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
  return vectors_of_points(points);
}

}  // namespace gs::app
