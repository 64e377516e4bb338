#include "render/volume/volume_model.h"

#include "render/scene/color_ramps.h"
#include "tests/render/geometry_shapes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

using namespace gs;
using namespace gs::test;
using namespace gs::render;

TEST_CASE("counts the spacing of a prefix at powers of the square root of two") {
  CHECK(volume_prefix(1000, 0) == VolumePrefix{1000, 1000});
  CHECK(volume_prefix(1000, 1000) == VolumePrefix{1000, 1000});
  CHECK(volume_prefix(1000, 5000) == VolumePrefix{1000, 1000});
  CHECK(volume_prefix(1000, 999) == VolumePrefix{999, 724});
  CHECK(volume_prefix(1000, 724) == VolumePrefix{724, 724});
  CHECK(volume_prefix(1000, 723) == VolumePrefix{723, 512});
  CHECK(volume_prefix(1000, 1) == VolumePrefix{1, 1});
  CHECK(volume_prefix(0, 0) == VolumePrefix{0, 0});
  CHECK(volume_prefix(0, 7) == VolumePrefix{0, 0});
  // Every model has spacings for all its prefixes.
  const qnv::Volume geometry = random_volume(300, 1, 0.1f);
  for (std::size_t budget = 1; budget <= 300; ++budget) {
    const VolumePrefix prefix = volume_prefix(300, budget);
    REQUIRE(prefix.counted <= prefix.shown);
    REQUIRE(prefix.counted * 3 >= prefix.shown * 2 - 1);
    REQUIRE(volume_model(geometry, 1, prefix.counted).spacing.size() >= prefix.shown);
  }
}

TEST_CASE("gives a prefix the spacing of a volume that ends there") {
  const qnv::Volume geometry = random_volume(4000, 2, 0.02f);
  const VolumeModel all = volume_model(geometry), some = volume_model(geometry, 0, 512);
  CHECK(all.spacing.size() == 4000);
  CHECK(some.spacing.size() == 724);
  double sum_all = 0, sum_some = 0;
  for (std::size_t k = 0; k < some.spacing.size(); ++k) {
    sum_all += static_cast<double>(all.spacing[k]);
    sum_some += static_cast<double>(some.spacing[k]);
  }
  // With an eighth of the vectors, the spacing doubles in a solid, and nearly triples at a boundary.
  CHECK(sum_some / sum_all > 1.8);
  CHECK(sum_some / sum_all < 3);
  CHECK(some.full_magnitude == all.full_magnitude);
  CHECK(some.transfer == all.transfer);
  for (const unsigned threads : {1u, 3u}) CHECK(volume_model(geometry, threads, 512).spacing == some.spacing);
}

TEST_CASE("limits a vector to its octree cell, except in a prefix") {
  qnv::Volume geometry = random_volume(4000, 2, 0.02f);
  const VolumeModel free = volume_model(geometry), some = volume_model(geometry, 0, 512);
  geometry.cells.assign(geometry.size(), {});  // each is a voxel of the lattice
  CHECK(volume_model(geometry).spacing == free.spacing);
  const float most = *std::max_element(free.spacing.begin(), free.spacing.end());
  for (std::size_t k = 0; k < geometry.size(); k += 2) geometry.cells[k].edge = most * 0.4f;
  for (std::size_t k = 1; k < geometry.size(); k += 4) geometry.cells[k].edge = 1e-6f;
  const VolumeModel bounded = volume_model(geometry);
  for (std::size_t k = 0; k < geometry.size(); ++k) {
    // The spacing is never less than the voxel spacing.
    const float edge = std::max(geometry.cells[k].edge, geometry.description.spacing);
    REQUIRE(bounded.spacing[k] == (geometry.cells[k].edge > 0 ? std::min(free.spacing[k], edge) : free.spacing[k]));
  }
  CHECK(volume_model(geometry, 0, 512).spacing == some.spacing);
}

TEST_CASE("interpolates a transfer function linearly, and converts its opacity to depth") {
  qnv::Description about;
  about.transfer = {{0, {0, 0, 0}, 0}, {1, {255, 255, 255}, 0.5f}};
  const VolumeTransfer own = volume_transfer(about);
  CHECK(own[0].w == 0);
  CHECK(own[255].w == Approx(-std::log(0.5)));
  CHECK(own[51].x == Approx(0.2));
  CHECK(own[51].w == Approx(-std::log(0.9)));
  const std::array<qnv::TransferPoint, 1> red{{{0.5f, {255, 0, 0}, 1}}};
  const VolumeTransfer other = volume_transfer(about, red);
  for (const glm::vec4& entry : other) {
    CHECK(glm::vec3(entry) == glm::vec3(1, 0, 0));
    CHECK(entry.w == Approx(-std::log(0.001)));
  }
  about.transfer.clear();
  CHECK(volume_transfer(about)[255].w > 0);  // default_transfer()
  for (const float bad : {kNaN, kInfinity, -kInfinity, 1e38f, -3.0f}) {
    const std::array<qnv::TransferPoint, 3> hostile{
        {{bad, {1, 2, 3}, bad}, {0.5f, {9, 9, 9}, 0.5f}, {bad, {4, 5, 6}, bad}}};
    for (const glm::vec4& entry : volume_transfer(about, hostile)) CHECK(entry.w >= 0);
  }
}

TEST_CASE("replaces the model's transfer function by that of the options, for colour and opacity") {
  const qnv::Volume geometry = random_volume(100, 3, 0.1f);
  const VolumeModel model = volume_model(geometry);
  const std::array<qnv::TransferPoint, 1> green{{{0, {0, 255, 0}, 0.5f}}};
  const VolumeTransfer transfer = volume_transfer(geometry.description, green);
  VolumeOptions options;
  options.opacity = 1;
  options.transfer = &transfer;
  for (std::size_t k = 0; k < geometry.size(); ++k) {
    CHECK(volume_color(geometry, model, options, k) == glm::vec3(0, 1, 0));
    const double magnitude = std::min(static_cast<double>(geometry.weights[k] / model.full_magnitude), 1.0);
    CHECK(static_cast<double>(volume_alpha(geometry, model, options, k)) ==
          Approx(magnitude * -std::log(0.5) / (3.14159265 * static_cast<double>(kVolumeFootprint))).epsilon(1e-4));
  }
}

TEST_CASE("makes colours that distinguish the vectors of a volume") {
  qnv::Volume geometry = random_volume(9000, 3, 0.1f);
  geometry.normals[1] = {0, -2, 0};
  geometry.normals[2] = glm::vec3(kNaN);
  CHECK(volume_color_by(geometry, ColorBy::normal, 1) == glm::vec3(0.5f, 0, 0.5f));
  CHECK(volume_color_by(geometry, ColorBy::normal, 2) == glm::vec3(0.5f));
  const glm::vec3 blue(0, 0, 1), red(1, 0, 0);
  CHECK(volume_color_by(geometry, ColorBy::age, 0) == blue);
  CHECK(volume_color_by(geometry, ColorBy::age, 8999) == red);
  CHECK(volume_color_by(geometry, ColorBy::level, 0) == blue);
  CHECK(volume_color_by(geometry, ColorBy::level, kFirstOctave - 1) == blue);
  CHECK(volume_color_by(geometry, ColorBy::level, 8999) == red);
  CHECK(volume_color_by(geometry, ColorBy::chunk, 0) == volume_color_by(geometry, ColorBy::chunk, kBlockVectors - 1));
  CHECK(volume_color_by(geometry, ColorBy::chunk, 0) != volume_color_by(geometry, ColorBy::chunk, kBlockVectors));
  VolumeOptions options;
  options.color = glm::vec3(0.3f);
  options.color_by = ColorBy::age;
  CHECK(volume_color(geometry, volume_model(geometry), options, 8999) == red);
}
