#include "render/gaussians/gaussian_raster.h"

#include "render/gaussians/gaussian_ellipse.h"
#include "render/gaussians/gaussian_harmonics.h"
#include "render/gaussians/gaussian_order.h"
#include "render/rays/gaussian_pick.h"
#include "tests/render/gaussians/gaussian_scenes.h"
#include "tests/render/volume_scenes.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace gs::render::gaussian_raster_test {

using test::hostile_gaussians;
using test::random_gaussians;

namespace {

SplatView view_of(int width, int height) {
  SplatView view;
  view.width = width;
  view.height = height;
  view.tangents = glm::vec2(0.5f, 0.5f * static_cast<float>(height) / static_cast<float>(width));
  view.near_plane = 0.05f;
  return view;
}

glm::mat4 seen_from(const glm::vec3& eye) { return glm::lookAt(eye, glm::vec3(0), glm::vec3(0.1f, 1, 0)); }

GaussianItem item_of(const qnv::Gaussians& gaussians, const glm::mat4& camera_from_node) {
  GaussianItem item;
  item.gaussians = &gaussians;
  item.count = gaussians.size();
  item.camera_from_node = camera_from_node;
  return item;
}

/// Draws by the definition, in double precision: every splat at every pixel, without tiles or early ends. Returns RGBA.
std::vector<glm::dvec4> exact_picture(const qnv::Gaussians& g, const glm::mat4& camera_from_node, const SplatView& view,
                                      double stop = std::numeric_limits<double>::infinity()) {
  const glm::dmat4 matrix(camera_from_node);
  const glm::dmat3 linear(matrix);
  const glm::dvec3 eye = glm::inverse(linear) * -glm::dvec3(matrix[3]);
  std::vector<std::size_t> order(g.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto seen = [&](std::size_t i) { return glm::dvec3(matrix * glm::dvec4(g.positions[i], 1)); };
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return glm::length(seen(i)); });
  const double across = view.width / (2.0 * static_cast<double>(view.tangents.x)),
               up = view.height / (2.0 * static_cast<double>(view.tangents.y));
  std::vector<glm::dvec4> picture(static_cast<std::size_t>(view.width * view.height), glm::dvec4(0));
  for (const std::size_t i : order) {
    const glm::dvec3 at = seen(i);
    const double depth = -at.z;
    if (depth <= static_cast<double>(view.near_plane) || depth > stop) continue;
    const double x = std::clamp(at.x / depth, -1.3 * static_cast<double>(view.tangents.x),
                                1.3 * static_cast<double>(view.tangents.x)),
                 y = std::clamp(at.y / depth, -1.3 * static_cast<double>(view.tangents.y),
                                1.3 * static_cast<double>(view.tangents.y));
    const glm::dmat3 turn(
        glm::mat3_cast(glm::dquat(g.rotations[i].w, g.rotations[i].x, g.rotations[i].y, g.rotations[i].z)));
    const glm::dmat3 scale(glm::dvec3(g.scales[i].x, 0, 0), glm::dvec3(0, g.scales[i].y, 0),
                           glm::dvec3(0, 0, g.scales[i].z));
    const glm::dmat3 root = linear * turn * scale, sigma = root * glm::transpose(root);
    const double cx = at.x / depth * across + view.width * 0.5 - 0.5, cy = at.y / depth * up + view.height * 0.5 - 0.5;
    const bool flat = g.scales[i].z == 0;
    // The point of the plane that the ray of a pixel meets, in standard deviations.
    const glm::dmat3 rays_from_plane = glm::inverse(glm::dmat3(root[0], root[1], at));
    const auto surfel_square = [&](int column, int row) {
      const glm::dvec3 ray((column + 0.5 - view.width * 0.5) / across, (row + 0.5 - view.height * 0.5) / up, -1);
      const glm::dvec3 point = rays_from_plane * ray;  // t (u, v, 1)
      const double square = (point.x * point.x + point.y * point.y) / (point.z * point.z);
      const double screen = 2 * ((column - cx) * (column - cx) + (row - cy) * (row - cy));
      return point.z > 0 ? std::min(square, screen) : screen;
    };
    const glm::dvec3 u(across / depth, 0, across / depth * x), v(0, up / depth, up / depth * y);
    double xx = glm::dot(u, sigma * u), xy = glm::dot(u, sigma * v), yy = glm::dot(v, sigma * v);
    const double sharp = xx * yy - xy * xy;
    xx += 0.3;
    yy += 0.3;
    const double determinant = xx * yy - xy * xy;
    double opacity = static_cast<double>(g.opacities[i]);
    if (g.antialiased) opacity *= std::sqrt(std::max(sharp, 0.0) / determinant);
    const glm::vec3 direction(glm::normalize(glm::dvec3(g.positions[i]) - eye));
    const std::size_t per = qnv::harmonic_count(g.degree);
    const glm::dvec3 color(
        gaussian_color(g.bases[i], per == 0 ? nullptr : g.harmonics.data() + i * per, g.degree, direction));
    for (int row = 0; row < view.height; ++row)
      for (int column = 0; column < view.width; ++column) {
        const double dx = column - cx, dy = row - cy;
        const double square =
            flat ? surfel_square(column, row) : (yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / determinant;
        const double alpha = std::min(0.99, opacity * std::exp(-0.5 * square));
        if (alpha < 1.0 / 255) continue;
        glm::dvec4& pixel = picture[static_cast<std::size_t>(row * view.width + column)];
        const double part = (1 - pixel.w) * alpha;
        pixel += glm::dvec4(color * part, part);
      }
  }
  return picture;
}

double decibels(const VolumeLayer& layer, const std::vector<glm::dvec4>& exact) {
  REQUIRE(layer.pixels.size() == 4 * exact.size());
  test::Psnr psnr;
  for (std::size_t i = 0; i < exact.size(); ++i)
    for (int c = 0; c < 4; ++c)
      psnr.add(layer.pixels[4 * i + static_cast<std::size_t>(c)] / 255.0, std::clamp(exact[i][c], 0.0, 1.0));
  return psnr.decibels();
}

}  // namespace

TEST_CASE("draws Gaussians as EWA splatting defines, from any direction") {
  const SplatView view = view_of(93, 70);
  for (const int degree : {0, 1, 3})
    for (const glm::vec3& eye :
         {glm::vec3(0, 0, 3), glm::vec3(2, 1, -1), glm::vec3(0.3f, 0.2f, 0.4f), glm::vec3(0, 9, 1)}) {
      const qnv::Gaussians gaussians = random_gaussians(400, degree, 7);
      const glm::mat4 matrix = seen_from(eye);
      const GaussianItem item = item_of(gaussians, matrix);
      const double agreement = decibels(rasterize_gaussians({&item, 1}, view), exact_picture(gaussians, matrix, view));
      INFO("degree " << degree << " from " << eye.x << ' ' << eye.y << ' ' << eye.z << ": " << agreement);
      CHECK(agreement > 50);
    }
}

TEST_CASE("draws flat Gaussians where the rays of the pixels meet them, also from the edge and under any matrix") {
  const SplatView view = view_of(93, 70);
  qnv::Gaussians gaussians = random_gaussians(300, 1, 19);
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    gaussians.scales[i].z = 0;
    if (i % 3 == 0) gaussians.scales[i] *= 3.0f;
    if (i % 4 == 0) gaussians.rotations[i] = {0, 0, 0, 1};  // in a plane with some of the eyes
  }
  glm::mat4 skewed = glm::scale(seen_from({0, 0, 4}), glm::vec3(1.5f, 0.6f, -1));
  skewed = glm::rotate(skewed, 1.0f, glm::vec3(1, 2, 3));
  for (const glm::mat4& matrix : {seen_from({0, 0, 6}), seen_from({4, 2, -3}), seen_from({5, 0, 0}), skewed}) {
    const GaussianItem item = item_of(gaussians, matrix);
    // EWA would draw surfels that reach the plane of the eye, but none of those are in view.
    ProjectedGaussians all;
    project_gaussians(item, view, 0, gaussians.size(), all);
    REQUIRE(all.splats.size() > 100);
    CHECK(all.surfels.size() == all.splats.size());
    const double agreement = decibels(rasterize_gaussians({&item, 1}, view), exact_picture(gaussians, matrix, view));
    INFO(agreement);
    CHECK(agreement > 45);
  }
}

TEST_CASE("draws a large flat Gaussian in perspective") {
  // EWA would draw a strip along the ground with equal widths of its near and its far part. Rays draw the near
  // part wider.
  qnv::Gaussians gaussians = random_gaussians(1, 0, 1);
  gaussians.positions = {{0, -1, -4}};
  gaussians.scales = {{0.5f, 1, 0}};
  gaussians.rotations = {{-std::sqrt(0.5f), 0, 0, std::sqrt(0.5f)}};  // its normal is the y axis
  gaussians.opacities = {0.9f};
  SplatView view = view_of(101, 101);
  view.tangents = glm::vec2(0.8f);
  const GaussianItem item = item_of(gaussians, glm::mat4(1));
  const VolumeLayer layer = rasterize_gaussians({&item, 1}, view);
  CHECK(decibels(layer, exact_picture(gaussians, glm::mat4(1), view)) > 50);
  const auto width_of = [&](int row) {
    int width = 0;
    for (int x = 0; x < 101; ++x) width += layer.pixels[4 * static_cast<std::size_t>(row * 101 + x) + 3] > 20 ? 1 : 0;
    return width;
  };
  CHECK(width_of(20) > 2 * width_of(40));
}

TEST_CASE("draws antialiased Gaussians with the energy of narrow ones") {
  qnv::Gaussians gaussians = random_gaussians(300, 0, 3);
  for (glm::vec3& scale : gaussians.scales) scale *= 0.05f;
  gaussians.antialiased = true;
  const SplatView view = view_of(64, 64);
  const glm::mat4 matrix = seen_from({0, 0, 3});
  const GaussianItem item = item_of(gaussians, matrix);
  CHECK(decibels(rasterize_gaussians({&item, 1}, view), exact_picture(gaussians, matrix, view)) > 50);
}

TEST_CASE("draws Gaussians under any affine matrix") {
  const qnv::Gaussians gaussians = random_gaussians(200, 2, 5);
  glm::mat4 matrix = glm::scale(seen_from({0, 0, 3}), glm::vec3(1.5f, 0.6f, -1));
  matrix = glm::rotate(matrix, 1.0f, glm::vec3(1, 2, 3));
  const SplatView view = view_of(64, 48);
  const GaussianItem item = item_of(gaussians, matrix);
  CHECK(decibels(rasterize_gaussians({&item, 1}, view), exact_picture(gaussians, matrix, view)) > 50);
}

TEST_CASE("hides Gaussians behind the existing image, per sample") {
  const qnv::Gaussians gaussians = random_gaussians(300, 0, 11);
  const SplatView view = view_of(60, 45);
  const glm::mat4 matrix = seen_from({0, 0, 3});
  const GaussianItem item = item_of(gaussians, matrix);
  const std::vector<float> near(60 * 45, 2.7f), far(60 * 45, 3.1f);
  const VolumeLayer layer = rasterize_gaussians({&item, 1}, view, {near, far});
  VolumeLayer edges;
  edges.pixels = layer.edge_pixels;
  CHECK(decibels(layer, exact_picture(gaussians, matrix, view, 3.1)) > 50);
  CHECK(decibels(edges, exact_picture(gaussians, matrix, view, 2.7)) > 50);
  CHECK(rasterize_gaussians({&item, 1}, view, {near, {}}).pixels == layer.edge_pixels);
  CHECK(rasterize_gaussians({&item, 1}, view, {near, near}).edge_pixels.empty());
}

TEST_CASE("draws equal Gaussians without their depths, and reports the box of their pixels") {
  qnv::Gaussians gaussians = random_gaussians(3000, 0, 17);
  for (std::size_t i = 0; i < gaussians.size(); i += 7) gaussians.scales[i].z = 0;
  const SplatView view = view_of(200, 150);
  const GaussianItem item = item_of(gaussians, seen_from({0, 1, 12}));
  const std::vector<float> near(200 * 150, 11.8f), far(200 * 150, 12.1f);
  for (const VolumeStops& stops : {VolumeStops{}, VolumeStops{near, {}}, VolumeStops{near, far}}) {
    const VolumeLayer whole = rasterize_gaussians({&item, 1}, view, stops),
                      layer = rasterize_gaussians({&item, 1}, view, stops, false);
    CHECK(layer.depth.empty());
    CHECK(layer.pixels == whole.pixels);
    CHECK(layer.edge_pixels == whole.edge_pixels);
    const PixelBox box = layer.used;
    CHECK(box.width < 150);
    CHECK(box.height < 150);
    std::size_t inside = 0, all = 0;
    for (int y = 0; y < 150; ++y)
      for (int x = 0; x < 200; ++x) {
        const bool is_used = layer.pixels[4 * static_cast<std::size_t>(200 * y + x) + 3] != 0;
        all += is_used ? 1 : 0;
        inside += is_used && x >= box.left && x < box.left + box.width && y >= box.bottom && y < box.bottom + box.height
                      ? 1
                      : 0;
      }
    CHECK(all > 1000);
    CHECK(inside == all);
  }
}

TEST_CASE("draws equal Gaussians with any number of threads and all kernels") {
  qnv::Gaussians gaussians = random_gaussians(30000, 0, 13);
  for (std::size_t i = 0; i < gaussians.size(); i += 3) gaussians.scales[i].z = 0;
  SplatView view = view_of(200, 150);
  const GaussianItem item = item_of(gaussians, seen_from({0, 0, 2}));
  view.threads = 1;
  const VolumeLayer one = rasterize_gaussians({&item, 1}, view);
  view.threads = 5;
  const VolumeLayer five = rasterize_gaussians({&item, 1}, view);
  CHECK(one.pixels == five.pixels);
  CHECK(one.depth == five.depth);
  // Draws another picture in between, which reuses the arrays.
  const SplatView other = view_of(90, 70);
  (void)rasterize_gaussians({&item, 1}, other);
  CHECK(rasterize_gaussians({&item, 1}, view).pixels == one.pixels);
  ProjectedGaussians all;
  project_gaussians(item, view, 0, gaussians.size(), all);
  REQUIRE(all.splats.size() > 10000);
  REQUIRE(all.distances.size() == all.splats.size());
  CHECK(all.surfels.size() > 1000);
  std::vector<std::uint16_t> order(2000);
  std::iota(order.begin(), order.end(), std::uint16_t{0});
  for (const GaussianKernel& quick : gaussian_kernels())
    for (const bool stopped : {false, true}) {
      GaussianTile fast, plain;
      for (GaussianTile* tile : {&fast, &plain}) {
        tile->clear_pixels();
        for (GaussianBlock& block : tile->blocks) std::ranges::fill(block.channel(GaussianBlock::kStop), 2.0f);
      }
      const GaussianKernel& portable = gaussian_kernels().front();
      (stopped ? quick.stopped_tile : quick.tile)({all.splats.data(), all.surfels.data()}, order, 96, 64, fast);
      (stopped ? portable.stopped_tile : portable.tile)({all.splats.data(), all.surfels.data()}, order, 96, 64, plain);
      float least = 1;
      for (std::size_t i = 0; i < GaussianTile::kBlocks; ++i) {
        CHECK(fast.blocks[i].values == plain.blocks[i].values);
        least = std::min(least, std::ranges::min(fast.blocks[i].channel(GaussianBlock::kClear)));
      }
      CHECK(least < 1);
      CHECK(fast.open == plain.open);
      constexpr std::size_t kPixels = std::size_t{kGaussianTile} * kGaussianTile;
      std::array<std::array<std::uint8_t, 4 * kPixels>, 2> pixels{};
      std::array<std::array<float, kPixels>, 2> depths{};
      quick.write(fast, pixels[0].data(), depths[0].data(), kGaussianTile);
      portable.write(plain, pixels[1].data(), depths[1].data(), kGaussianTile);
      CHECK(pixels[0] == pixels[1]);
      CHECK(depths[0] == depths[1]);
      const GaussianBlock& block = fast.blocks[GaussianTile::block_of(13, 6)];
      const std::size_t lane = GaussianTile::lane_of(13, 6), at = 6 * 16 + 13;
      CHECK(pixels[0][4 * at + 3] == Approx(255 * (1 - block.channel(GaussianBlock::kClear)[lane])).margin(0.51));
      CHECK(pixels[0][4 * at + 1] == Approx(255 * block.channel(GaussianBlock::kGreen)[lane]).margin(0.51));
    }
}

TEST_CASE("projects equal ellipses with both kernels, also of hostile Gaussians") {
  GaussianLens lens{};
  const glm::mat4 matrix = seen_from({1, 2, 3});
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row)
      lens.camera_from_node[static_cast<std::size_t>(column)][static_cast<std::size_t>(row)] = matrix[column][row];
  lens.pixels_x = lens.pixels_y = 100;
  lens.middle_x = lens.middle_y = 50;
  lens.left = lens.bottom = -0.6f;
  lens.right = lens.top = 0.6f;
  lens.last_x = lens.last_y = 99;
  std::mt19937 random(9);
  std::normal_distribution<float> normal;
  const std::array<float, 6> odd{
      0, -1, 1e30f, -1e30f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()};
  int visible = 0;
  for (int round = 0; round < 500; ++round) {
    lens.antialiased = round % 2 == 0;
    EightGaussians fast{};
    for (auto* numbers :
         {&fast.position_x, &fast.position_y, &fast.position_z, &fast.scale_x, &fast.scale_y, &fast.scale_z,
          &fast.rotation_x, &fast.rotation_y, &fast.rotation_z, &fast.rotation_w, &fast.opacity})
      for (float& number : *numbers) number = random() % 100 == 0 ? odd[random() % odd.size()] : 0.3f * normal(random);
    EightGaussians plain = fast;
    gaussian_ellipses()(lens, fast);
    gaussian_ellipses_baseline()(lens, plain);
    REQUIRE(fast.placed == plain.placed);
    REQUIRE(fast.visible == plain.visible);
    for (std::size_t k = 0; k < EightGaussians::kLanes; ++k) {
      if ((fast.visible >> k & 1) == 0) continue;
      ++visible;
      for (const auto numbers : {&EightGaussians::seen_x, &EightGaussians::distance, &EightGaussians::x,
                                 &EightGaussians::xx, &EightGaussians::xy, &EightGaussians::yy, &EightGaussians::peak,
                                 &EightGaussians::left, &EightGaussians::top}) {
        CHECK(std::isfinite((fast.*numbers)[k]));
        CHECK((fast.*numbers)[k] == (plain.*numbers)[k]);
      }
      CHECK(fast.peak[k] == Approx(std::log2(std::min(fast.opacity[k], 1.0f))).margin(lens.antialiased ? 9 : 1e-5));
    }
  }
  CHECK(visible > 300);
}

TEST_CASE("sorts Gaussians stably with any number of threads") {
  std::mt19937 random(3);
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{100}, std::size_t{70000}})
    for (const std::uint32_t span : {1u, 50u, 1u << 20, 0xFFFFFFFFu}) {
      std::vector<GaussianKey> keys;
      for (std::size_t i = 0; i < count; ++i)
        keys.push_back({static_cast<std::uint32_t>(random()) % span, static_cast<std::uint32_t>(i)});
      std::vector<GaussianKey> one = keys, four = keys, other;
      sort_gaussians(one, other, 1);
      sort_gaussians(four, other, 4);
      std::ranges::stable_sort(keys, {}, &GaussianKey::key);
      const auto equal = [](const GaussianKey& a, const GaussianKey& b) {
        return a.key == b.key && a.index == b.index;
      };
      CHECK(std::ranges::equal(one, keys, equal));
      CHECK(std::ranges::equal(four, keys, equal));
    }
}

TEST_CASE("draws Gaussians that fill the view in several batches") {
  // 20,000 splats in 300 regions exceed the entries of a batch; the near ones are faint.
  qnv::Gaussians gaussians = random_gaussians(20000, 0, 21);
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    gaussians.positions[i].z *= 0.1f;
    gaussians.scales[i] = glm::vec3(2);
    gaussians.opacities[i] = i % 2 == 0 ? 0.005f : 0.0045f;
    gaussians.bases[i] = glm::vec3(0.5f);
  }
  SplatView view = view_of(1280, 960);
  const GaussianItem item = item_of(gaussians, glm::lookAt(glm::vec3(0, 0, 3), glm::vec3(0), glm::vec3(0, 1, 0)));
  const VolumeLayer layer = rasterize_gaussians({&item, 1}, view);
  REQUIRE(layer.vectors == gaussians.size());
  // Without splats fainter than 1/255, the pixels have at most 1 - (1 - 0.005)^10000 (1 - 0.0045)^10000 of the light.
  const std::size_t middle = 480 * 1280 + 640;
  CHECK(layer.pixels[4 * middle + 3] == 255);
  CHECK(layer.pixels[4 * middle] == Approx(127).margin(1.5));
  CHECK(layer.depth[middle] > 2.5f);
}

TEST_CASE("keeps the order of Gaussians while the view turns") {
  const qnv::Gaussians gaussians = random_gaussians(500, 0, 17);
  const SplatView view = view_of(64, 64);
  const auto order_of = [&](float angle) {
    ProjectedGaussians all;
    const GaussianItem item =
        item_of(gaussians, glm::rotate(glm::mat4(1), angle, glm::vec3(0, 1, 0)) * seen_from({0, 0, 9}));
    project_gaussians(item, view, 0, gaussians.size(), all);
    REQUIRE(all.distances.size() > 450);
    return all.distances;
  };
  const std::vector<float> straight = order_of(0), turned = order_of(0.2f);
  REQUIRE(straight.size() == turned.size());
  for (std::size_t i = 0; i < straight.size(); ++i) CHECK(straight[i] == Approx(turned[i]).epsilon(1e-5));
}

TEST_CASE("clips, fades and fogs Gaussians") {
  qnv::Gaussians gaussians = random_gaussians(2, 0, 1);
  gaussians.positions = {{-0.5f, 0, 0}, {0.5f, 0, 0}};
  gaussians.scales = {glm::vec3(0.1f), glm::vec3(0.1f)};
  gaussians.opacities = {0.8f, 0.8f};
  gaussians.bases = {{1, 1, 1}, {1, 1, 1}};
  const SplatView view = view_of(64, 48);
  GaussianItem item = item_of(gaussians, glm::lookAt(glm::vec3(0, 0, 3), glm::vec3(0), glm::vec3(0, 1, 0)));
  const auto alpha_at = [&](int x) {
    return rasterize_gaussians({&item, 1}, view).pixels[4 * (24 * 64 + static_cast<std::size_t>(x)) + 3];
  };
  const int left = 32 - 11, right = 32 + 10;
  CHECK(alpha_at(left) > 190);
  CHECK(alpha_at(right) > 190);
  item.clip = glm::vec4(1, 0, 0, 0);
  CHECK(alpha_at(left) == 0);
  CHECK(alpha_at(right) > 190);
  item.clip.reset();
  item.opacity = 0.5f;
  CHECK(alpha_at(right) == Approx(0.4 * 255).margin(6));
  item.opacity = 1;
  item.fog.on = true;
  item.fog.color = {1, 0, 0};
  item.fog.ranges_from_camera = glm::mat3(1);
  const VolumeLayer layer = rasterize_gaussians({&item, 1}, view);
  const std::size_t at = 4 * (24 * 64 + static_cast<std::size_t>(right));
  CHECK(layer.pixels[at] > 150);
  CHECK(layer.pixels[at + 1] == 0);
}

TEST_CASE("records the depth at which half of the light is absorbed, as picking does") {
  qnv::Gaussians gaussians = random_gaussians(2, 0, 1);
  gaussians.positions = {{0, 0, 0.5f}, {0, 0, -0.5f}};
  gaussians.scales = {glm::vec3(0.3f), glm::vec3(0.3f)};
  gaussians.rotations = {{0, 0, 0, 1}, {0, 0, 0, 1}};
  gaussians.opacities = {0.4f, 0.4f};
  const SplatView view = view_of(33, 33);
  const GaussianItem item = item_of(gaussians, glm::lookAt(glm::vec3(0, 0, 3), glm::vec3(0), glm::vec3(0, 1, 0)));
  CHECK(rasterize_gaussians({&item, 1}, view).depth[16 * 33 + 16] == Approx(3.5f));
  PickRay ray;
  ray.origin = {0, 0, 3};
  const auto far = pick_gaussians(gaussians, glm::dmat4(1), ray);
  REQUIRE(far);
  CHECK(far->distance == Approx(3.5f));
  gaussians.opacities[0] = 0.9f;
  CHECK(rasterize_gaussians({&item, 1}, view).depth[16 * 33 + 16] == Approx(2.5f));
  CHECK(pick_gaussians(gaussians, glm::dmat4(1), ray)->distance == Approx(2.5f));
  gaussians.opacities = {0.2f, 0.2f};
  CHECK(rasterize_gaussians({&item, 1}, view).depth[16 * 33 + 16] == 0);
  CHECK(!pick_gaussians(gaussians, glm::dmat4(1), ray));
  ray.origin = {0, 0, -3};
  gaussians.opacities = {0.9f, 0.9f};
  CHECK(!pick_gaussians(gaussians, glm::dmat4(1), ray));
}

TEST_CASE("draws the finite ones of hostile Gaussians") {
  const qnv::Gaussians gaussians = hostile_gaussians();
  const SplatView view = view_of(40, 30);
  const GaussianItem item = item_of(gaussians, seen_from({0, 0, 3}));
  const VolumeLayer layer = rasterize_gaussians({&item, 1}, view);
  CHECK(layer.vectors >= 2);
  CHECK(layer.vectors <= 8);
  for (const float depth : layer.depth) CHECK(std::isfinite(depth));
  PickRay ray;
  ray.origin = {0, 0, 3};
  (void)pick_gaussians(gaussians, glm::dmat4(1), ray);
  GaussianItem flat = item;
  flat.camera_from_node[0] = glm::vec4(0);
  CHECK(rasterize_gaussians({&flat, 1}, view).empty());
  CHECK(rasterize_gaussians({}, view).empty());
  GaussianItem none;
  CHECK(rasterize_gaussians({&none, 1}, view).empty());
}

TEST_CASE("evaluates the spherical harmonics of all degrees with orthonormal functions") {
  // The integral of a product of two of the 16 functions over the sphere is 1 if they are equal, else 0.
  constexpr int kSteps = 128;
  std::array<std::array<double, 16>, 16> sums{};
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < 2 * kSteps; ++j) {
      const double z = -1 + (2 * i + 1.0) / kSteps, turn = (j + 0.5) * 3.14159265358979 / kSteps;
      const glm::vec3 d(static_cast<float>(std::sqrt(1 - z * z) * std::cos(turn)),
                        static_cast<float>(std::sqrt(1 - z * z) * std::sin(turn)), static_cast<float>(z));
      std::array<double, 16> values{0.28209479177387814};
      for (std::size_t k = 0; k < 15; ++k) {
        std::array<glm::vec3, 15> one{};
        one[k] = glm::vec3(1);
        values[k + 1] = static_cast<double>(gaussian_color(glm::vec3(10), one.data(), 3, d).x) - 10;
      }
      const double area = 4 * 3.14159265358979 / (2.0 * kSteps * kSteps);
      for (std::size_t a = 0; a < 16; ++a)
        for (std::size_t b = 0; b < 16; ++b) sums[a][b] += values[a] * values[b] * area;
    }
  for (std::size_t a = 0; a < 16; ++a)
    for (std::size_t b = 0; b < 16; ++b) CHECK(sums[a][b] == Approx(a == b ? 1 : 0).margin(0.002));
}

}  // namespace gs::render::gaussian_raster_test
