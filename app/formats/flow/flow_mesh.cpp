#include "app/formats/flow/flow_mesh.h"

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

constexpr std::uint32_t kArrowSides = 6, kTubeSides = 6;
constexpr std::uint64_t kMaxArrows = 4000;

/// Returns two unit vectors perpendicular to a unit vector and to each other.
std::pair<glm::dvec3, glm::dvec3> across(const glm::dvec3& along) {
  const glm::dvec3 other = std::abs(along.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 first = glm::normalize(glm::cross(along, other));
  return {first, glm::cross(along, first)};
}

/// Faces of round shapes, with a value at each position.
class FlowFaces {
 public:
  explicit FlowFaces(MeshBuilder& builder)
      : builder_(builder), positions_(builder), normals_(builder), index_(builder) {}

  /// Adds a ring of positions about `center`. Returns the index of the first one.
  std::int32_t ring(const glm::dvec3& center, const std::pair<glm::dvec3, glm::dvec3>& sides, double radius,
                    const glm::dvec3& lean, float value, std::uint32_t count) {
    const auto first = static_cast<std::int32_t>(positions_.size());
    for (std::uint32_t i = 0; i < count; ++i) {
      const double angle = glm::two_pi<double>() * i / count;
      const glm::dvec3 out = sides.first * std::cos(angle) + sides.second * std::sin(angle);
      positions_.push(glm::vec3(center + out * radius));
      normals_.push(glm::vec3(glm::normalize(out + lean)));
      values_.push_back(value);
    }
    return first;
  }
  /// Joins two rings of the same count.
  void join(std::int32_t a, std::int32_t b, std::uint32_t count) {
    const auto sides = static_cast<std::int32_t>(count);
    for (std::int32_t i = 0; i < sides; ++i) {
      const std::int32_t next = (i + 1) % sides;
      for (const std::int32_t corner : {a + i, a + next, b + next, kFaceEnd, a + i, b + next, b + i, kFaceEnd})
        index_.push(corner);
    }
  }

  void build(const std::string& title) {
    if (index_.empty()) return builder_.warn("no vector is long enough to be shown");
    const ColorKey key = color_key_of_choice(values_, title, builder_.choice());
    Appender<vrml::Color> colors(builder_);
    for (const float value : values_) colors.push(key.color_of(static_cast<double>(value)));
    Geometry geometry;
    geometry.positions = positions_.take();
    geometry.normals = normals_.take();
    geometry.colors = colors.take();
    geometry.coord_index = index_.take();
    geometry.solid = true;
    builder_.add(std::move(geometry));
    builder_.set_color_key(key);
  }

 private:
  MeshBuilder& builder_;
  Appender<glm::vec3> positions_, normals_;
  Appender<std::int32_t> index_;
  std::vector<float> values_;
};

void add_arrow(FlowFaces& faces, const glm::dvec3& tail, const glm::dvec3& vector, float value) {
  constexpr double kShaft = 0.045, kHead = 0.13, kNeck = 0.65;  // radii and place, as parts of the length
  const double length = glm::length(vector);
  const glm::dvec3 along = vector / length;
  const auto sides = across(along);
  const glm::dvec3 neck = tail + vector * kNeck;
  const auto back = -along * 10.0;  // nearly the normal of a flat end
  const std::int32_t end = faces.ring(tail, sides, 0, back, value, kArrowSides),
                     end_rim = faces.ring(tail, sides, length * kShaft, back, value, kArrowSides),
                     first = faces.ring(tail, sides, length * kShaft, glm::dvec3(0), value, kArrowSides),
                     last = faces.ring(neck, sides, length * kShaft, glm::dvec3(0), value, kArrowSides),
                     inner = faces.ring(neck, sides, length * kShaft, back, value, kArrowSides),
                     outer = faces.ring(neck, sides, length * kHead, back, value, kArrowSides),
                     base = faces.ring(neck, sides, length * kHead, along * 0.35, value, kArrowSides),
                     tip = faces.ring(tail + vector, sides, length * 1e-4, along * 0.35, value, kArrowSides);
  faces.join(end, end_rim, kArrowSides);
  faces.join(first, last, kArrowSides);
  faces.join(inner, outer, kArrowSides);
  faces.join(base, tip, kArrowSides);
}

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
        add_arrow(faces, middle - shown * 0.5, shown, static_cast<float>(length));
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
