#pragma once

#include "app/formats/content_types.h"
#include "base/diagnostic.h"
#include "tests/watched.h"
#include "vrml/mesh/mesh.h"
#include "vrml/scene/scene_graph.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

/// Helpers of tests of importers.
namespace gs::test {

using Bytes = std::vector<std::byte>;

inline Bytes bytes_of(std::string_view text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

inline std::string string_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline std::string base64(const Bytes& bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned bits = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? std::to_integer<unsigned>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k) out += k <= count ? digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

template <class T>
void put(Bytes& to, T value) {
  std::byte raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  to.insert(to.end(), raw, raw + sizeof(T));
}

template <class T>
void put_big(Bytes& to, T value) {
  std::byte raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  for (std::size_t i = sizeof(T); i-- > 0;) to.push_back(raw[i]);
}

/// Imported scene with its diagnostics.
struct Imported {
  std::unique_ptr<vrml::SceneGraph> scene = std::make_unique<vrml::SceneGraph>("test");
  Diagnostics diagnostics;

  [[nodiscard]] std::vector<vrml::NodeId> all(std::string_view type) const {
    std::vector<vrml::NodeId> found;
    for (std::uint32_t i = 1; i <= scene->nodes().count(); ++i)
      if (scene->nodes().at(i).type->name == type) found.push_back(scene->nodes().id_at(i));
    return found;
  }
  [[nodiscard]] vrml::NodeId only(std::string_view type) const {
    const auto found = all(type);
    INFO(type);
    REQUIRE(found.size() == 1);
    return found.front();
  }
  template <class T>
  [[nodiscard]] std::vector<typename T::value_type> values(vrml::NodeId node, std::string_view field) const {
    const T& array = scene->get<T>(node, field);
    return {array.begin(), array.end()};
  }
  [[nodiscard]] std::vector<std::int32_t> corners() const {
    return values<vrml::MFInt32>(only("IndexedFaceSet"), "coordIndex");
  }
  [[nodiscard]] std::vector<glm::vec3> points() const { return values<vrml::MFVec3f>(only("Coordinate"), "point"); }
  [[nodiscard]] std::vector<vrml::Color> colors() const { return values<vrml::MFColor>(only("Color"), "color"); }
  [[nodiscard]] std::string messages() const {
    std::string text;
    for (const auto& entry : diagnostics.entries()) text += entry.text() + "\n";
    return text;
  }
};

inline const app::ContentType& type_named(std::string_view name) {
  for (const app::ContentType& type : app::content_types())
    if (type.name == name) return type;
  FAIL("no content type " << name);
  std::abort();
}

/// Importer of a content type, with the files that it may read.
struct Import {
  Import(const char* name, app::ReadFile files = {}) : type(name), read_file(std::move(files)) {}

  std::string_view type;
  app::ReadFile read_file;
  bool for_x3d = false;
  app::VoxelComponent choice{};
};

inline Imported imported(const Import& import, std::span<const std::byte> bytes) {
  Imported result;
  const std::string path = "test";
  const WorldBudget budget = result.scene->budget();
  app::ImportSource source{bytes, path, import.read_file, budget, result.diagnostics};
  source.for_x3d = import.for_x3d;
  source.component = import.choice;
  app::Asset asset = type_named(import.type).read(source);
  if (auto* scene = std::get_if<app::SceneAsset>(&asset)) result.scene = std::move(scene->scene);
  if (auto* mesh = std::get_if<app::MeshAsset>(&asset))
    result.scene = app::scene_of(std::move(*mesh), path, budget, result.diagnostics);
  return result;
}

inline bool all_finite(const vrml::MFVec3f& values) {
  for (const glm::vec3& v : values)
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return false;
  return true;
}

/// Checks the invariants of every imported scene, also of broken files.
inline void check_sound(const Imported& result) {
  const vrml::SceneGraph& scene = *result.scene;
  for (const vrml::NodeId node : result.all("IndexedFaceSet")) {
    const auto& points = scene.get<vrml::MFVec3f>(scene.get<vrml::SFNode>(node, "coord"), "point");
    const auto& index = scene.get<vrml::MFInt32>(node, "coordIndex");
    REQUIRE(all_finite(points));
    for (const std::int32_t i : index) REQUIRE_EACH((i >= -1 && i < static_cast<std::int32_t>(points.size())));
    for (const char* other : {"normalIndex", "texCoordIndex"}) {
      const auto& along = scene.get<vrml::MFInt32>(node, other);
      REQUIRE((along.empty() || along.size() == index.size()));
    }
    (void)vrml::tessellate(scene, node);
  }
  for (const char* type : {"IndexedLineSet", "PointSet"})
    for (const vrml::NodeId node : result.all(type)) (void)vrml::tessellate(scene, node);
  for (const vrml::NodeId node : result.all("Color"))
    for (const vrml::Color& c : scene.get<vrml::MFColor>(node, "color"))
      REQUIRE_EACH((c.r >= 0 && c.r <= 1 && c.g >= 0 && c.g <= 1 && c.b >= 0 && c.b <= 1));
}

/// Imports every prefix of a file, in memory of exactly its size, and every changed byte.
inline void check_prefixes_and_flips(const Import& import, const Bytes& bytes) {
  for (std::size_t n = 0; n <= bytes.size(); ++n)
    check_sound(imported(import, Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n))));
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (const int mask : {0x01, 0x08, 0xff}) {
      Bytes changed = bytes;
      changed[i] ^= static_cast<std::byte>(mask);
      check_sound(imported(import, changed));
    }
}

/// Returns the folder of shared test data, or an empty path.
inline std::filesystem::path shared_folder() {
  namespace fs = std::filesystem;
  if (const char* set = std::getenv("GHOSTSPACE_SHARED")) return fs::is_directory(set) ? fs::path(set) : fs::path();
  const fs::path beside = fs::path(GHOSTSPACE_TESTS).parent_path().parent_path() / "shared";
  return fs::is_directory(beside) ? beside : fs::path();
}

inline Bytes file_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return bytes_of(text);
}

}  // namespace gs::test
