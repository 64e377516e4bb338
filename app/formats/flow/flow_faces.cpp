#include "app/formats/flow/flow_faces.h"

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace gs::app {
namespace {

constexpr std::uint32_t kArrowSides = 6;
constexpr std::size_t kMaxPointArrows = 2000;

/// Point nearest to the centre of each cube of a grid, with its squared distance.
using PointsOfCubes = std::unordered_map<std::uint64_t, std::pair<std::uint32_t, float>>;

/// Chooses one point in each cube of size `edge`. Returns no points if more than `most` cubes have points.
PointsOfCubes thinned(std::span<const glm::vec3> points, std::span<const std::uint32_t> usable, const glm::vec3& lower,
                      float edge, std::size_t most) {
  PointsOfCubes chosen;
  for (const std::uint32_t i : usable) {
    const glm::vec3 place = (points[i] - lower) / edge;
    const glm::vec3 cube = glm::floor(place);
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k)
      key = key << 21 | std::min(static_cast<std::uint64_t>(cube[k]), std::uint64_t{0x1fffff});
    const glm::vec3 off = place - cube - 0.5f;
    const float distance = glm::dot(off, off);
    const auto [found, is_new] = chosen.try_emplace(key, i, distance);
    if (!is_new && distance < found->second.second) found->second = {i, distance};
    if (chosen.size() > most) return {};
  }
  return chosen;
}

}  // namespace

std::pair<glm::dvec3, glm::dvec3> across(const glm::dvec3& along) {
  const glm::dvec3 other = std::abs(along.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 first = glm::normalize(glm::cross(along, other));
  return {first, glm::cross(along, first)};
}

std::int32_t FlowFaces::ring(const glm::dvec3& center, const std::pair<glm::dvec3, glm::dvec3>& sides, double radius,
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

void FlowFaces::join(std::int32_t a, std::int32_t b, std::uint32_t count) {
  const auto sides = static_cast<std::int32_t>(count);
  for (std::int32_t i = 0; i < sides; ++i) {
    const std::int32_t next = (i + 1) % sides;
    for (const std::int32_t corner : {a + i, a + next, b + next, kFaceEnd, a + i, b + next, b + i, kFaceEnd})
      index_.push(corner);
  }
}

void FlowFaces::build(const std::string& title) {
  if (index_.empty()) return builder_.warn("all vectors are missing or 0; none is shown");
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

void FlowFaces::add_arrow(const glm::dvec3& tail, const glm::dvec3& vector, float value) {
  constexpr double kShaft = 0.045, kHead = 0.13, kNeck = 0.65;  // radii and start of the head, as shares of the length
  const double length = glm::length(vector);
  const glm::dvec3 along = vector / length;
  const auto sides = across(along);
  const glm::dvec3 neck = tail + vector * kNeck;
  const auto back = -along * 10.0;  // nearly the normal of a flat end
  const std::int32_t end = ring(tail, sides, 0, back, value, kArrowSides),
                     end_rim = ring(tail, sides, length * kShaft, back, value, kArrowSides),
                     first = ring(tail, sides, length * kShaft, glm::dvec3(0), value, kArrowSides),
                     last = ring(neck, sides, length * kShaft, glm::dvec3(0), value, kArrowSides),
                     inner = ring(neck, sides, length * kShaft, back, value, kArrowSides),
                     outer = ring(neck, sides, length * kHead, back, value, kArrowSides),
                     base = ring(neck, sides, length * kHead, along * 0.35, value, kArrowSides),
                     tip = ring(tail + vector, sides, length * 1e-4, along * 0.35, value, kArrowSides);
  join(end, end_rim, kArrowSides);
  join(first, last, kArrowSides);
  join(inner, outer, kArrowSides);
  join(base, tip, kArrowSides);
}

void add_point_arrows(std::span<const glm::vec3> points, std::span<const glm::vec3> vectors, FlowFaces& faces) {
  constexpr float kFill = 1.3f, kUsual = 0.98f, kLeast = 0.02f, kGrowth = 1.25f, kJoined = 0.7f;
  std::vector<std::uint32_t> usable;
  std::vector<float> lengths;
  const auto is_finite = [](const glm::vec3& v) { return std::isfinite(glm::dot(v, v)); };
  for (std::uint32_t i = 0; i < std::min(points.size(), vectors.size()); ++i) {
    if (!is_finite(points[i]) || !is_finite(vectors[i])) continue;
    usable.push_back(i);
    lengths.push_back(glm::length(vectors[i]));
  }
  if (usable.empty()) return;
  const auto rank = lengths.begin() + static_cast<std::ptrdiff_t>(static_cast<float>(lengths.size() - 1) * kUsual);
  std::nth_element(lengths.begin(), rank, lengths.end());
  const float usual = *rank;
  if (!(usual > 0)) return;
  glm::vec3 lower(points[usable[0]]), upper(lower);
  for (const std::uint32_t i : usable) {
    lower = glm::min(lower, points[i]);
    upper = glm::max(upper, points[i]);
  }
  const glm::vec3 size = upper - lower;
  const float largest = std::max({size.x, size.y, size.z});
  // Enlarges the cubes until at most kMaxPointArrows have points.
  PointsOfCubes chosen;
  float edge = largest > 0 ? largest / 64 : 1;
  while ((chosen = thinned(points, usable, lower, edge, kMaxPointArrows)).empty()) edge *= kGrowth;
  std::vector<std::uint32_t> order;
  for (const auto& [cube, point] : chosen) order.push_back(point.first);
  std::sort(order.begin(), order.end());
  // Estimates the distance between arrows, which scales their length: the cube size that joins many of them.
  for (const auto many = static_cast<std::size_t>(static_cast<float>(order.size()) * kJoined);
       edge < largest / 8 && thinned(points, order, lower, edge, order.size()).size() > many;)
    edge *= kGrowth;
  for (const std::uint32_t i : order) {
    const glm::dvec3 vector(vectors[i]);
    const double length = glm::length(vector);
    if (!(length > static_cast<double>(usual * kLeast))) continue;
    const double shown = static_cast<double>(edge * kFill) * std::min(length / static_cast<double>(usual), 1.2);
    faces.add_arrow(glm::dvec3(points[i]), vector / length * shown, static_cast<float>(length));
  }
}

}  // namespace gs::app
