#include "app/view/ground_grid.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::app {
namespace {

constexpr double kSquares = 10;         // approximate number of squares under the scene
constexpr double kBright = 10;  // every line with a number divisible by this is bright
constexpr std::size_t kMaxLines = 200;  // max lines in each direction

/// Bounding box in the axes of an Upright: right, up and front.
struct OwnBox {
  glm::dvec3 lower{0}, upper{0};
};

bool fills_something(const WideBox& bounds) {
  return !bounds.empty() && std::isfinite(glm::length(bounds.size())) && glm::length(bounds.size()) > 0;
}

OwnBox own_box(const WideBox& bounds, const Upright& upright) {
  const glm::dmat3 own_from_world = glm::transpose(world_from_upright(upright));
  OwnBox box{glm::dvec3(HUGE_VAL), glm::dvec3(-HUGE_VAL)};
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 corner =
        own_from_world * glm::dvec3(i & 1 ? bounds.upper.x : bounds.lower.x, i & 2 ? bounds.upper.y : bounds.lower.y,
                                    i & 4 ? bounds.upper.z : bounds.lower.z);
    box.lower = glm::min(box.lower, corner);
    box.upper = glm::max(box.upper, corner);
  }
  return box;
}

/// Adds lines to a render list. Each two consecutive `ends` are a line, relative to `origin`.
void add_lines(render::RenderList& list, const std::vector<glm::vec3>& ends, const glm::dvec3& origin,
               const glm::vec3& color) {
  if (ends.empty()) return;
  auto mesh = std::make_shared<vrml::Mesh>();
  mesh->primitive = vrml::Mesh::Primitive::lines;
  mesh->lit = false;
  std::vector<std::uint32_t> indices(ends.size());
  for (std::uint32_t i = 0; i < indices.size(); ++i) indices[i] = i;
  for (const glm::vec3& end : ends) mesh->bounds.add(end);
  list.bounds.add(glm::dvec3(mesh->bounds.lower) + origin);
  list.bounds.add(glm::dvec3(mesh->bounds.upper) + origin);
  mesh->positions = Array<glm::vec3>(std::span<const glm::vec3>(ends));
  mesh->indices = Array<std::uint32_t>(std::span<const std::uint32_t>(indices));
  render::DrawItem item;
  item.mesh = std::move(mesh);
  item.world_from_node = glm::translate(glm::dmat4(1), origin);
  item.material.diffuse = glm::vec3(0);
  item.material.emissive = color;
  list.items.push_back(std::move(item));
}

}  // namespace

double grid_spacing(const WideBox& bounds, const Upright& upright) {
  if (!fills_something(bounds)) return 0;
  const OwnBox box = own_box(bounds, upright);
  const glm::dvec3 size = box.upper - box.lower;
  // The height counts half, so that tall content on a small ground also gets a coarse grid.
  const double wanted = std::max({size.x, size.z, size.y / 2}) / kSquares;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double part = wanted / power;
  return power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
}

std::shared_ptr<const render::RenderList> ground_grid(const WideBox& bounds, const Upright& upright) {
  const double spacing = grid_spacing(bounds, upright);
  if (!(spacing > 0)) return nullptr;
  const OwnBox box = own_box(bounds, upright);
  const glm::dmat3 world_from_own = world_from_upright(upright);
  // The grid extends beyond the scene by this number of squares.
  const double margin = 3;
  const double left = std::floor(box.lower.x / spacing - margin), right = std::ceil(box.upper.x / spacing + margin);
  const double back = std::floor(box.lower.z / spacing - margin), front = std::ceil(box.upper.z / spacing + margin);
  if (!(right - left <= kMaxLines && front - back <= kMaxLines)) return nullptr;
  std::vector<glm::vec3> faint, bright;
  const glm::dvec3 origin = bounds.center();
  const auto add = [&](double number, const glm::dvec3& from, const glm::dvec3& to) {
    std::vector<glm::vec3>& lines = std::fmod(number, kBright) == 0 ? bright : faint;
    lines.emplace_back(world_from_own * from - origin);
    lines.emplace_back(world_from_own * to - origin);
  };
  const double ground = box.lower.y;
  for (double x = left; x <= right; ++x)
    add(x, {x * spacing, ground, back * spacing}, {x * spacing, ground, front * spacing});
  for (double z = back; z <= front; ++z)
    add(z, {left * spacing, ground, z * spacing}, {right * spacing, ground, z * spacing});
  auto list = std::make_shared<render::RenderList>();
  add_lines(*list, faint, origin, glm::vec3(0.42f, 0.44f, 0.47f));
  add_lines(*list, bright, origin, glm::vec3(0.68f, 0.70f, 0.74f));
  return list;
}

std::shared_ptr<const render::RenderList> GroundGrids::of(const WideBox& bounds, const Upright& upright) {
  for (const Grid& grid : grids_)
    if (grid.bounds.lower == bounds.lower && grid.bounds.upper == bounds.upper && grid.upright == upright)
      return grid.lines;
  if (grids_.size() >= kMaxGrids) grids_.erase(grids_.begin());
  grids_.push_back({bounds, upright, ground_grid(bounds, upright)});
  return grids_.back().lines;
}

}  // namespace gs::app
