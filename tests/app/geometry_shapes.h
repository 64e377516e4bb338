#pragma once

#include "app/formats/splats/splats.h"

#include "tests/app/formats_helpers.h"
#include "tests/watched.h"

#include <numbers>
#include <random>

/// Helpers of tests of imported vectors.
namespace gs::test {

using gs::qnv::Splats;
using ImportVectors = gs::app::ImportedVectors (*)(std::span<const std::byte>, const WorldBudget&);

inline float dot(const glm::vec3& a, const glm::vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline float length(const glm::vec3& v) { return std::sqrt(dot(v, v)); }

/// Returns points spread evenly over a sphere, with outward normals, areas that sum to its area, and colours.
inline Splats sphere(std::size_t count, float radius = 1, glm::vec3 center = glm::vec3(0)) {
  Splats geometry;
  const auto all = static_cast<float>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float z = 1 - (2 * static_cast<float>(i) + 1) / all, r = std::sqrt(1 - z * z);
    const float turn = static_cast<float>(i) * 2.39996323f;
    const glm::vec3 n(r * std::cos(turn), r * std::sin(turn), z);
    geometry.normals.push_back(n / length(n));
    geometry.positions.push_back(center + n * radius);
    geometry.weights.push_back(4 * std::numbers::pi_v<float> * radius * radius / all);
    geometry.colors.push_back({static_cast<std::uint8_t>(i % 256), static_cast<std::uint8_t>(i / 7 % 256), 200});
    geometry.description.box.add(geometry.positions.back());
    geometry.description.total += geometry.weights.back();
  }
  return geometry;
}

/// Checks the invariants of every imported geometry.
inline void check_sound(const Splats& geometry) {
  REQUIRE(geometry.normals.size() == geometry.size());
  REQUIRE(geometry.weights.size() == geometry.size());
  REQUIRE((geometry.colors.empty() || geometry.colors.size() == geometry.size()));
  double total = 0;
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    const glm::vec3 p = geometry.positions[i], n = geometry.normals[i];
    REQUIRE_EACH((std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)));
    REQUIRE_EACH(std::abs(length(n) - 1) < 1e-3f);
    REQUIRE_EACH((std::isfinite(geometry.weights[i]) && geometry.weights[i] > 0));
    const auto& box = geometry.description.box;
    for (int k = 0; k < 3; ++k) REQUIRE_EACH((p[k] >= box.lower[k] && p[k] <= box.upper[k]));
    total += geometry.weights[i];
  }
  REQUIRE(geometry.description.total == Approx(total));
  REQUIRE(geometry.description.two_sided);
}

/// Returns the discs of the imported geometry, which must exist.
inline Splats vectors_of(ImportVectors import, const Bytes& bytes) {
  auto result = import(bytes, own_budget());
  if (const auto* problem = std::get_if<std::string>(&result)) {
    FAIL("not imported: " << *problem);
    return {};
  }
  Splats splats =
      std::holds_alternative<Splats>(result) ? std::get<Splats>(result) : std::get<gs::qnv::Gaussians>(result);
  check_sound(splats);
  return splats;
}
/// Returns `count` splats with random shapes, opacities, colours and harmonics, the same in each run.
inline gs::qnv::Gaussians random_gaussians(std::size_t count, int degree) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> even(0.02f, 0.98f);
  gs::app::SplatModel model;
  model.format = "test";
  model.axes = gs::app::kFromRightUpBack;
  model.set_degree(degree);
  model.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    model.positions[i] = glm::dvec3(normal(random), normal(random), normal(random));
    model.scales[i] = {even(random), even(random), even(random)};
    model.rotations[i] = {normal(random), normal(random), normal(random), normal(random)};
    model.opacities[i] = even(random);
    model.dc[i] = (glm::vec3(even(random), even(random), even(random)) - 0.5f) * 4.0f;
    for (std::size_t k = 0; k < gs::qnv::harmonic_count(degree); ++k)
      model.coefficient(i, k) = glm::vec3(normal(random), normal(random), normal(random)) * 0.2f;
  }
  return vectors_of_splats(model);
}

/// Checks the invariants of imported Gaussians.
inline void check_gaussians(const gs::qnv::Gaussians& gaussians) {
  check_sound(gaussians);
  const std::size_t count = gaussians.size();
  REQUIRE(gaussians.scales.size() == count);
  REQUIRE(gaussians.rotations.size() == count);
  REQUIRE(gaussians.opacities.size() == count);
  REQUIRE(gaussians.bases.size() == count);
  REQUIRE(gaussians.harmonics.size() == count * gs::qnv::harmonic_count(gaussians.degree));
  for (const float opacity : gaussians.opacities) REQUIRE_EACH((opacity > 0 && opacity <= 1));
  for (const glm::vec4& q : gaussians.rotations)
    REQUIRE_EACH(std::abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1) < 1e-4f);
  for (const glm::vec3& c : gaussians.harmonics)
    REQUIRE_EACH((std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z)));
}
/// Returns the imported Gaussians, which must exist.
inline gs::qnv::Gaussians gaussians_of(ImportVectors import, const Bytes& bytes) {
  auto result = import(bytes, own_budget());
  REQUIRE(std::holds_alternative<gs::qnv::Gaussians>(result));
  check_gaussians(std::get<gs::qnv::Gaussians>(result));
  return std::move(std::get<gs::qnv::Gaussians>(result));
}
inline std::string problem_of(ImportVectors import, const Bytes& bytes) {
  const auto result = import(bytes, own_budget());
  return std::holds_alternative<std::string>(result) ? std::get<std::string>(result) : std::string();
}
inline std::string metadata(const Splats& geometry, std::string_view name) {
  for (const auto& [key, value] : geometry.description.metadata)
    if (key == name) return value;
  return {};
}

/// Returns a PlayCanvas compressed PLY file with one splat. `harmonics` are the bytes of its coefficients.
inline Bytes compressed_ply(std::uint32_t color, const std::vector<int>& harmonics) {
  std::string header = "ply\nformat binary_little_endian 1.0\nelement chunk 1\n";
  for (const char* name : {"min_x", "min_y", "min_z", "max_x", "max_y", "max_z", "min_scale_x", "min_scale_y",
                           "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z"})
    header += std::string("property float ") + name + "\n";
  header += "element vertex 1\n";
  for (const char* name : {"position", "rotation", "scale", "color"})
    header += std::string("property uint packed_") + name + "\n";
  if (!harmonics.empty()) header += "element sh 1\n";
  for (std::size_t i = 0; i < harmonics.size(); ++i) header += "property uchar f_rest_" + std::to_string(i) + "\n";
  Bytes bytes = bytes_of(header + "end_header\n");
  for (int i = 0; i < 12; ++i) put(bytes, i < 9 ? 0.0f : 1.0f);
  for (const std::uint32_t word : {0u, 0u, 0xffffffffu, color}) put(bytes, word);
  for (const int value : harmonics) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

/// Checks that an import of any bytes gives a valid geometry or a message.
inline void check_any(ImportVectors import, const Bytes& bytes) {
  const auto result = import(bytes, own_budget());
  if (const auto* geometry = std::get_if<Splats>(&result)) {
    REQUIRE_FALSE(geometry->empty());
    check_sound(*geometry);
  } else if (const auto* gaussians = std::get_if<gs::qnv::Gaussians>(&result)) {
    REQUIRE_FALSE(gaussians->empty());
    check_gaussians(*gaussians);
  } else {
    REQUIRE_FALSE(std::get<std::string>(result).empty());
  }
}

/// Imports every prefix (in memory of exactly its size), every changed byte, and invalid bytes after the first bytes.
inline void check_hostile(ImportVectors import, const Bytes& bytes, std::size_t step = 1) {
  for (std::size_t n = 0; n <= bytes.size(); n += n < 600 ? watched_step(3) : step)
    check_any(import, Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)));
  for (std::size_t i = 0; i < bytes.size(); i += i < 600 ? watched_step(3) : step)
    for (const int mask : {0x01, 0x80, 0xff}) {
      Bytes changed = bytes;
      changed[i] ^= static_cast<std::byte>(mask);
      check_any(import, changed);
    }
  std::mt19937 random(1);
  for (int round = 0; round < 100; ++round) {
    Bytes rubbish(random() % 300);
    for (auto& b : rubbish) b = static_cast<std::byte>(random());
    check_any(import, rubbish);
    Bytes mixed(bytes.begin(),
                bytes.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(bytes.size(), random() % 64)));
    mixed.insert(mixed.end(), rubbish.begin(), rubbish.end());
    check_any(import, mixed);
  }
}

}  // namespace gs::test
