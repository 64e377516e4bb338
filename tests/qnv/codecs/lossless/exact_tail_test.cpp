#include "qnv/codecs/displaced/surface.h"
#include "tests/qnv/codecs/lossless/exact_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <span>

namespace gs::qnv::exact::tail_test {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::size_t kMax = std::size_t{1} << 20;

std::vector<Source> all_sources() {
  std::vector<Source> all = smooth_sources();
  for (Source& s : nasty_sources()) all.push_back(std::move(s));
  return all;
}

// Checks FORMAT.md, "Exact tail": a valid mesh for any bytes.
void check_sound(const ExactMesh& mesh, std::size_t bytes) {
  REQUIRE_EACH(mesh.triangles.size() <= 64 * bytes);
  REQUIRE_EACH(mesh.twins.size() == 3 * mesh.triangles.size());
  REQUIRE_EACH((mesh.colors.empty() || mesh.colors.size() == mesh.vertices.size()));
  const int top = (1 << mesh.bits) - 1;
  for (const glm::ivec3& p : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis) REQUIRE_EACH((p[axis] >= 0 && p[axis] <= top));
  for (std::uint32_t side = 0; side < mesh.twins.size(); ++side) {
    const auto at = [&](std::uint32_t s, std::uint32_t k) { return mesh.triangles[s / 3][(s % 3 + k) % 3]; };
    REQUIRE_EACH((at(side, 0) < mesh.vertices.size() && at(side, 0) != at(side, 1)));
    const std::uint32_t twin = mesh.twins[side];
    if (twin == displaced::kNone) continue;
    REQUIRE_EACH(mesh.twins.at(twin) == side);
    REQUIRE_EACH((at(twin, 0) == at(side, 1) && at(twin, 1) == at(side, 0)));
  }
}

}  // namespace

TEST_CASE("restores any mesh from its tail, with all triangles, their facing and duplicates") {
  for (const Source& s : all_sources())
    for (const int bits : {8, 11, 20}) {
      INFO(s.name << ", " << bits << " bits");
      const ExactMesh mesh = mesh_of(s.triangles, bits, s.colored);
      const std::vector<Turned> wanted = triangles_in(s.triangles, bits, s.colored);
      REQUIRE(triangles_in(mesh) == wanted);
      const Bytes tail = encode_tail(mesh);
      const auto decoded = decode_tail(tail, kMax);
      REQUIRE(decoded);
      CHECK(decoded->bits == bits);
      CHECK(decoded->vertices.size() == mesh.vertices.size());
      CHECK(triangles_in(*decoded) == wanted);
      check_sound(*decoded, tail.size());
      CHECK(!decode_tail(tail, mesh.vertices.size() - 1));
    }
}

TEST_CASE("keeps the shared vertices of a mesh") {
  const ExactMesh mesh = mesh_of(displaced::torus(30, 16), 11, false);
  const auto decoded = decode_tail(encode_tail(mesh), kMax);
  REQUIRE(decoded);
  CHECK(decoded->vertices.size() == 480);  // 30 * 16: no vertex is repeated
  CHECK(std::count(decoded->twins.begin(), decoded->twins.end(), displaced::kNone) == 0);
}

TEST_CASE("creases a mesh where the normals of its corners differ") {
  Triangles cube = box_shape(glm::vec3(-1), glm::vec3(1), 4);
  for (Triangle& t : cube)
    t.normals.fill(glm::normalize(glm::cross(t.positions[1] - t.positions[0], t.positions[2] - t.positions[0])));
  const ExactMesh creased = mesh_of(cube, 11, false);
  CHECK(creased.crease_angle < 90);
  CHECK(decode_tail(encode_tail(creased), kMax)->crease_angle == creased.crease_angle);
  CHECK(mesh_of(displaced::ball(8), 11, false).crease_angle > 90);  // vertex normals
}

TEST_CASE("encodes a smooth mesh in under two bytes per vertex") {
  const ExactMesh mesh = mesh_of(displaced::torus(60, 40), 11, false);
  CHECK(encode_tail(mesh).size() < 2 * mesh.vertices.size());
}

TEST_CASE("rejects prefixes of a tail, and decodes mutations to a mesh or rejects them") {
  std::mt19937 random(7);
  for (const Source& s : all_sources()) {
    INFO(s.name);
    const Bytes tail = encode_tail(mesh_of(s.triangles, 10, s.colored));
    // A tail may omit zeros at its end.
    const std::size_t prefixes = std::max<std::size_t>(1, tail.size() / 40) * watched_step(4);
    for (std::size_t length = 0; length + 8 < tail.size(); length += prefixes)
      REQUIRE_EACH(!decode_tail(std::span(tail).first(length), kMax));
    std::size_t refused = 0;
    for (std::size_t round = 0; round < 100; round += watched_step(7)) {
      Bytes mutated = tail;
      for (std::size_t i = 0; i <= round % 4; ++i) {
        const std::size_t from = round % 3 == 0 ? 0 : 107;  // changes the header in a third of the rounds
        mutated[from + random() % (mutated.size() - from)] = static_cast<std::byte>(random());
      }
      const auto decoded = decode_tail(mutated, kMax);
      if (decoded)
        check_sound(*decoded, mutated.size());
      else
        ++refused;
    }
    CHECK(refused > 10 / watched_step(7));
  }
}

TEST_CASE("detects a flipped bit in a tail by the mark at its end") {
  const Bytes tail = encode_tail(mesh_of(displaced::sheet(40), 11, false));
  std::size_t through = 0, tried = 0;
  for (std::size_t bit = 8 * 107; bit + 100 < 8 * tail.size(); bit += 61 * watched_step(9), ++tried) {
    Bytes damaged = tail;
    damaged[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    through += decode_tail(damaged, kMax) ? 1 : 0;
  }
  CHECK(tried > 10);
  CHECK(through == 0);
}

TEST_CASE("rejects a tail that promises too much") {
  const Bytes tail = encode_tail(mesh_of(displaced::ball(6), 11, false));
  const auto with = [&](std::size_t at, std::initializer_list<int> values) {
    Bytes changed = tail;
    for (const int value : values) changed[at++] = static_cast<std::byte>(value);
    return changed;
  };
  CHECK(decode_tail(tail, kMax));
  CHECK(!decode_tail(with(0, {2}), kMax));  // a reserved flag
  CHECK(!decode_tail(with(1, {7}), kMax));  // bits
  CHECK(!decode_tail(with(1, {21}), kMax));
  CHECK(!decode_tail(with(2, {181}), kMax));                 // crease angle
  CHECK(!decode_tail(with(3, {255, 255, 255, 255}), kMax));  // vertices
  CHECK(!decode_tail(with(7, {255, 255, 255, 127}), ~0u));   // triangles, over 64 per byte
  CHECK(!decode_tail(with(7, {0, 0, 0, 0}), kMax));
  CHECK(!decode_tail(std::span(tail).first(100), kMax));
}

TEST_CASE("ends on tail bytes that repeat one decision") {
  for (const std::size_t length : {108, 200, 3000, 20000})
    for (const int fill : {0x00, 0xff, 0x55, 0xaa}) {
      Bytes bytes(length, static_cast<std::byte>(fill));
      bytes[0] = std::byte{0};
      bytes[1] = std::byte{20};
      bytes[2] = std::byte{180};
      const auto put = [&](std::size_t at, std::size_t value) {
        for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::byte>(value >> (8 * i) & 255);
      };
      put(3, 64 * length);
      put(7, 64 * length);
      if (const auto decoded = decode_tail(bytes, kMax << 4)) check_sound(*decoded, length);
    }
}

}  // namespace gs::qnv::exact::tail_test
