#include "qnv/codecs/gaussians/fit/fit_painter.h"

#include "base/parallel.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace gs::qnv::gaussians {
namespace {

// Binary logarithm of the minimum visible opacity, and half the binary logarithm of e.
constexpr float kFitFaintest = -7.994353f, kFitHalfLog2E = 0.72134752f;
// The projection is linearised at tangents of at most this multiple of FitCamera::tangent (3DGS).
constexpr float kFitFarthestTangent = 1.3f;
// Grey background, and weight of squared errors of the transmittance. Together they cover backgrounds of any colour.
constexpr float kFitBackground = 0.5f, kFitClearWeight = 0.25f;
// Gaussians that a thread projects at a time.
constexpr std::size_t kFitRange = 2048;
// Maximum entries in the lists of all tiles. In larger lists, the farthest Gaussians are missing.
constexpr std::size_t kFitMostListed = std::size_t{1} << 23;

/// Returns the product of a covariance and a vector.
inline glm::vec3 fit_product(const std::array<float, 6>& c, const glm::vec3& v) {
  return {c[0] * v.x + c[1] * v.y + c[2] * v.z, c[1] * v.x + c[3] * v.y + c[4] * v.z,
          c[2] * v.x + c[4] * v.y + c[5] * v.z};
}

}  // namespace

bool FitPainter::project(const FitGaussian& one, const FitCamera& camera, FitSplat& splat, Seen& seen) const {
  const glm::vec3 from = one.mean - camera.eye;
  const float depth = glm::dot(from, camera.ahead);
  if (!(depth > camera.near_plane) || !(one.opacity > 0)) return false;
  const float half = static_cast<float>(side_) / 2, last = static_cast<float>(side_ - 1);
  const float focal = half / camera.tangent, most = kFitFarthestTangent * camera.tangent;
  const float tx = glm::dot(from, camera.right) / depth, ty = glm::dot(from, camera.up) / depth, scale = focal / depth;
  seen.across = scale * (camera.right - std::clamp(tx, -most, most) * camera.ahead);
  seen.along = scale * (camera.up - std::clamp(ty, -most, most) * camera.ahead);
  const glm::vec3 turned = fit_product(one.covariance, seen.across);
  const float xx = glm::dot(turned, seen.across) + blur_.bright, xy = glm::dot(turned, seen.along),
              yy = glm::dot(fit_product(one.covariance, seen.along), seen.along) + blur_.bright;
  const float wide = xx + blur_.even, high = yy + blur_.even;
  const float sharp = xx * yy - xy * xy, blurred = wide * high - xy * xy;
  if (!(sharp > 0) || !(blurred > 0) || !std::isfinite(blurred)) return false;
  splat.peak = std::log2(std::min(one.opacity, 1.0f) * std::sqrt(sharp / blurred));
  const float inside = (splat.peak - kFitFaintest) / kFitHalfLog2E;
  if (!(inside > 0)) return false;
  splat.x = half + focal * tx - 0.5f;
  splat.y = half + focal * ty - 0.5f;
  const float reach_x = std::sqrt(inside * wide), reach_y = std::sqrt(inside * high);
  splat.left = splat.x - reach_x;
  splat.right = splat.x + reach_x;
  splat.bottom = splat.y - reach_y;
  splat.top = splat.y + reach_y;
  if (!(splat.right >= 0 && splat.top >= 0 && splat.left <= last && splat.bottom <= last)) return false;
  seen.inverse = glm::vec3(high, -xy, wide) / blurred;
  seen.sharp = glm::vec3(yy, -xy, xx) / sharp;
  splat.xx = kFitHalfLog2E * seen.inverse.x;
  splat.xy = kFitHalfLog2E * seen.inverse.y;
  splat.yy = kFitHalfLog2E * seen.inverse.z;
  splat.red = one.color.x;
  splat.green = one.color.y;
  splat.blue = one.color.z;
  return true;
}

void FitPainter::project(std::span<const FitGaussian> gaussians, const FitCamera& camera) {
  found_.resize((gaussians.size() + kFitRange - 1) / kFitRange);
  (void)parallel_for(
      found_.size(),
      [&](std::size_t r) {
        Found& found = found_[r];
        found.splats.clear();
        found.seen.clear();
        found.distances.clear();
        FitSplat splat;
        Seen seen;
        for (std::size_t i = r * kFitRange; i < std::min(gaussians.size(), (r + 1) * kFitRange); ++i) {
          if (!project(gaussians[i], camera, splat, seen)) continue;
          seen.index = static_cast<std::uint32_t>(i);
          found.splats.push_back(splat);
          found.seen.push_back(seen);
          const glm::vec3 from = gaussians[i].mean - camera.eye;
          found.distances.push_back(glm::dot(from, from));
        }
      },
      threads_);
  std::vector<std::uint64_t> keys;  // squared distance, index of the Gaussian
  for (const Found& found : found_)
    for (std::size_t k = 0; k < found.seen.size(); ++k)
      keys.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(found.distances[k])} << 32 | found.seen[k].index);
  std::ranges::sort(keys);
  splats_.resize(keys.size());
  seen_.resize(keys.size());
  std::vector<std::uint32_t> place(gaussians.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    place[static_cast<std::uint32_t>(keys[i])] = static_cast<std::uint32_t>(i);
  for (const Found& found : found_)
    for (std::size_t k = 0; k < found.seen.size(); ++k) {
      const std::uint32_t to = place[found.seen[k].index];
      splats_[to] = found.splats[k];
      seen_[to] = found.seen[k];
    }
  fill_tiles();
}

FitPainter::TileBox FitPainter::box_of(const FitSplat& splat) const {
  const auto tile = [last = static_cast<float>(side_ - 1)](float v) {
    return static_cast<std::uint32_t>(std::clamp(v, 0.0f, last)) / kFitTile;
  };
  return {tile(splat.left), tile(splat.right), tile(splat.bottom), tile(splat.top)};
}

template <class Each>
void FitPainter::for_tiles(const TileBox& box, const Each& each) const {
  for (std::size_t row = box.bottom; row <= box.top; ++row)
    for (std::size_t column = box.left; column <= box.right; ++column) each(row * across() + column);
}

// Lists the splats of each tile. Uses pointers, because the standard library would check each index.
void FitPainter::fill_tiles() {
  first_.assign(tiles() + 1, 0);
  boxes_.resize(splats_.size());
  std::size_t listed = 0, count = 0;
  for (; count < splats_.size() && listed < kFitMostListed; ++count) {
    const TileBox box = boxes_.data()[count] = box_of(splats_.data()[count]);
    for_tiles(box, [counts = first_.data() + 1](std::size_t tile) { ++counts[tile]; });
    listed += std::size_t{box.right - box.left + 1} * (box.top - box.bottom + 1);
  }
  splats_.resize(count);
  seen_.resize(count);
  for (std::size_t tile = 0; tile < tiles(); ++tile) first_[tile + 1] += first_[tile];
  order_.resize(first_.back());
  std::vector<std::size_t> next = first_;
  for (std::uint32_t i = 0; i < splats_.size(); ++i)
    for_tiles(boxes_.data()[i],
              [order = order_.data(), places = next.data(), i](std::size_t tile) { order[places[tile]++] = i; });
}

std::size_t FitPainter::blend(std::size_t tile, FitTile& pixels) const {
  pixels.red.fill(0);
  pixels.green.fill(0);
  pixels.blue.fill(0);
  pixels.clear.fill(1);
  return fit_kernel().blend(splats_, order_of(tile), left_of(tile), bottom_of(tile), pixels);
}

double FitPainter::compare(std::size_t tile, FitTile& pixels, const FitPixels& target) const {
  double error = 0;
  for (std::size_t k = 0; k < pixels.red.size(); ++k) {
    const auto& wanted = target[pixel_of(tile, k)];
    const float clear = pixels.clear[k] - wanted[3], grey = kFitBackground * clear;
    const float red = pixels.red[k] - wanted[0] + grey, green = pixels.green[k] - wanted[1] + grey,
                blue = pixels.blue[k] - wanted[2] + grey;
    error += red * red + green * green + blue * blue + kFitClearWeight * clear * clear;
    pixels.by_red[k] = red;
    pixels.by_green[k] = green;
    pixels.by_blue[k] = blue;
    // The background is behind all Gaussians.
    const float behind = kFitBackground * (red + green + blue) + kFitClearWeight * clear;
    pixels.total[k] = red * pixels.red[k] + green * pixels.green[k] + blue * pixels.blue[k] + behind * pixels.clear[k];
  }
  return error;
}

void FitPainter::paint(std::span<const FitGaussian> gaussians, const FitCamera& camera, FitPixels& pixels) {
  project(gaussians, camera);
  pixels.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_));
  (void)parallel_for(
      tiles(),
      [&](std::size_t tile) {
        FitTile one;
        (void)blend(tile, one);
        for (std::size_t k = 0; k < one.red.size(); ++k)
          pixels[pixel_of(tile, k)] = {one.red[k], one.green[k], one.blue[k], one.clear[k]};
      },
      threads_);
}

double FitPainter::differentiate(std::span<const FitGaussian> gaussians, const FitCamera& camera,
                                 const FitPixels& target, std::vector<FitGradient>& gradient) {
  project(gaussians, camera);
  sums_.resize(order_.size());
  std::vector<double> errors(tiles());
  (void)parallel_for(
      tiles(),
      [&](std::size_t tile) {
        FitTile one;
        const std::size_t count = blend(tile, one);
        errors[tile] = compare(tile, one, target);
        one.clear.fill(1);
        one.sum.fill(0);
        const std::span<FitSums> sums = std::span(sums_).subspan(first_[tile], first_[tile + 1] - first_[tile]);
        fit_kernel().differentiate(splats_, order_of(tile).first(count), left_of(tile), bottom_of(tile), one, sums);
        std::ranges::fill(sums.subspan(count), FitSums{});
      },
      threads_);
  gradient.assign(gaussians.size(), {});
  gather(gradient);
  double error = 0;
  for (const double one : errors) error += one;
  return error;
}

void FitPainter::gather(std::vector<FitGradient>& gradient) const {
  // Adds in a fixed order, so that results do not depend on threads.
  std::vector<FitSums> totals(splats_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) {
    FitSums& to = totals.data()[order_.data()[i]];
    const FitSums& from = sums_.data()[i];
    to.a += from.a;
    to.ax += from.ax;
    to.ay += from.ay;
    to.axx += from.axx;
    to.axy += from.axy;
    to.ayy += from.ayy;
    to.red += from.red;
    to.green += from.green;
    to.blue += from.blue;
  }
  for (std::size_t i = 0; i < totals.size(); ++i) {
    const FitSums& s = totals[i];
    const glm::vec3 &k = seen_[i].inverse, &sharp = seen_[i].sharp, &u = seen_[i].across, &v = seen_[i].along;
    FitGradient& to = gradient[seen_[i].index];
    to.visible = true;
    to.color = {s.red, s.green, s.blue};
    to.opacity = s.a;
    to.mean = (k.x * s.ax + k.y * s.ay) * u + (k.y * s.ax + k.z * s.ay) * v;
    // Derivative by the covariance in the picture: K H K / 2, where K is its inverse and H has `axx`, `axy`, `ayy`. The
    // terms with s.a are the change of the peak by FitBlur::even.
    const float px = k.x * s.axx + k.y * s.axy, py = k.x * s.axy + k.y * s.ayy, qx = k.y * s.axx + k.z * s.axy,
                qy = k.y * s.axy + k.z * s.ayy;
    const float xx = 0.5f * (px * k.x + py * k.y + s.a * (sharp.x - k.x)),
                xy = 0.5f * (px * k.y + py * k.z + s.a * (sharp.y - k.y)),
                yy = 0.5f * (qx * k.y + qy * k.z + s.a * (sharp.z - k.z));
    const auto part = [&](int a, int b) {
      return xx * u[a] * u[b] + xy * (u[a] * v[b] + v[a] * u[b]) + yy * v[a] * v[b];
    };
    to.covariance = {part(0, 0), part(0, 1), part(0, 2), part(1, 1), part(1, 2), part(2, 2)};
  }
}

}  // namespace gs::qnv::gaussians
