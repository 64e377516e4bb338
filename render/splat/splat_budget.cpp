#include "render/splat/splat_budget.h"

#include "qnv/codecs/gaussians/lod/splat_stream.h"
#include "qnv/codecs/octree/lod/lod.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

namespace gs::render {
namespace {

// Share of the budget that all items divide evenly, so that small items do not vanish.
constexpr double kEvenPart = 0.125;
// Maximum useful vectors per covered pixel. At full detail, voxel edges are a quarter to one pixel, and front and back
// of the object count.
constexpr double kMaxAPixel = 8;

/// Returns the number of vectors at full detail of an item with cuts; 0 means unknown. Returns nullopt for other
/// items.
std::optional<std::uint64_t> vectors_of_stream(const SplatItem& item) {
  if (const auto* octree = item.geometry->as<qnv::OctreeSplats>()) return octree->stream->header().vectors;
  const auto* gaussians = item.geometry->as<qnv::Gaussians>();
  return gaussians && gaussians->stream ? std::optional(gaussians->stream->header().vectors) : std::nullopt;
}

/// Estimates the maximum number of vectors that are useful for an item.
double demand_of(const SplatItem& item, double pixels) {
  const std::optional<std::uint64_t> stream = vectors_of_stream(item);
  if (!stream) return static_cast<double>(item.geometry->size());
  const auto all = static_cast<double>(*stream);
  const double useful = pixels * kMaxAPixel * static_cast<double>(item.detail) * static_cast<double>(item.detail);
  return std::max(1.0, all > 0 ? std::min(all, useful) : useful);
}

}  // namespace

SplatView viewport_view(const Camera& camera, const Projection& projection, const DrawOptions& options) {
  SplatView view;
  view.tangents = projection.tangents();
  view.center = projection.center();
  view.width = options.width;
  view.height = options.height;
  view.near_plane = camera.near_plane;
  return view;
}

SplatView whole_view(SplatView view, const Camera& camera) {
  const glm::vec2 size(view.width, view.height), whole = whole_size(camera, size);
  const Projection lens = projection(whole_camera(camera), whole.x, whole.y);
  view.tangents = lens.tangents();
  view.center = lens.center();
  view.width = static_cast<int>(std::lround(whole.x));
  view.height = static_cast<int>(std::lround(whole.y));
  return view;
}

BudgetView budget_view(const SplatView& view, const glm::dmat4& camera_from_world) {
  return {camera_from_world, view.tangents, view.width, view.height, view.center};
}

double pixels_covered(const SplatItem& item, const BudgetView& view) {
  const Box& box = item.geometry->description().box;
  const glm::dmat4 matrix = view.camera_from_world * item.world_from_node;
  const glm::dvec3 half = (glm::dvec3(box.upper) - glm::dvec3(box.lower)) * 0.5;
  const glm::dvec3 center(matrix * glm::dvec4(glm::dvec3(box.lower) + half, 1.0));
  double square = 0;  // square of the largest half diagonal
  for (int corner = 0; corner < 4; ++corner) {
    const glm::dvec3 d = half * glm::dvec3(1, (corner & 1) != 0 ? -1 : 1, (corner & 2) != 0 ? -1 : 1);
    const glm::dvec3 moved(matrix * glm::dvec4(d, 0.0));
    square = std::max(square, glm::dot(moved, moved));
  }
  const double radius = std::sqrt(square);
  const auto width = static_cast<double>(view.width), height = static_cast<double>(view.height);
  const double all = std::max(width * height, 0.0);
  if (!std::isfinite(radius) || !std::isfinite(center.x + center.y + center.z)) return 0;
  const glm::dvec2 t(view.tangents);
  // Tests whether the sphere is outside of the planes through the left and right, or lower and upper, image edge.
  const auto beyond = [&](double at, double middle, double reach) {
    const double low = middle - reach, high = middle + reach, depth = -center.z;
    return at - depth * high > radius * std::sqrt(1 + high * high) ||
           depth * low - at > radius * std::sqrt(1 + low * low);
  };
  if (-center.z < -radius || beyond(center.x, double{view.center.x}, t.x) ||
      beyond(center.y, double{view.center.y}, t.y))
    return 0;
  const double distance = glm::length(center);
  if (distance <= radius) return all;
  const double seen = radius / std::sqrt(distance * distance - radius * radius) / t.y * 0.5 * height;  // radius, pixels
  return std::min(std::numbers::pi * seen * seen, all);
}

std::vector<std::size_t> share_budget(std::span<const SplatItem> items, const BudgetView& view, std::size_t budget) {
  const std::size_t count = items.size();
  if (budget == 0 || count == 0) return std::vector<std::size_t>(count, 0);
  std::vector<double> shares(count), needs(count), weights(count);
  const auto whole = static_cast<double>(budget);
  double left = whole;
  for (std::size_t i = 0; i < count; ++i) {
    const double detail = static_cast<double>(items[i].detail), pixels = pixels_covered(items[i], view);
    weights[i] = pixels * detail;
    needs[i] = std::min(demand_of(items[i], pixels), whole * std::min(detail, 1.0));
    shares[i] = std::min(needs[i], whole * kEvenPart / static_cast<double>(count));
    left -= shares[i];
  }
  // Serve the items with the lowest demand per weight first. Later items share the surplus.
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t i) { return !(weights[i] > 0); });
  const auto hunger = [&](std::size_t i) { return (needs[i] - shares[i]) / weights[i]; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return hunger(a) < hunger(b); });
  double weight = 0;
  for (const std::size_t i : order) weight += weights[i];
  for (const std::size_t i : order) {
    const double part = std::min(needs[i] - shares[i], std::max(left, 0.0) * std::min(weights[i] / weight, 1.0));
    shares[i] += part;
    left -= part;
    weight -= weights[i];
  }
  // The demand of a stream is estimated, so let streams use the rest. So do volumes that views make finer.
  double streams = 0;
  const auto may_grow = [&](std::size_t i) {
    const auto* const volume = items[i].geometry->as<qnv::Volume>();
    return (vectors_of_stream(items[i]) || (volume && volume->detail)) && items[i].detail >= 1;
  };
  for (const std::size_t i : order) streams += may_grow(i) ? weights[i] : 0;
  for (const std::size_t i : order)
    if (may_grow(i)) shares[i] += std::max(left, 0.0) * weights[i] / streams;
  std::vector<std::size_t> result;
  for (const double share : shares) result.push_back(static_cast<std::size_t>(std::clamp(share, 1.0, whole)));
  return result;
}

}  // namespace gs::render
