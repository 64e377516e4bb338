#include "app/streams/cell_regions.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace gs::app {
namespace {

constexpr int kParts = 8;  // number of parts per axis in each pass
constexpr int kPasses = 5;  // number of passes; each one divides the result of the previous one, to 1/32768 at last
constexpr float kAll = 0.9f;  // if the regions cover a larger fraction of the volume, the whole stream is requested

// Divides a box into parts. Returns the bounds of those parts that may be visible in the view, or nullopt if there are
// none.
std::optional<Box> seen_part(const Box& box, const qnv::LodView& view) {
  const glm::vec3 step = (box.upper - box.lower) / static_cast<float>(kParts);
  std::optional<Box> seen;
  for (int i = 0; i < kParts * kParts * kParts; ++i) {
    const glm::vec3 at(static_cast<float>(i % kParts), static_cast<float>(i / kParts % kParts),
                       static_cast<float>(i / (kParts * kParts)));
    const glm::vec3 lower = box.lower + at * step, upper = lower + step;
    if (qnv::outside({lower, upper}, view)) continue;
    if (!seen) seen = Box{lower, upper};
    seen->lower = glm::min(seen->lower, lower);
    seen->upper = glm::max(seen->upper, upper);
  }
  return seen;
}

// Returns the volume of `part` as a fraction of `all`. Ignores axes along which `all` has no extent.
float share(const Box& part, const Box& all) {
  float share = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const float extent = all.upper[axis] - all.lower[axis];
    if (extent > 0) share *= (part.upper[axis] - part.lower[axis]) / extent;
  }
  return share;
}

}  // namespace

net::CellBox cell_box(const Box& box, const Box& all) {
  net::CellBox result{};
  for (int axis = 0; axis < 3; ++axis) {
    const double begin = all.lower[axis], extent = static_cast<double>(all.upper[axis]) - begin;
    const auto part = [&](double value, bool up) {
      if (!(extent > 0)) return up ? 65535.0 : 0.0;
      const double scaled = (value - begin) / extent * 65535;
      // The directory has already rounded its bounds to such steps. Do not round twice.
      const double nearest = std::round(scaled);
      const double exact = std::abs(scaled - nearest) < 1e-2 ? nearest : up ? std::ceil(scaled) : std::floor(scaled);
      return std::clamp(exact, 0.0, 65535.0);
    };
    const auto at = static_cast<std::size_t>(axis);
    result[at] = static_cast<std::uint16_t>(part(box.lower[axis], false));
    result[at + 3] = static_cast<std::uint16_t>(part(box.upper[axis], true));
  }
  return result;
}

std::vector<net::Region> regions_of(std::span<const qnv::LodView> views, const Box& all) {
  std::vector<net::Region> regions;
  for (const qnv::LodView& view : views) {
    std::optional<Box> seen = all;
    for (int pass = 0; pass < kPasses && seen; ++pass) seen = seen_part(*seen, view);
    if (!seen || share(*seen, all) > kAll || regions.size() >= net::kMaxRegions) continue;
    const net::Region region{cell_box(*seen, all), 1};
    if (std::find(regions.begin(), regions.end(), region) == regions.end()) regions.push_back(region);
  }
  return regions;
}

}  // namespace gs::app
