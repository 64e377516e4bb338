#include "qnv/codecs/displaced/base_mesh.h"

#include "qnv/codecs/displaced/patches.h"
#include "qnv/mesh/simplify/simplify.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"
#include "tests/watched.h"

#include <glm/common.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <random>
#include <set>
#include <tuple>
#include <vector>

namespace gs::qnv::displaced::base_mesh_test {
namespace {

constexpr std::size_t kMax = 1 << 17;

/// Encodes on a lattice of 2^bits positions per axis.
BaseMesh base_of(const SurfaceMesh& mesh, int bits) {
  BaseMesh base;
  base.bits = bits;
  base.triangles = mesh.triangles;
  Box box;
  for (const glm::vec3& p : mesh.positions) box.add(p);
  const glm::vec3 size = box.size();
  const float cells = static_cast<float>(1 << bits), longest = std::max({size.x, size.y, size.z});
  for (const glm::vec3& p : mesh.positions)
    base.vertices.push_back(glm::clamp(glm::ivec3((p - box.lower) / longest * cells), 0, (1 << bits) - 1));
  return base;
}

BaseMesh tetrahedron() {
  BaseMesh base;
  base.bits = 4;
  base.vertices = {{1, 1, 1}, {14, 2, 1}, {3, 12, 2}, {5, 5, 15}};
  base.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return base;
}

bool none(std::uint32_t, std::uint32_t) { return false; }

/// Returns triangles by the positions of their corners, starting at the smallest corner.
std::multiset<std::vector<std::tuple<int, int, int>>> placed(const BaseMesh& base) {
  std::multiset<std::vector<std::tuple<int, int, int>>> out;
  for (const Corners& t : base.triangles) {
    std::vector<std::tuple<int, int, int>> corners;
    for (const std::uint32_t v : t) corners.emplace_back(base.vertices[v].x, base.vertices[v].y, base.vertices[v].z);
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    out.insert(corners);
  }
  return out;
}

bool equal(const BaseMesh& a, const BaseMesh& b) {
  return a.bits == b.bits && a.vertices == b.vertices && a.triangles == b.triangles && a.creases == b.creases;
}

std::vector<std::pair<const char*, BaseMesh>> bases() {
  Triangles two = ball(6);
  for (Triangle t : torus(12, 8)) {
    for (glm::vec3& p : t.positions) p += glm::vec3(4, 0, 1);
    two.push_back(t);
  }
  for (Triangle t : sheet(9)) {
    for (glm::vec3& p : t.positions) p += glm::vec3(0, 5, 0);
    two.push_back(t);
  }
  return {{"tetrahedron", tetrahedron()},
          {"torus", base_of(mesh_of(torus(16, 9)), 9)},
          {"sheet with rims", base_of(mesh_of(sheet(14)), 10)},
          {"ball, torus and sheet", base_of(mesh_of(two), 11)},
          {"simplified sheet", base_of(simplify(mesh_of(sheet(90)), 900), 9)},
          {"one triangle", base_of(mesh_of({triangle_of({0, 0, 0}, {1, 0, 0}, {0, 1, 0})}), 1)}};
}

/// Checks the guarantees of a decoder for its result.
void check_sound(const BaseMesh& base, std::size_t bytes) {
  REQUIRE_EACH(base.triangles.size() <= 64 * bytes);
  REQUIRE_EACH(base.vertices.size() <= 3 * base.triangles.size());
  REQUIRE_EACH(sides_once(base.triangles));
  const int top = (1 << base.bits) - 1;
  for (const glm::ivec3& v : base.vertices)
    REQUIRE_EACH(std::min({v.x, v.y, v.z}) >= 0 && std::max({v.x, v.y, v.z}) <= top);
  for (const Corners& t : base.triangles)
    for (const std::uint32_t v : t) REQUIRE_EACH(v < base.vertices.size());
}

}  // namespace

TEST_CASE("restores a base mesh from its bytes") {
  for (const auto& [name, base] : bases()) {
    INFO(name);
    const CodedBase coded = encode_base(base, none);
    CHECK(placed(coded.mesh) == placed(base));
    const auto decoded = decode_base(coded.bytes, kMax);
    REQUIRE(decoded);
    CHECK(equal(*decoded, coded.mesh));
    CHECK(decoded->creases.empty());
    REQUIRE(coded.source.size() == base.vertices.size());
    for (std::size_t v = 0; v < coded.source.size(); ++v)
      REQUIRE_EACH(coded.mesh.vertices[v] == base.vertices[coded.source[v]]);
    CHECK(!decode_base(coded.bytes, base.triangles.size() - 1));
  }
}

TEST_CASE("keeps the creases of a base mesh, without those at its boundary") {
  const BaseMesh base = base_of(simplify(mesh_of(sheet(60)), 300), 9);
  // Creases: edges with both ends on one side of a plane.
  const auto crease = [&](std::uint32_t a, std::uint32_t b) {
    return (base.vertices[a].x > 256) == (base.vertices[b].x > 256) && (a + b) % 3 == 0;
  };
  const CodedBase coded = encode_base(base, crease);
  const auto decoded = decode_base(coded.bytes, kMax);
  REQUIRE(decoded);
  CHECK(equal(*decoded, coded.mesh));
  const Patches patches(decoded->triangles, static_cast<std::uint32_t>(decoded->vertices.size()));
  REQUIRE(decoded->creases.size() == patches.edges().size());
  std::size_t creases = 0;
  for (std::size_t e = 0; e < patches.edges().size(); ++e) {
    const Patches::Edge& edge = patches.edges()[e];
    CHECK(decoded->creases[e] == (edge.other != kNone && crease(coded.source[edge.from], coded.source[edge.to])));
    creases += decoded->creases[e] ? 1 : 0;
  }
  CHECK(creases > 20);
}

TEST_CASE("encodes a smooth base mesh in about 1.5 bytes per triangle") {
  const BaseMesh base = base_of(simplify(mesh_of(torus(120, 60)), 640), 8);
  CHECK(encode_base(base, none).bytes.size() < base.triangles.size() * 3 / 2);
}

TEST_CASE("decodes prefixes and mutations of a base mesh to a valid mesh or rejects them") {
  std::mt19937 random(5);
  for (const auto& [name, base] : bases()) {
    INFO(name);
    const std::vector<std::byte> bytes = encode_base(base, none).bytes;
    for (std::size_t length = 0; length < bytes.size(); ++length)
      if (const auto decoded = decode_base(std::span(bytes).first(length), kMax)) check_sound(*decoded, length);
    std::size_t refused = 0;
    constexpr std::size_t kRounds = 4000;
    for (std::size_t round = 0; round < kRounds; round += watched_step(7)) {
      std::vector<std::byte> mutated = bytes;
      for (std::size_t i = 0; i <= round % 4; ++i)
        mutated[random() % mutated.size()] = static_cast<std::byte>(random());
      if (round % 5 == 0) mutated.resize(mutated.size() + random() % 40, static_cast<std::byte>(random()));
      const auto decoded = decode_base(mutated, kMax);
      if (decoded)
        check_sound(*decoded, mutated.size());
      else
        ++refused;
    }
    CHECK(refused > 0);
  }
}

TEST_CASE("ends on bytes that always decode to new vertices") {
  // Bytes after the end read as 0, which means a new vertex at every gate, until the limit.
  for (const std::size_t length : {1, 2, 30, 3000, 65535})
    for (const int fill : {0x00, 0xff, 0x55}) {
      std::vector<std::byte> bytes(length, static_cast<std::byte>(fill));
      bytes[0] = std::byte{16};
      if (const auto decoded = decode_base(bytes, kMax)) check_sound(*decoded, length);
    }
  CHECK(!decode_base({}, kMax));
  CHECK(!decode_base(std::vector<std::byte>(100), kMax));                 // a lattice of 0 bits
  CHECK(!decode_base(std::vector<std::byte>(100, std::byte{17}), kMax));  // too many bits
}

}  // namespace gs::qnv::displaced::base_mesh_test
