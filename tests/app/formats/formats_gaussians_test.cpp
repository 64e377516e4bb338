#include "app/formats/export/export.h"
#include "app/formats/splats/splats.h"
#include "tests/app/geometry_shapes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

namespace gs::app::formats_gaussians_test {
namespace {

using namespace gs::test;
using qnv::Gaussians;

Gaussians random_gaussians(std::size_t count, int degree) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> even(0.02f, 0.98f);
  SplatModel model;
  model.format = "test";
  model.axes = kFromRightUpBack;
  model.set_degree(degree);
  model.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    model.positions[i] = glm::dvec3(normal(random), normal(random), normal(random));
    model.scales[i] = {even(random), even(random), even(random)};
    model.rotations[i] = {normal(random), normal(random), normal(random), normal(random)};
    model.opacities[i] = even(random);
    model.dc[i] = (glm::vec3(even(random), even(random), even(random)) - 0.5f) * 4.0f;
    for (std::size_t k = 0; k < qnv::harmonic_count(degree); ++k)
      model.coefficient(i, k) = glm::vec3(normal(random), normal(random), normal(random)) * 0.2f;
  }
  return vectors_of_splats(model);
}

Bytes written(const Exported& exported) {
  const auto* bytes = std::get_if<std::vector<std::byte>>(&exported);
  REQUIRE(bytes);
  return {bytes->begin(), bytes->end()};
}

/// Largest differences between Gaussians in the same order.
struct Differences {
  float position = 0, scale = 0, rotation = 0, opacity = 0, base = 0, harmonic = 0;  // scale: of the logarithm
};

Differences between(const Gaussians& a, const Gaussians& b) {
  REQUIRE(a.size() == b.size());
  REQUIRE(a.degree == b.degree);
  REQUIRE(a.harmonics.size() == b.harmonics.size());
  Differences most;
  const auto note = [](float& to, float difference) { to = std::max(to, std::abs(difference)); };
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      note(most.position, a.positions[i][k] - b.positions[i][k]);
      note(most.scale, std::log(a.scales[i][k] / b.scales[i][k]));
      note(most.base, a.bases[i][k] - b.bases[i][k]);
    }
    note(most.opacity, a.opacities[i] - b.opacities[i]);
    const glm::vec4 &p = a.rotations[i], &q = b.rotations[i];
    note(most.rotation, 1 - std::abs(p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w));
  }
  for (std::size_t i = 0; i < a.harmonics.size(); ++i)
    for (int k = 0; k < 3; ++k) note(most.harmonic, a.harmonics[i][k] - b.harmonics[i][k]);
  return most;
}

}  // namespace

TEST_CASE("writes and reads Gaussians as PLY without losses, of every degree") {
  for (const int degree : {0, 1, 2, 3}) {
    Gaussians gaussians = random_gaussians(200, degree);
    gaussians.antialiased = degree == 2;
    const Bytes bytes = written(export_splats_ply(gaussians, {}));
    const Gaussians back = gaussians_of(import_splats_ply, bytes);
    CHECK(back.antialiased == gaussians.antialiased);
    const Differences most = between(gaussians, back);
    INFO("degree " << degree);
    CHECK(most.position == 0);
    CHECK(most.scale < 1e-6f);
    CHECK(most.rotation < 1e-6f);
    CHECK(most.opacity < 1e-6f);
    CHECK(most.base < 1e-6f);
    CHECK(most.harmonic == 0);
    // A second round changes nothing more than the last digits.
    CHECK(written(export_splats_ply(back, {})).size() == bytes.size());
  }
}

TEST_CASE("writes and reads Gaussians as SPZ within its steps") {
  for (const auto write : {export_spz, export_spz3})
    for (const int degree : {0, 1, 3}) {
      const Gaussians gaussians = random_gaussians(150, degree);
      const Gaussians back = gaussians_of(import_splats_spz, written(write(gaussians, {})));
      const Differences most = between(gaussians, back);
      INFO("degree " << degree);
      CHECK(most.position < 1e-5f);
      CHECK(most.scale < 1.01f / 32);
      CHECK(most.rotation < 1e-4f);
      CHECK(most.opacity < 0.6f / 255);
      CHECK(most.base < 0.005f);
      CHECK(most.harmonic < 0.6f / 128);
    }
}

TEST_CASE("names what formats without opacity lose of Gaussians") {
  const qnv::Geometry geometry = random_gaussians(5, 1);
  const auto losses_of = [&](const char* path) {
    const ExportFormat* format = export_format_of(path);
    REQUIRE(format);
    return export_losses(*format, geometry);
  };
  for (const char* path : {"a.3dgs.ply", "a.spz", "a.v3.spz", "a.splats.glb"}) CHECK(losses_of(path).empty());
  REQUIRE(losses_of("a.ply").size() == 1);
  CHECK(losses_of("a.ply")[0] ==
        "splats become opaque surface splats, without their opacity and spherical harmonics up to degree 1; .3dgs.ply, "
        ".spz and .splats.glb keep everything");
}

TEST_CASE("reads the harmonics of a compressed PLY file in its steps") {
  // Red has 0, 255 and 127; green 128, 64 and 192; blue 1, 2 and 3.
  const Bytes bytes = compressed_ply(0x80808080u, {0, 255, 127, 128, 64, 192, 1, 2, 3});
  const Gaussians read = gaussians_of(import_splats_compressed_ply, bytes);
  REQUIRE(read.degree == 1);
  REQUIRE(read.harmonics.size() == 3);
  const auto value = [](int u) {
    return u == 0 ? -4.0f : u == 255 ? 4.0f : ((static_cast<float>(u) + 0.5f) / 256 - 0.5f) * 8;
  };
  // The axes right, down, forward become right, up, back: the coefficients of y and z change their signs.
  CHECK(read.harmonics[0].x == Approx(-value(0)));
  CHECK(read.harmonics[1].x == Approx(-value(255)));
  CHECK(read.harmonics[2].x == Approx(value(127)));
  CHECK(read.harmonics[0].y == Approx(-value(128)));
  CHECK(read.harmonics[2].y == Approx(value(192)));
  CHECK(read.harmonics[1].z == Approx(-value(2)));
  check_hostile(import_splats_compressed_ply, bytes);
}

}  // namespace gs::app::formats_gaussians_test
