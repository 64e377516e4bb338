#include "app/formats/gltf/gltf_splats.h"

#include "app/formats/content_types.h"
#include "app/formats/export/export.h"
#include "app/formats/export/export_glb_mesh.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {
namespace gltf_splats_test {

struct Read {
  Asset asset;
  Diagnostics diagnostics;
  [[nodiscard]] const qnv::Gaussians& gaussians() const {
    for (const Diagnostic& one : diagnostics.entries()) UNSCOPED_INFO(one.text());
    REQUIRE(std::holds_alternative<qnv::Gaussians>(asset));
    return std::get<qnv::Gaussians>(asset);
  }
};

Read read(std::span<const std::byte> bytes) {
  Read result;
  const std::string path = "a.glb";
  result.asset = read_gltf_splats({bytes, path, {}, own_budget(), result.diagnostics});
  return result;
}

qnv::Gaussians cloud(int degree) {
  qnv::Gaussians splats;
  splats.degree = degree;
  for (int i = 0; i < 40; ++i) {
    const auto t = static_cast<float>(i);
    splats.positions.emplace_back(std::sin(t), 0.1f * t, std::cos(2 * t));
    splats.normals.emplace_back(0, 0, 1);
    splats.weights.push_back(0.01f);
    splats.colors.push_back({10, 200, static_cast<std::uint8_t>(i)});
    splats.scales.emplace_back(0.05f + 0.01f * t, 0.03f, 0.02f);
    splats.rotations.push_back(glm::normalize(glm::vec4(0.1f * t, 0.4f, -0.2f, 1)));
    splats.opacities.push_back(0.2f + 0.01f * t);
    splats.bases.emplace_back(0.5f, 0.02f * t, 0.9f);
    for (std::size_t k = 0; k < qnv::harmonic_count(degree); ++k)
      splats.harmonics.emplace_back(0.01f * static_cast<float>(k), -0.02f, 0.005f * t);
    splats.description.box.add(splats.positions.back());
  }
  return splats;
}

std::vector<std::byte> glb_of(const qnv::Gaussians& splats) {
  const Exported made = export_glb_splats(splats, {});
  REQUIRE(std::holds_alternative<std::vector<std::byte>>(made));
  return std::get<std::vector<std::byte>>(made);
}

/// Replaces a text of the JSON chunk by one of the same length.
std::vector<std::byte> with(std::vector<std::byte> bytes, const std::string& before, const std::string& after) {
  REQUIRE(before.size() == after.size());
  std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t at = text.find(before);
  REQUIRE(at != std::string::npos);
  for (std::size_t i = 0; i < after.size(); ++i) bytes[at + i] = static_cast<std::byte>(after[i]);
  return bytes;
}

void check_near(const glm::vec3& a, const glm::vec3& b) { CHECK(glm::length(a - b) < 1e-4f); }

TEST_CASE("reads the Gaussians of a glTF as they were exported") {
  for (const int degree : {0, 1, 3}) {
    const qnv::Gaussians splats = cloud(degree);
    const auto bytes = glb_of(splats);
    CHECK(is_gltf_splats(first_bytes(bytes)));
    CHECK(content_type_of("a.glb", first_bytes(bytes)).name == "glTF splats");
    const Read result = read(bytes);
    const qnv::Gaussians& found = result.gaussians();
    CHECK(result.diagnostics.entries().empty());
    REQUIRE(found.size() == splats.size());
    CHECK(found.degree == degree);
    REQUIRE(found.harmonics.size() == splats.harmonics.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      check_near(found.positions[i] + glm::vec3(found.description.origin), splats.positions[i]);
      check_near(found.scales[i], splats.scales[i]);
      CHECK(std::abs(glm::dot(found.rotations[i], splats.rotations[i])) == Approx(1).margin(1e-5));
      CHECK(found.opacities[i] == Approx(splats.opacities[i]));
      check_near(found.bases[i], splats.bases[i]);
    }
    for (std::size_t i = 0; i < found.harmonics.size(); ++i) check_near(found.harmonics[i], splats.harmonics[i]);
  }
}

TEST_CASE("places the splats of a glTF by the transformation of their node") {
  qnv::Gaussians splats = cloud(1);
  auto bytes = glb_of(splats);
  // A quarter turn about z and a scale of 2, in the place of the name.
  const Exported named = export_glb_splats(splats, {.title = std::string(60, 'n')});
  bytes = std::get<std::vector<std::byte>>(named);
  const std::string before = "\"name\":\"" + std::string(60, 'n') + "\"";
  std::string after = R"("rotation":[0,0,0.70710678,0.70710678],"scale":[2,2,2])";
  after.resize(before.size(), ' ');
  bytes = with(bytes, before, after);
  const Read result = read(bytes);
  const qnv::Gaussians& found = result.gaussians();
  REQUIRE(found.size() == splats.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const glm::vec3 p = splats.positions[i];
    check_near(found.positions[i] + glm::vec3(found.description.origin), {-2 * p.y, 2 * p.x, 2 * p.z});
    check_near(found.scales[i], 2.0f * splats.scales[i]);
    // The degree 1 harmonics are -y, z, -x: y becomes x, and x becomes -y.
    const glm::vec3* const h = &splats.harmonics[3 * i];
    check_near(found.harmonics[3 * i], h[2]);
    check_near(found.harmonics[3 * i + 1], h[1]);
    check_near(found.harmonics[3 * i + 2], -h[0]);
  }
}

TEST_CASE("reports splats of a glTF that it cannot read") {
  const auto bytes = glb_of(cloud(0));
  const auto message = [](const std::vector<std::byte>& of) {
    const Read result = read(of);
    CHECK(std::holds_alternative<std::monostate>(result.asset));
    REQUIRE_FALSE(result.diagnostics.entries().empty());
    return result.diagnostics.entries().front().text();
  };
  CHECK(message(with(bytes, "KHR_gaussian_splatting:SCALE", "KHR_gaussian_splatting:SCALX")) ==
        "a.glb: error: splats: KHR_gaussian_splatting:SCALE: is missing");
  CHECK(message(with(bytes, "\"count\":40", "\"count\":99")).starts_with("a.glb: error: splats: "));
  const Read kernel = read(with(bytes, "\"ellipse\"", "\"circles\""));
  CHECK(kernel.gaussians().size() == 40);
  CHECK(kernel.diagnostics.entries().front().message == "splats with the kernel 'circles' are drawn as ellipses");
  for (std::size_t size = 0; size < bytes.size(); size += 97) (void)read(std::span(bytes).first(size));
  std::uint32_t random = 3;
  for (int turn = 0; turn < 2000; ++turn) {
    auto changed = bytes;
    for (int i = 0; i < 3; ++i) {
      random = random * 1664525 + 1013904223;
      changed[(random >> 8) % changed.size()] = static_cast<std::byte>(random >> 3);
    }
    (void)read(changed);
  }
}

/// Returns a GLB file with splats as SPZ. `extensions` are those of its primitive; VIEW stands for the buffer view.
std::vector<std::byte> glb_with_spz(std::string extensions, const std::vector<std::byte>& spz) {
  extensions.replace(extensions.find("VIEW"), 4, "{\"bufferView\":0}");
  const std::string text =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[)"
      R"({"mode":0,"attributes":{"POSITION":0},"extensions":)" +
      extensions + R"(}]}],"accessors":[{"componentType":5126,"count":40,"type":"VEC3"}],"buffers":[{"byteLength":)" +
      std::to_string(spz.size()) + R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + std::to_string(spz.size()) +
      "}]}";
  const Exported made = glb_file(text, spz);
  REQUIRE(std::holds_alternative<std::vector<std::byte>>(made));
  return std::get<std::vector<std::byte>>(made);
}

const std::string kSpzDraft =
    R"({"KHR_gaussian_splatting":{"extensions":{"KHR_gaussian_splatting_compression_spz_2":VIEW}}})";

TEST_CASE("reads splats of a glTF that are compressed as SPZ, by the drafts of the extension") {
  const qnv::Gaussians splats = cloud(1);
  for (const auto& write : {export_spz, export_spz3})
    for (const std::string& extensions :
         {kSpzDraft, std::string(R"({"KHR_spz_gaussian_splats_compression":VIEW})"),
          std::string(
              R"({"KHR_gaussian_splatting":{"extensions":{"KHR_gaussian_splatting_compression_spz":VIEW}}})")}) {
      INFO(extensions);
      const auto spz = std::get<std::vector<std::byte>>(write(splats, {}));
      const auto bytes = glb_with_spz(extensions, spz);
      CHECK(content_type_of("a.glb", first_bytes(bytes)).name == "glTF splats");
      const Read result = read(bytes);
      const qnv::Gaussians& found = result.gaussians();
      CHECK(result.diagnostics.entries().empty());
      REQUIRE(found.size() == splats.size());
      CHECK(found.degree == 1);
      CHECK(found.description.metadata.front().second == "glTF KHR_gaussian_splatting with SPZ");
      for (std::size_t i = 0; i < found.size(); ++i) {
        const glm::vec3 p = splats.positions[i];
        CHECK(glm::length(found.positions[i] + glm::vec3(found.description.origin) - glm::vec3(-p.x, p.y, -p.z)) <
              1e-3f);
        const glm::vec4 q = splats.rotations[i];
        CHECK(std::abs(glm::dot(found.rotations[i], glm::vec4(-q.x, q.y, -q.z, q.w))) == Approx(1).margin(1e-3));
        CHECK(found.opacities[i] == Approx(splats.opacities[i]).margin(0.003));
        CHECK(found.harmonics[3 * i + 2].x == Approx(-splats.harmonics[3 * i + 2].x).margin(0.01));
      }
    }
}

TEST_CASE("keeps the harmonics of splats after others in SPZ without harmonics") {
  const auto spz = std::get<std::vector<std::byte>>(export_spz(cloud(0), {}));
  const std::vector<std::byte> plain = glb_of(cloud(2));
  std::uint32_t text_bytes = 0;
  std::memcpy(&text_bytes, plain.data() + 12, sizeof text_bytes);
  const auto* const text = reinterpret_cast<const char*>(plain.data() + 20);
  nlohmann::json document = nlohmann::json::parse(text, text + text_bytes);
  std::vector<std::byte> binary(plain.begin() + 28 + text_bytes, plain.end());
  document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", spz.size()}});
  const nlohmann::json view{{"bufferView", document["bufferViews"].size() - 1}};
  const nlohmann::json first = {{"mode", 0},
                                {"attributes", nlohmann::json::object()},
                                {"extensions", {{"KHR_spz_gaussian_splats_compression", view}}}};
  nlohmann::json& primitives = document["meshes"][0]["primitives"];
  primitives.insert(primitives.begin(), first);
  binary.insert(binary.end(), spz.begin(), spz.end());
  document["buffers"][0]["byteLength"] = binary.size();
  const Read result = read(std::get<std::vector<std::byte>>(glb_file(document.dump(), binary)));
  const qnv::Gaussians& found = result.gaussians();
  REQUIRE(found.size() == 80);
  REQUIRE(found.degree == 2);
  CHECK(found.harmonics[8 * 39 + 4] == glm::vec3(0));
  check_near(found.harmonics[8 * 79 + 4], cloud(2).harmonics[8 * 39 + 4]);
}

TEST_CASE("reads damaged SPZ within a glTF without faults") {
  const auto spz = std::get<std::vector<std::byte>>(export_spz(cloud(0), {}));
  const auto message = [](const std::vector<std::byte>& of) {
    const Read result = read(of);
    CHECK(std::holds_alternative<std::monostate>(result.asset));
    REQUIRE_FALSE(result.diagnostics.entries().empty());
    return result.diagnostics.entries().front().message;
  };
  CHECK(message(glb_with_spz(kSpzDraft, {spz.begin(), spz.begin() + 40})).starts_with("splats in SPZ: "));
  std::string elsewhere = kSpzDraft;
  elsewhere.replace(elsewhere.find("VIEW"), 4, "{\"bufferView\":7,\"was\":VIEW}");
  CHECK(message(glb_with_spz(elsewhere, spz)).find("its buffer view is missing") != std::string::npos);
  const auto bytes = glb_with_spz(kSpzDraft, spz);
  for (std::size_t size = 0; size < bytes.size(); size += 31) (void)read(std::span(bytes).first(size));
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    auto changed = bytes;
    changed[at] ^= std::byte{0x5a};
    (void)read(changed);
  }
}

}  // namespace gltf_splats_test
}  // namespace gs::app
