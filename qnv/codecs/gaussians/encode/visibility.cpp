#include "qnv/codecs/gaussians/encode/visibility.h"

#include "base/box.h"
#include "qnv/codecs/gaussians/encode/merge_tree.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

namespace gs::qnv::gaussians {
namespace {

// Numbers of parallel views from outside, of positions inside, and of views from each position.
constexpr std::size_t kOutside = 12, kPlaces = 6, kFaces = 6;
// Pixels along the edge of a view.
constexpr int kPixelsOutside = 128, kPixelsInside = 96;
// Cells along each edge of the grid for the search of free positions.
constexpr int kCells = 16;
// Share of the splats that the box of the views omits at each of its sides.
constexpr double kBeyond = 0.01;
// A cell is free if its sum of opacity x area is at most this fraction of the mean of all cells.
constexpr double kFree = 0.05;
// Variance in pixels^2 that is added to splats, and their maximum radius in pixels.
constexpr float kBlur = 0.3f, kMostRadius = 48;
// Transmittance below which a pixel is opaque.
constexpr float kOpaque = 1.0f / 256;
// Splats end where their opacity is exp(-kEnd) times that of their centre.
constexpr float kEnd = 4.5f;
constexpr std::uint8_t kUnseen = 255, kAllLight = 254;

/// Axes of a view: to the right, up, and away from the viewer.
struct Frame {
  glm::vec3 right, up, away;
};

/// Splat in a picture, in pixels.
struct Spot {
  float depth;
  std::uint32_t splat;
  glm::vec2 at;
  float xx, xy, yy;  // covariance
  float opacity;
};

/// Table of exp(-x) for x from 0 to kEnd.
class ExpTable {
 public:
  ExpTable() {
    for (std::size_t i = 0; i < values_.size(); ++i)
      values_[i] = std::exp(-static_cast<float>(i) * kEnd / static_cast<float>(kSteps));
  }
  [[nodiscard]] float operator()(float x) const { return values_[static_cast<std::size_t>(x * (kSteps / kEnd))]; }

 private:
  static constexpr std::size_t kSteps = 512;
  std::array<float, kSteps + 1> values_{};
};

/// Canvas that blends spots from front to back. Writes the mean squared light that reaches each, in 1/kAllLight.
class Canvas {
 public:
  explicit Canvas(int pixels) : pixels_(pixels), light_(static_cast<std::size_t>(pixels * pixels), 1.0f) {}

  void blend(std::vector<Spot>& spots, std::span<std::uint8_t> seen) {
    std::ranges::sort(spots, {}, [](const Spot& s) { return std::pair(s.depth, s.splat); });
    for (const Spot& spot : spots) {
      const float light = blend(spot);
      if (light >= 0) seen[spot.splat] = static_cast<std::uint8_t>(std::lround(light * kAllLight));
    }
  }

 private:
  /// Blends a spot. Returns the mean squared light that reaches it, or -1 if it touches no pixel.
  float blend(const Spot& s) {
    const float determinant = s.xx * s.yy - s.xy * s.xy;
    if (!(determinant > 0 && s.xx > 0)) return -1;
    const auto first = [](float v) { return std::max(static_cast<int>(std::ceil(v - 0.5f)), 0); };
    const auto last = [&](float v) { return std::min(static_cast<int>(std::floor(v - 0.5f)), pixels_ - 1); };
    const float rx = std::min(std::sqrt(2 * kEnd * s.xx), kMostRadius),
                ry = std::min(std::sqrt(2 * kEnd * s.yy), kMostRadius);
    const float a = 0.5f * s.yy / determinant, b = -s.xy / determinant, c = 0.5f * s.xx / determinant;
    float passed = 0, all = 0;
    for (int y = first(s.at.y - ry), end = last(s.at.y + ry); y <= end; ++y) {
      const float dy = static_cast<float>(y) + 0.5f - s.at.y;
      float* const row = light_.data() + static_cast<std::ptrdiff_t>(y) * pixels_;
      for (int x = first(s.at.x - rx), stop = last(s.at.x + rx); x <= stop; ++x) {
        const float dx = static_cast<float>(x) + 0.5f - s.at.x;
        const float power = a * dx * dx + b * dx * dy + c * dy * dy;
        if (!(power < kEnd)) continue;
        // Rounding may give long splats a power below 0.
        const float alpha = s.opacity * exp_(std::max(power, 0.0f));
        all += alpha;
        if (row[x] < kOpaque) continue;
        passed += alpha * row[x] * row[x];
        row[x] *= 1 - alpha;
      }
    }
    return all > 0 ? std::min(passed / all, 1.0f) : -1;
  }

  int pixels_;
  ExpTable exp_;
  std::vector<float> light_;
};

/// Returns the box of the splats without distant ones.
Box middle_of(const Gaussians& source) {
  Box box;
  std::vector<float> values(source.size());
  const auto beyond = static_cast<std::ptrdiff_t>(kBeyond * static_cast<double>(values.size() - 1));
  glm::vec3 lower(0), upper(0);
  for (int k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = source.positions[i][k];
    std::ranges::nth_element(values, values.begin() + beyond);
    lower[k] = values[static_cast<std::size_t>(beyond)];
    std::ranges::nth_element(values, values.end() - 1 - beyond);
    upper[k] = *(values.end() - 1 - beyond);
  }
  box.add(lower);
  box.add(upper);
  return box;
}

/// Returns camera positions inside a scene: centres of free cells that are far from full cells and from each other.
std::vector<glm::vec3> free_places(const Gaussians& source, const Box& box) {
  constexpr int kAll = kCells * kCells * kCells;
  const glm::vec3 cell = box.size() / static_cast<float>(kCells);
  if (!(std::min({cell.x, cell.y, cell.z}) > 0)) return {};
  std::vector<double> mass(kAll);
  for (std::size_t i = 0; i < source.size(); ++i) {
    const glm::vec3 p = (source.positions[i] - box.lower) / cell;
    if (!(std::min({p.x, p.y, p.z}) >= 0) || !(std::max({p.x, p.y, p.z}) < kCells)) continue;
    const auto at = (static_cast<int>(p.z) * kCells + static_cast<int>(p.y)) * kCells + static_cast<int>(p.x);
    const glm::vec3& s = source.scales[i];
    mass[static_cast<std::size_t>(at)] += double{source.opacities[i]} * (s.x * s.y + s.y * s.z + s.z * s.x);
  }
  double whole = 0;
  for (const double m : mass) whole += m;
  const auto corner = [](int i) { return glm::vec3(i % kCells, i / kCells % kCells, i / (kCells * kCells)) + 0.5f; };
  const auto apart = [&](int a, int b) { return glm::length((corner(a) - corner(b)) * cell); };
  // Distances to the nearest full cell. Chosen cells count as well, with half of their distance.
  std::vector<int> full;
  for (int i = 0; i < kAll; ++i)
    if (mass[static_cast<std::size_t>(i)] > kFree * whole / kAll) full.push_back(i);
  std::vector<float> distance(kAll, std::numeric_limits<float>::max());
  for (int i = 0; i < kAll; ++i)
    for (const int other : full)
      distance[static_cast<std::size_t>(i)] = std::min(distance[static_cast<std::size_t>(i)], apart(i, other));
  std::vector<glm::vec3> places;
  while (places.size() < kPlaces) {
    const auto best = static_cast<int>(std::ranges::max_element(distance) - distance.begin());
    if (!(distance[static_cast<std::size_t>(best)] > 0)) break;
    places.push_back(box.lower + corner(best) * cell);
    for (int i = 0; i < kAll; ++i)
      distance[static_cast<std::size_t>(i)] = std::min(distance[static_cast<std::size_t>(i)], apart(i, best) / 2);
  }
  return places;
}

Frame frame_along(const glm::vec3& away) {
  const glm::vec3 right =
      glm::normalize(glm::cross(std::abs(away.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0), away));
  return {right, glm::cross(away, right), away};
}

/// Returns the axes of outside view `i`. The views have evenly spread directions.
Frame outside_frame(std::size_t i) {
  const float y = 1 - (2 * static_cast<float>(i) + 1) / static_cast<float>(kOutside);
  const float turn = static_cast<float>(i) * std::numbers::pi_v<float> * (3 - std::sqrt(5.0f)),
              r = std::sqrt(1 - y * y);
  return frame_along({r * std::cos(turn), y, r * std::sin(turn)});
}

Frame face_frame(std::size_t i) {
  glm::vec3 away(0);
  away[static_cast<int>(i / 2)] = i % 2 == 0 ? 1.0f : -1.0f;
  return frame_along(away);
}

/// Scene, and the visibility of its splats in single views.
class Views {
 public:
  explicit Views(const Gaussians& source) : source_(source), box_(middle_of(source)) {
    radius_ = std::max(0.5f * glm::length(box_.size()), std::numeric_limits<float>::min());
    covariances_.resize(source.size());
    for (std::size_t i = 0; i < source.size(); ++i)
      covariances_[i] = covariance_of(source.scales[i], source.rotations[i]);
    places_ = free_places(source, box_);
  }

  /// Returns the number of views. Outside views come first, then the faces of each position inside.
  [[nodiscard]] std::size_t size() const { return kOutside + kFaces * places_.size(); }

  /// Writes the mean squared light that reaches each splat in a view, or kUnseen if the splat is not in the picture.
  void look(std::size_t view, std::span<std::uint8_t> seen) const {
    std::ranges::fill(seen, kUnseen);
    const bool outside = view < kOutside;
    const int pixels = outside ? kPixelsOutside : kPixelsInside;
    const Frame frame = outside ? outside_frame(view) : face_frame((view - kOutside) % kFaces);
    const glm::vec3 place = outside ? glm::vec3(0) : places_[(view - kOutside) / kFaces];
    std::vector<Spot> spots;
    for (std::uint32_t i = 0; i < source_.size(); ++i) {
      Spot spot{};
      spot.splat = i;
      spot.opacity = std::clamp(source_.opacities[i], 0.0f, 0.99f);
      const bool shown = outside ? project(frame, spot) : project(frame, place, spot);
      if (shown) spots.push_back(spot);
    }
    Canvas(pixels).blend(spots, seen);
  }

 private:
  [[nodiscard]] float along(std::uint32_t i, const glm::vec3& a, const glm::vec3& b) const {
    const auto& c = covariances_[i];
    return a.x * (c[0] * b.x + c[1] * b.y + c[2] * b.z) + a.y * (c[1] * b.x + c[3] * b.y + c[4] * b.z) +
           a.z * (c[2] * b.x + c[4] * b.y + c[5] * b.z);
  }

  /// Projects a splat by parallel projection. Returns false if its centre is outside of the picture.
  bool project(const Frame& frame, Spot& spot) const {
    const glm::vec3 p = source_.positions[spot.splat] - (box_.lower + box_.upper) * 0.5f;
    const float scale = 0.5f * kPixelsOutside / radius_;
    spot.depth = glm::dot(p, frame.away);
    spot.at = glm::vec2(glm::dot(p, frame.right), glm::dot(p, frame.up)) * scale + 0.5f * kPixelsOutside;
    return set_shape(spot, frame.right * scale, frame.up * scale, kPixelsOutside);
  }

  /// Projects a splat in perspective, with a field of view of 90 degrees.
  bool project(const Frame& frame, const glm::vec3& from, Spot& spot) const {
    const glm::vec3 p = source_.positions[spot.splat] - from;
    spot.depth = glm::dot(p, frame.away);
    if (!(spot.depth > 0.02f * radius_)) return false;
    const float scale = 0.5f * kPixelsInside / spot.depth;
    const glm::vec2 flat(glm::dot(p, frame.right), glm::dot(p, frame.up));
    spot.at = flat * scale + 0.5f * kPixelsInside;
    const glm::vec2 slope = flat / spot.depth;
    return set_shape(spot, (frame.right - frame.away * slope.x) * scale, (frame.up - frame.away * slope.y) * scale,
                     kPixelsInside);
  }

  bool set_shape(Spot& spot, const glm::vec3& right, const glm::vec3& up, int pixels) const {
    const auto edge = static_cast<float>(pixels);
    if (!(spot.at.x >= 0 && spot.at.y >= 0 && spot.at.x < edge && spot.at.y < edge)) return false;
    spot.xx = along(spot.splat, right, right) + kBlur;
    spot.xy = along(spot.splat, right, up);
    spot.yy = along(spot.splat, up, up) + kBlur;
    return true;
  }

  const Gaussians& source_;
  Box box_;
  float radius_ = 1;
  std::vector<std::array<float, 6>> covariances_;
  std::vector<glm::vec3> places_;
};

/// Mean light of a splat in the views that show it.
struct Mean {
  float sum = 0;
  std::uint32_t count = 0;

  void add(std::uint8_t light) {
    if (light == kUnseen) return;
    sum += static_cast<float>(light) / kAllLight;
    ++count;
  }
  [[nodiscard]] float value() const { return count > 0 ? sum / static_cast<float>(count) : 0; }
};

}  // namespace

std::vector<float> visibility_of(const Gaussians& source, unsigned threads, Progress* progress) {
  const Views views(source);
  const std::size_t count = source.size();
  std::vector<std::uint8_t> seen(views.size() * count);
  const auto of = [&](std::size_t view) { return std::span(seen).subspan(view * count, count); };
  if (!parallel_for(
          views.size(), [&](std::size_t view) { views.look(view, of(view)); }, threads, progress))
    return {};
  std::vector<float> all(count);
  for (std::size_t i = 0; i < count; ++i) {
    Mean outside, inside;
    for (std::size_t view = 0; view < views.size(); ++view) (view < kOutside ? outside : inside).add(of(view)[i]);
    // A splat that no view shows counts as visible.
    const float light = outside.count + inside.count > 0 ? std::max(outside.value(), inside.value()) : 1;
    all[i] = kLeastVisibility + (1 - kLeastVisibility) * std::sqrt(light);
  }
  return all;
}

}  // namespace gs::qnv::gaussians
