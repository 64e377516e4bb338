#include "qnv/codecs/gaussians/fit/fit_painter.h"

#include "qnv/codecs/gaussians/encode/merge_tree.h"
#include "tests/qnv/splat_clouds.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

namespace gs::qnv::gaussians::fit_painter_test {
namespace {

FitCamera front_camera() {
  FitCamera camera;
  camera.eye = {0, 0, -4};
  camera.tangent = 0.5f;
  camera.near_plane = 0.01f;
  return camera;
}

/// Returns large Gaussians that overlap, nearest first.
std::vector<FitGaussian> layers() {
  std::vector<FitGaussian> all;
  for (int i = 0; i < 6; ++i) {
    const float t = static_cast<float>(i);
    FitGaussian one;
    one.mean = {0.25f * std::sin(2 * t), 0.25f * std::cos(3 * t), 0.3f * t};
    one.covariance =
        covariance_of({0.3f, 0.2f, 0.1f + 0.02f * t}, glm::normalize(glm::vec4(0.3f * t, 0.5f, -0.2f * t, 1)));
    one.opacity = 0.3f + 0.1f * t;
    one.color = {0.1f + 0.15f * t, 0.9f - 0.1f * t, 0.4f};
    all.push_back(one);
  }
  return all;
}

std::vector<FitGaussian> gaussians_of(const Gaussians& cloud) {
  std::vector<FitGaussian> all;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    all.push_back(
        {cloud.positions[i], covariance_of(cloud.scales[i], cloud.rotations[i]), cloud.opacities[i], cloud.bases[i]});
  return all;
}

/// Returns half the squared error of a picture.
double half_error(FitPainter& painter, const std::vector<FitGaussian>& gaussians, const FitPixels& target) {
  std::vector<FitGradient> gradient;
  return painter.differentiate(gaussians, front_camera(), target, gradient) / 2;
}

}  // namespace

TEST_CASE("the gradient of a picture of Gaussians is that of small differences") {
  const std::vector<FitGaussian> gaussians = layers();
  FitPainter painter(64, {0.1f, 0.4f}, 2);
  FitPixels target(64 * 64, {0.3f, 0.2f, 0.1f, 0.4f});
  std::vector<FitGradient> gradient;
  (void)painter.differentiate(gaussians, front_camera(), target, gradient);
  const auto slope = [&](std::size_t i, const auto& change, float step) {
    std::vector<FitGaussian> more = gaussians, less = gaussians;
    change(more[i], step);
    change(less[i], -step);
    return (half_error(painter, more, target) - half_error(painter, less, target)) / (2 * double{step});
  };
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    INFO("Gaussian " << i);
    REQUIRE(gradient[i].visible);
    for (int k = 0; k < 3; ++k) {
      const auto color = [&](FitGaussian& one, float step) { one.color[k] += step; };
      CHECK(gradient[i].color[k] == Approx(slope(i, color, 0.01f)).epsilon(0.01).margin(0.01));
    }
    const auto opacity = [](FitGaussian& one, float step) { one.opacity *= std::exp(step); };
    CHECK(gradient[i].opacity == Approx(slope(i, opacity, 0.01f)).epsilon(0.05).margin(0.05));
    // Moves only in the plane of the picture, because the gradient omits changes of the projection.
    for (int k = 0; k < 2; ++k) {
      const auto move = [&](FitGaussian& one, float step) { one.mean[k] += step; };
      CHECK(gradient[i].mean[k] == Approx(slope(i, move, 0.004f)).epsilon(0.05).margin(0.5));
    }
    for (const std::size_t k : {0u, 1u, 3u}) {
      const auto widen = [&](FitGaussian& one, float step) { one.covariance[k] += step; };
      const double twice = k == 1 ? 2 : 1;  // both elements of the matrix change
      // A wide margin, because wider Gaussians also end farther away.
      CHECK(twice * gradient[i].covariance[k] == Approx(slope(i, widen, 0.001f)).epsilon(0.05).margin(2.5));
    }
  }
}

TEST_CASE("both kernels of the fit give equal bits") {
  std::mt19937 random(5);
  const auto number = [&](float least, float most) {
    return least + (most - least) * static_cast<float>(random() >> 8) / 16777216.0f;
  };
  std::vector<FitSplat> splats;
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < 300; ++i) {
    FitSplat splat;
    splat.x = number(-4, 36);
    splat.y = number(-4, 36);
    splat.xx = number(0.02f, 0.5f);
    splat.yy = number(0.02f, 0.5f);
    splat.xy = number(-0.9f, 0.9f) * std::sqrt(splat.xx * splat.yy);
    splat.peak = number(-7, 0);
    const float reach = number(2, 20);
    splat.left = splat.x - reach;
    splat.right = splat.x + reach;
    splat.bottom = splat.y - reach;
    splat.top = splat.y + reach;
    splat.red = number(0, 1);
    splat.green = number(0, 1);
    splat.blue = number(0, 1);
    splats.push_back(splat);
    order.push_back(i);
  }
  const auto run = [&](const FitKernel& kernel, FitTile& tile) {
    for (auto* channel : {&tile.red, &tile.green, &tile.blue, &tile.sum}) channel->fill(0);
    tile.clear.fill(1);
    std::vector<FitSums> sums(order.size());
    const std::size_t count = kernel.blend(splats, order, 16, 16, tile);
    tile.by_red = tile.green;
    tile.by_green = tile.blue;
    tile.by_blue = tile.clear;
    tile.total = tile.red;
    tile.clear.fill(1);
    kernel.differentiate(splats, std::span(order).first(count), 16, 16, tile, sums);
    sums.resize(count);
    return sums;
  };
  FitTile fast, portable;
  const std::vector<FitSums> a = run(fit_kernel(), fast), b = run(fit_kernel_baseline(), portable);
  REQUIRE(a.size() == b.size());
  CHECK(a.size() > 16);
  CHECK(std::memcmp(a.data(), b.data(), a.size() * sizeof(FitSums)) == 0);
  CHECK(std::memcmp(&fast, &portable, sizeof fast) == 0);
}

TEST_CASE("pictures of the fit do not depend on the number of threads") {
  const std::vector<FitGaussian> gaussians = gaussians_of(test::splat_cloud(5000));
  FitPainter one(64, {}, 1), several(64, {}, 4);
  FitPixels a, b;
  one.paint(gaussians, front_camera(), a);
  several.paint(gaussians, front_camera(), b);
  CHECK(a == b);
  const FitPixels target(64 * 64, {0.5f, 0.5f, 0.5f, 0});
  std::vector<FitGradient> p, q;
  CHECK(one.differentiate(gaussians, front_camera(), target, p) ==
        several.differentiate(gaussians, front_camera(), target, q));
  bool equal = p.size() == q.size();
  for (std::size_t i = 0; equal && i < p.size(); ++i)
    equal = p[i].mean == q[i].mean && p[i].covariance == q[i].covariance && p[i].opacity == q[i].opacity &&
            p[i].color == q[i].color;
  CHECK(equal);
}

TEST_CASE("pictures of the fit accept extreme Gaussians") {
  std::vector<FitGaussian> gaussians = layers();
  gaussians[0].covariance = {1e38f, 0, 0, 1e38f, 0, 1e38f};
  gaussians[1].covariance = {};
  gaussians[2].mean = {1e30f, -1e30f, 1e30f};
  gaussians[3].mean = front_camera().eye;
  gaussians[4].color = {1e30f, -1e30f, 0};
  FitPainter painter(32, {}, 1);
  FitPixels pixels;
  painter.paint(gaussians, front_camera(), pixels);
  CHECK(pixels.size() == 32 * 32);
  std::vector<FitGradient> gradient;
  (void)painter.differentiate(gaussians, front_camera(), FitPixels(32 * 32), gradient);
  CHECK(gradient.size() == gaussians.size());
  CHECK(!gradient[3].visible);
}

TEST_CASE("pictures of the fit omit the farthest of too many large Gaussians") {
  std::vector<FitGaussian> gaussians(9000);
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    gaussians[i].mean.z = 1e-4f * static_cast<float>(i);
    gaussians[i].covariance = {100, 0, 0, 100, 0, 100};
    gaussians[i].opacity = 0.9f;
  }
  FitPainter painter(512, {}, 1);
  std::vector<FitGradient> gradient;
  (void)painter.differentiate(gaussians, front_camera(), FitPixels(512 * 512), gradient);
  const auto visible = std::ranges::count(gradient, true, &FitGradient::visible);
  CHECK(visible > 8000);
  CHECK(visible < 8300);
  CHECK(gradient.front().visible);
  CHECK(!gradient.back().visible);
}

}  // namespace gs::qnv::gaussians::fit_painter_test
