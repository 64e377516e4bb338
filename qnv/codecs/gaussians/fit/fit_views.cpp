#include "qnv/codecs/gaussians/fit/fit_views.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace gs::qnv::gaussians {
namespace {

// Number of views, and limits of the pixels along their edges.
constexpr unsigned kFitViews = 24;
constexpr int kLeastFitSide = 64, kMostFitSide = 512;
// Pixels along an edge, relative to the square root of the number of Gaussians.
constexpr float kFitSideDetail = 5;
// Blur of the largest pictures, as in viewers, and blur of a pixel that is the mean of an area, in pixels^2.
constexpr float kUsualBlur = 0.3f, kPixelVariance = 1 / 12.0f;
// In a room, one of kFitInsideEvery views is inside, if kFitTries tries find a free position. A scene is a room while
// the mean transmittance of inside pictures is below kFitMostClear.
constexpr unsigned kFitInsideEvery = 3, kFitTries = 16;
constexpr float kFitMostClear = 0.4f;
// Share of the Gaussians that the box of the views omits at each of its sides.
constexpr double kFitBeyond = 0.01;

/// Returns element `i` of the Halton sequence with a base: evenly spread numbers from 0 to 1.
float halton(unsigned i, unsigned base) {
  float result = 0, share = 1;
  for (++i; i > 0; i /= base) {
    share /= static_cast<float>(base);
    result += share * static_cast<float>(i % base);
  }
  return result;
}

/// Returns a corner of the box without distant Gaussians: the lower corner for `share` 0, the upper one for 1.
glm::vec3 corner_of(std::span<const FitGaussian> leaves, double share) {
  std::vector<float> values(leaves.size());
  const double beyond = kFitBeyond + share * (1 - 2 * kFitBeyond);
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(beyond * static_cast<double>(values.size() - 1));
  glm::vec3 corner(0);
  for (int k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = leaves[i].mean[k];
    std::ranges::nth_element(values, place);
    corner[k] = *place;
  }
  return corner;
}

/// Reports whether no opaque Gaussian is within about `radius` of a position.
bool is_free(std::span<const FitGaussian> leaves, const glm::vec3& place, float radius) {
  constexpr float kSolid = 0.3f;
  return std::ranges::none_of(leaves, [&](const FitGaussian& one) {
    const glm::vec3 from = one.mean - place;
    const float spread = one.covariance[0] + one.covariance[3] + one.covariance[5];
    return one.opacity > kSolid && glm::dot(from, from) < radius * radius + 4 * spread;
  });
}

/// Points a camera in direction `i` of a sequence of evenly spread directions.
void turn_camera(unsigned i, FitCamera& camera) {
  const float z = 1 - 2 * halton(i, 2), turn = 2 * std::numbers::pi_v<float> * halton(i, 3),
              round = std::sqrt(std::max(1 - z * z, 0.0f));
  camera.ahead = {round * std::cos(turn), round * std::sin(turn), z};
  const glm::vec3 other = std::abs(camera.ahead.y) < 0.7f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  camera.right = glm::normalize(glm::cross(camera.ahead, other));
  camera.up = glm::cross(camera.right, camera.ahead);
}

/// Box without distant Gaussians.
struct FitBox {
  glm::vec3 lower, upper;

  [[nodiscard]] float diagonal() const {
    return std::max(glm::length(upper - lower), std::numeric_limits<float>::min());
  }
};

FitCamera outside_camera(unsigned i, const FitBox& box) {
  FitCamera camera;
  turn_camera(i, camera);
  const float distance = box.diagonal() * (0.9f + 0.7f * halton(i, 5));
  camera.eye = (box.lower + box.upper) * 0.5f - camera.ahead * distance;
  camera.tangent = 0.5f * box.diagonal() / distance;
  camera.near_plane = 0.01f * distance;
  return camera;
}

/// Returns camera `i` at a free position inside. Returns nullopt if the tries find none.
std::optional<FitCamera> inside_camera(unsigned i, std::span<const FitGaussian> leaves, const FitBox& box) {
  for (unsigned at = i * kFitTries; at < (i + 1) * kFitTries; ++at) {
    const glm::vec3 share = 0.2f + 0.6f * glm::vec3(halton(at, 2), halton(at, 3), halton(at, 5));
    FitCamera camera;
    camera.eye = box.lower + (box.upper - box.lower) * share;
    if (!is_free(leaves, camera.eye, 0.03f * box.diagonal())) continue;
    turn_camera(i, camera);
    camera.near_plane = 0.01f * box.diagonal();
    return camera;
  }
  return std::nullopt;
}

/// Returns the pixels along the edge of pictures of `count` Gaussians.
int side_for(std::size_t count) {
  const auto wanted = static_cast<int>(std::min(kFitSideDetail * std::sqrt(static_cast<float>(count)), 1e4f));
  return std::clamp((wanted + kFitTile - 1) / kFitTile * kFitTile, kLeastFitSide, kMostFitSide);
}

/// Returns a number from 0 to 1 in units of 1/255. Returns 0 for NaN.
std::uint8_t byte_of(float v) { return v > 0 ? static_cast<std::uint8_t>(std::min(v, 1.0f) * 255 + 0.5f) : 0; }

/// Reports whether most of a picture is covered.
bool is_covered(const FitPixels& pixels) {
  float clear = 0;
  for (const auto& pixel : pixels) clear += pixel[3] / static_cast<float>(pixels.size());
  return clear < kFitMostClear;
}

}  // namespace

FitViews::FitViews(std::span<const FitGaussian> leaves, std::size_t most, bool antialiased, unsigned threads,
                   Progress* progress)
    : side_(side_for(most)), antialiased_(antialiased) {
  const FitBox box{corner_of(leaves, 0), corner_of(leaves, 1)};
  FitPainter painter(side_, blur(1), threads);
  FitPixels pixels;
  bool room = true;
  for (unsigned i = 0; i < kFitViews && !is_cancelled(progress); ++i) {
    const auto inside = room && i % kFitInsideEvery == 0 ? inside_camera(i, leaves, box) : std::nullopt;
    if (inside) {
      painter.paint(leaves, *inside, pixels);
      room = is_covered(pixels);
    }
    cameras_.push_back(inside && room ? *inside : outside_camera(i, box));
    if (!inside || !room) painter.paint(leaves, cameras_.back(), pixels);
    auto& to = pictures_.emplace_back(pixels.size());
    for (std::size_t p = 0; p < pixels.size(); ++p)
      for (std::size_t k = 0; k < 4; ++k) to[p][k] = byte_of(pixels[p][k]);
  }
  if (is_cancelled(progress)) cameras_.clear();
}

FitBlur FitViews::blur(int factor) const {
  const float pixel = static_cast<float>(kMostFitSide) / static_cast<float>(side_ / factor);
  const float usual = kUsualBlur / (pixel * pixel), area = side_ / factor < kMostFitSide ? kPixelVariance : 0;
  return antialiased_ ? FitBlur{0, usual + area} : FitBlur{usual, area};
}

FitPixels FitViews::reduced(std::size_t view, int side, int factor) const {
  const auto to_side = static_cast<std::size_t>(side), per = static_cast<std::size_t>(factor),
             from_side = static_cast<std::size_t>(side_), margin = (from_side - to_side * per) / 2;
  const auto& from = pictures_[view];
  FitPixels to(to_side * to_side);
  const float share = 1 / static_cast<float>(255 * factor * factor);
  for (std::size_t y = 0; y < to_side; ++y)
    for (std::size_t x = 0; x < to_side; ++x) {
      std::array<std::uint32_t, 4> sums{};
      for (std::size_t row = margin + y * per; row < margin + (y + 1) * per; ++row)
        for (std::size_t column = margin + x * per; column < margin + (x + 1) * per; ++column)
          for (std::size_t k = 0; k < 4; ++k) sums[k] += from[row * from_side + column][k];
      for (std::size_t k = 0; k < 4; ++k) to[y * to_side + x][k] = share * static_cast<float>(sums[k]);
    }
  return to;
}

}  // namespace gs::qnv::gaussians
