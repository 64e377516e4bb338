#include "app/formats/flow/flow_mesh.h"

#include "app/formats/flow/flow_faces.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

constexpr std::uint32_t kTubeSides = 6;
constexpr std::uint64_t kMaxArrows = 4000;

void add_arrows(const VectorField& field, FlowFaces& faces) {
  constexpr double kUsual = 0.98, kLeast = 0.02, kFill = 1.4;
  const double usual = field.length_at(kUsual);
  if (!(usual > 0)) return;
  std::uint32_t stride = 1;
  const auto count = [&](std::size_t axis) { return (field.size()[axis] - 1) / stride + 1; };
  while (std::uint64_t{count(0)} * count(1) * count(2) > kMaxArrows) ++stride;
  const double longest = field.spacing() * stride * kFill;
  const auto first = [&](std::size_t axis) { return (field.size()[axis] - 1) % stride / 2; };
  for (std::uint32_t z = first(2); z < field.size()[2]; z += stride)
    for (std::uint32_t y = first(1); y < field.size()[1]; y += stride)
      for (std::uint32_t x = first(0); x < field.size()[0]; x += stride) {
        const glm::dvec3 vector(field.at(x, y, z));
        const double length = glm::length(vector);
        if (!(length > usual * kLeast)) continue;
        const glm::dvec3 shown = vector / length * (longest * std::min(length / usual, 1.2));
        const glm::dvec3 middle = field.position({x, y, z});
        faces.add_arrow(middle - shown * 0.5, shown, static_cast<float>(length));
      }
}

void add_tube(const Streamline& line, double radius, FlowFaces& faces) {
  std::pair<glm::dvec3, glm::dvec3> sides;
  std::int32_t before = -1;
  glm::dvec3 along(0);
  const std::size_t last = line.points.size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    const glm::dvec3 way = line.points[std::min(i + 1, last)] - line.points[i == 0 ? 0 : i - 1];
    const double length = glm::length(way);
    if (!(length > 0)) continue;
    along = way / length;
    if (before < 0) {
      sides = across(along);
    } else {
      // The sides turn as little as possible, so that the tube does not twist.
      const glm::dvec3 kept = sides.first - along * glm::dot(along, sides.first);
      const double size = glm::length(kept);
      sides = size > 1e-6 ? std::pair(kept / size, glm::cross(along, kept / size)) : across(along);
    }
    const auto value = static_cast<float>(glm::length(line.vectors[i]));
    const std::int32_t ring = faces.ring(line.points[i], sides, radius, glm::dvec3(0), value, kTubeSides);
    if (before >= 0) faces.join(before, ring, kTubeSides);
    before = ring;
  }
}

}  // namespace

void build_flow(const qnv::VolumeSource& source, const std::string& title, const Progress& progress,
                MeshBuilder& builder) {
  auto read = VectorField::read(source, builder.budget(), progress);
  if (auto* const problem = std::get_if<std::string>(&read)) return builder.fail(std::move(*problem));
  const auto& field = std::get<VectorField>(read);
  FlowFaces faces(builder);
  if (builder.choice().flow == FlowForm::arrows) {
    add_arrows(field, faces);
  } else {
    constexpr double kRadius = 0.18, kPart = 1.0 / 300;
    double extent = 0;
    for (int i = 0; i < 3; ++i) {
      glm::dvec3 corner(0);
      corner[i] = static_cast<double>(field.size()[static_cast<std::size_t>(i)] - 1);
      extent = std::max(extent, glm::length(field.position(corner) - field.position(glm::dvec3(0))));
    }
    const double radius = std::max(field.spacing() * kRadius, extent * kPart);
    for (const Streamline& line : streamlines_of(field)) {
      builder.draw(0);
      add_tube(line, radius, faces);
    }
  }
  faces.build(title);
}

MeshAsset flow_mesh(const qnv::VolumeSource& source, const VoxelComponent& choice, const std::string& path,
                    const Progress& progress, const WorldBudget& budget, Diagnostics& diagnostics) {
  MeshBuilder builder(path, budget, diagnostics);
  builder.choose(choice);
  std::string title, unit;
  for (const auto& [key, value] : source.layout.metadata) {
    if (key == "title") title = value;
    if (key == "units" || key == "sample units") unit = value;
  }
  title += title.empty() ? "length" : " (length)";
  if (!unit.empty()) title += " (" + unit + ")";
  try {
    build_flow(source, title, progress, builder);
  } catch (const OutOfBudget&) {
    builder.cut_short();
  }
  return builder.take();
}

}  // namespace gs::app
