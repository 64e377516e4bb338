#include "app/formats/common/content_type.h"
#include "app/formats/common/ranges.h"
#include "app/formats/mesh/pcd_cloud.h"
#include "app/formats/mesh/point_vectors.h"
#include "app/formats/mesh/points.h"
#include "app/formats/vtk/poly_data.h"
#include "base/text.h"

#include <algorithm>
#include <cmath>
#include <utility>

// Point clouds of the Point Cloud Library.

namespace gs::app {
namespace {

constexpr std::size_t kPcdHead = 4096;

bool is_pcd(std::span<const std::byte> bytes) {
  const std::string_view head = text_of(bytes).substr(0, kPcdHead);
  return head.starts_with("# .PCD") || (head.starts_with("VERSION") && head.find("FIELDS") != std::string_view::npos);
}

const PcdField* color_field(const PcdCloud& cloud) {
  for (const char* const name : {"rgb", "rgba"})
    if (const PcdField* const field = cloud.field(name); field && field->size == 4) return field;
  return nullptr;
}

/// Returns the field that colours show in files without colours.
const PcdField* scalar_field(const PcdCloud& cloud) {
  for (const char* const name : {"intensity", "intensities", "i", "reflectivity", "range", "curvature", "label"})
    if (const PcdField* const field = cloud.field(name)) return field;
  static constexpr std::string_view kOthers[] = {"x",   "y",    "z",         "_",    "normal_x", "normal_y", "normal_z",
                                                 "rgb", "rgba", "timestamp", "time", "t",        "padding"};
  for (const PcdField& field : cloud.fields())
    if (field.count == 1 && std::ranges::find(kOthers, field.name) == std::end(kOthers)) return &field;
  return nullptr;
}

/// Imports points, coloured by their colours, else by their intensity or another number.
void import_pcd(std::span<const std::byte> bytes, MeshBuilder& builder) {
  const auto opened = PcdCloud::open(bytes, builder.budget());
  if (const auto* const problem = std::get_if<std::string>(&opened)) return builder.fail(*problem);
  const auto& cloud = std::get<PcdCloud>(opened);
  const PcdField *const colors = color_field(cloud), *const scalars = colors ? nullptr : scalar_field(cloud);
  PolyData data;
  if (scalars) data.of_points.title = scalars->name.substr(0, 80);
  std::size_t without = 0;
  for (std::size_t i = 0; i < cloud.rows(); ++i) {
    constexpr std::size_t kStep = 4096;
    if (i % kStep == 0) builder.draw(kStep * (sizeof(glm::vec3) + (colors ? sizeof(vrml::Color) : sizeof(float))));
    const glm::dvec3 point = cloud.position(i);
    if (!(std::abs(point.x) <= kMaxCoordinate && std::abs(point.y) <= kMaxCoordinate &&
          std::abs(point.z) <= kMaxCoordinate)) {
      ++without;
      continue;
    }
    data.points.emplace_back(point);
    if (colors) {
      const auto rgb = PcdCloud::rgb_of(cloud.packed(*colors, i));
      data.of_points.colors.push_back(
          {static_cast<float>(rgb[0]) / 255, static_cast<float>(rgb[1]) / 255, static_cast<float>(rgb[2]) / 255});
    } else if (scalars) {
      data.of_points.values.push_back(static_cast<float>(cloud.number(*scalars, i)));
    }
  }
  if (cloud.rows() < cloud.announced())
    builder.fail("the file ends after " + std::to_string(cloud.rows()) + " points; expected " +
                 std::to_string(cloud.announced()));
  if (without > 0) builder.note(std::to_string(without) + " points without a position are left out");
  if (data.points.empty()) return builder.warn("no points in the file");
  build_poly_data(std::move(data), builder);
}

}  // namespace

bool is_points_pcd(std::span<const std::byte> bytes) {
  PcdCloud cloud;
  return is_pcd(bytes) && cloud.read_header(bytes) && cloud.field("normal_x") && cloud.field("normal_y") &&
         cloud.field("normal_z");
}

ImportedVectors import_points_pcd(std::span<const std::byte> bytes, const WorldBudget& budget) {
  const auto opened = PcdCloud::open(bytes, budget);
  if (const auto* const problem = std::get_if<std::string>(&opened)) return *problem;
  const auto& cloud = std::get<PcdCloud>(opened);
  PointVectors points;
  points.format = "PCD points";
  points.announced = static_cast<std::size_t>(cloud.announced());
  if (auto problem = points.draw(budget, cloud.rows())) return std::move(*problem);
  const PcdField* const colors = color_field(cloud);
  const std::array<const PcdField*, 3> normal = {cloud.field("normal_x"), cloud.field("normal_y"),
                                                 cloud.field("normal_z")};
  if (!normal[0] || !normal[1] || !normal[2])
    return std::string("PCD points: expected the fields normal_x, normal_y and normal_z");
  for (std::size_t i = 0; i < cloud.rows(); ++i) {
    points.positions.push_back(cloud.position(i));
    points.normals.emplace_back(
        cloud.turned({cloud.number(*normal[0], i), cloud.number(*normal[1], i), cloud.number(*normal[2], i)}));
    if (!colors) continue;
    const auto rgb = PcdCloud::rgb_of(cloud.packed(*colors, i));
    points.colors.emplace_back(rgb[0], rgb[1], rgb[2]);
  }
  return vectors_of_points(points);
}

extern constinit const ContentType kPcdFormat =
    mesh_type("PCD", "application/x-pcd", ".pcd ", is_pcd, read_mesh<import_pcd>, {.up = UpRule::survey});

}  // namespace gs::app
