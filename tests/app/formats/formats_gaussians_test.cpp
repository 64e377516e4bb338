#include "app/formats/export/export.h"
#include "app/formats/splats/splats.h"
#include "app/formats/splats/splats_sog.h"
#include "tests/app/geometry_shapes.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app::formats_gaussians_test {
namespace {

using namespace gs::test;
using qnv::Gaussians;

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

/// Returns the splats in the order of their x coordinates, which must differ by more than the steps of the format.
Gaussians by_position(const Gaussians& g) {
  std::vector<std::size_t> order(g.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return g.positions[a].x < g.positions[b].x; });
  Gaussians sorted = g;
  const std::size_t per = qnv::harmonic_count(g.degree);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t from = order[i];
    sorted.positions[i] = g.positions[from];
    sorted.scales[i] = g.scales[from];
    sorted.rotations[i] = g.rotations[from];
    sorted.opacities[i] = g.opacities[from];
    sorted.bases[i] = g.bases[from];
    for (std::size_t k = 0; k < per; ++k) sorted.harmonics[i * per + k] = g.harmonics[from * per + k];
  }
  return sorted;
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

TEST_CASE("writes and reads Gaussians as SOG within its steps") {
  for (const int degree : {0, 1, 2, 3}) {
    Gaussians gaussians = random_gaussians(900, degree);
    gaussians.antialiased = degree == 1;
    for (std::size_t i = 0; i < gaussians.size(); ++i)
      gaussians.positions[i].x = 0.003f * static_cast<float>(i * 7 % 900) - 1.4f;
    const auto archive = export_sog(gaussians, {});
    const auto* bytes = std::get_if<std::vector<std::byte>>(&archive);
    REQUIRE(bytes);
    Diagnostics diagnostics;
    Asset asset = read_splats_sog({*bytes, "a.sog", nullptr, own_budget(), diagnostics});
    auto* const back = std::get_if<Gaussians>(&asset);
    REQUIRE(back);
    check_gaussians(*back);
    CHECK(back->antialiased == gaussians.antialiased);
    REQUIRE(back->size() == gaussians.size());
    REQUIRE(back->degree == degree);
    // SOG changes the order of the splats.
    const Gaussians sorted_back = by_position(*back), sorted = by_position(gaussians);
    const Differences most = between(sorted, sorted_back);
    INFO("degree " << degree);
    CHECK(most.position < 4e-4f);
    CHECK(most.scale < 0.1f);
    CHECK(most.rotation < 2e-4f);
    CHECK(most.opacity < 0.6f / 255);
    CHECK(most.base < 0.02f);
    CHECK(most.harmonic < 0.06f);  // each splat has its own entry of the palette
  }
}

TEST_CASE("writes flat splats as 2DGS in SOG, and the same bytes again") {
  Gaussians gaussians = random_gaussians(50, 0);
  for (glm::vec3& scale : gaussians.scales) scale.z = 0;
  const auto archive = export_sog(gaussians, {}), again = export_sog(gaussians, {});
  CHECK(written(archive) == written(again));
  Diagnostics diagnostics;
  const Bytes bytes = written(archive);
  Asset asset = read_splats_sog({bytes, "a.sog", nullptr, own_budget(), diagnostics});
  REQUIRE(std::holds_alternative<Gaussians>(asset));
  for (const glm::vec3& scale : std::get<Gaussians>(asset).scales) CHECK(scale.z == 0);
  Gaussians far = random_gaussians(50, 0);
  far.description.origin = {4e6, 0, 0};
  REQUIRE(std::holds_alternative<std::string>(export_sog(far, {})));
  CHECK(std::get<std::string>(export_sog(far, {})).find("16 bits per coordinate") != std::string::npos);
}

TEST_CASE("names what formats without opacity lose of Gaussians") {
  const qnv::Geometry geometry = random_gaussians(5, 1);
  const auto losses_of = [&](const char* path) {
    const ExportFormat* format = export_format_of(path);
    REQUIRE(format);
    return export_losses(*format, geometry);
  };
  for (const char* path : {"a.ply", "a.3dgs.ply", "a.splats.glb"}) CHECK(losses_of(path).empty());
  for (const char* path : {"a.spz", "a.v3.spz", "a.sog"}) {
    REQUIRE(losses_of(path).size() == 1);
    CHECK(losses_of(path)[0].find(" rounds splats: ") != std::string::npos);
  }
  REQUIRE(losses_of("a.points.ply").size() == 1);
  CHECK(losses_of("a.points.ply")[0] ==
        "splats become opaque surface splats, without their opacity and spherical harmonics up to degree 1; .ply, "
        ".spz, .sog and .splats.glb keep them");
  const auto plain = export_format_of("a.ply")->write(geometry, {}), whole = export_splats_ply(geometry);
  CHECK(std::get<Bytes>(plain) == std::get<Bytes>(whole));
}

TEST_CASE("reads rotations of any length, and counts splats without a rotation as broken") {
  SplatModel model;
  model.format = "test";
  const glm::vec4 rotation(0.5f, -0.5f, 0.5f, -0.5f);
  const float infinite = std::numeric_limits<float>::infinity();
  for (const float length : {1e-44f, 1e-22f, 1e-3f, 1.0f, 1e3f, 1e30f, 0.0f, infinite}) {
    model.positions.emplace_back(0);
    model.scales.emplace_back(1, 0.5f, 0.25f);
    model.rotations.push_back(rotation * length);
    model.opacities.push_back(0.5f);
    model.dc.emplace_back(0);
  }
  const Gaussians splats = vectors_of_splats(model);
  REQUIRE(splats.size() == 6);
  for (const glm::vec4& q : splats.rotations) CHECK(glm::length(q) == Approx(1));
  CHECK(splats.description.metadata.back() == std::pair<std::string, std::string>("splats broken", "2"));
}

TEST_CASE("names the loss of antialiased drawing, and the rounding of harmonics only if there are any") {
  Gaussians splats = random_gaussians(5, 1);
  splats.antialiased = true;
  const auto losses_of = [&](const char* path) {
    std::string text;
    for (const std::string& loss : export_losses(*export_format_of(path), qnv::Geometry(splats))) text += loss + "\n";
    return text;
  };
  for (const char* path : {"a.ply", "a.3dgs.ply"}) CHECK(losses_of(path).empty());
  for (const char* path : {"a.spz", "a.v3.spz", "a.sog"}) {
    CHECK(losses_of(path).find("harmonics") != std::string::npos);
    CHECK(losses_of(path).find("antialiased") == std::string::npos);
  }
  CHECK(losses_of("a.splats.glb").find("antialiased drawing (Mip-Splatting) is not kept") != std::string::npos);
  splats.degree = 0;
  splats.harmonics.clear();
  for (const char* path : {"a.spz", "a.v3.spz", "a.sog"}) {
    CHECK(losses_of(path).find(" rounds splats: ") != std::string::npos);
    CHECK(losses_of(path).find("harmonics") == std::string::npos);
  }
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
