#include "qnv/codecs/progressive/progressive.h"
#include "tests/qnv/codecs/lossless/exact_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <optional>
#include <random>

namespace gs::qnv::progressive::progressive_test {
namespace {

using exact::ExactMesh;
using Bytes = std::vector<std::byte>;

constexpr std::size_t kMax = std::size_t{1} << 20, kFront = 700;

std::vector<exact::Source> sources() {
  std::vector<exact::Source> all = exact::nasty_sources();
  for (exact::Source& s : exact::smooth_sources()) all.push_back(std::move(s));
  return all;
}

void check_sound(const ExactMesh& mesh) {
  REQUIRE_EACH(mesh.twins.size() == 3 * mesh.triangles.size());
  const int top = (1 << mesh.bits) - 1;
  for (const glm::ivec3& p : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis) REQUIRE_EACH((p[axis] >= 0 && p[axis] <= top));
  for (std::uint32_t side = 0; side < mesh.twins.size(); ++side) {
    const auto at = [&](std::uint32_t s, std::uint32_t k) { return mesh.triangles[s / 3][(s % 3 + k) % 3]; };
    REQUIRE_EACH(at(side, 0) < mesh.vertices.size());
    const std::uint32_t twin = mesh.twins[side];
    if (twin == kNone) continue;
    REQUIRE_EACH(mesh.twins.at(twin) == side);
    REQUIRE_EACH((at(twin, 0) == at(side, 1) && at(twin, 1) == at(side, 0)));
  }
}

/// Decodes the first segments of a progressive mesh.
ProgressiveMesh read(const ProgressiveBytes& bytes, std::size_t segments) {
  ProgressiveMesh mesh;
  REQUIRE(mesh.begin(bytes.front, kMax));
  for (std::size_t i = 0; i < segments; ++i) REQUIRE(mesh.add(bytes.segments[i]));
  return mesh;
}

}  // namespace

// FORMAT.md, "Splits".
TEST_CASE("restores a progressive mesh with all triangles, their facing and duplicates") {
  std::size_t made = 0;
  for (const exact::Source& s : sources()) {
    if (s.colored) continue;
    INFO(s.name);
    const ExactMesh mesh = exact::mesh_of(s.triangles, 11, false);
    const auto bytes = encode_progressive(mesh, kFront);
    if (!bytes) continue;
    ++made;
    CHECK(bytes->front.size() <= kFront);
    CHECK(bytes->vertices == mesh.vertices.size());
    const ProgressiveMesh whole = read(*bytes, bytes->segments.size());
    CHECK(whole.whole());
    const ExactMesh back = whole.mesh();
    check_sound(back);
    CHECK(exact::triangles_in(back) == exact::triangles_in(mesh));
  }
  CHECK(made > 8);
}

TEST_CASE("approaches the mesh with every prefix of its segments, in any order") {
  const Triangles source = displaced::torus(60, 30);
  const ExactMesh mesh = exact::mesh_of(source, 12, false);
  const auto bytes = encode_progressive(mesh, kFront);
  REQUIRE(bytes);
  REQUIRE(bytes->segments.size() > 4);
  std::size_t before = 0;
  for (std::size_t n = 0; n <= bytes->segments.size(); n += watched_step(3)) {
    const ProgressiveMesh some = read(*bytes, n);
    CHECK(some.vertices() >= before);
    CHECK(some.whole() == (n == bytes->segments.size()));
    before = some.vertices();
    check_sound(some.mesh());
  }
  ProgressiveMesh backwards;
  REQUIRE(backwards.begin(bytes->front, kMax));
  for (std::size_t i = bytes->segments.size(); i-- > 0;) {
    CHECK(!backwards.whole());
    CHECK(backwards.add(bytes->segments[i]));
    CHECK(backwards.add(bytes->segments[i]));  // repeated
  }
  CHECK(backwards.whole());
  CHECK(backwards.mesh().triangles == read(*bytes, bytes->segments.size()).mesh().triangles);
}

TEST_CASE("survives a front that promises too much, and changed segments") {
  const ExactMesh mesh = exact::mesh_of(displaced::torus(30, 20), 10, false);
  const auto bytes = encode_progressive(mesh, kFront);
  REQUIRE(bytes);
  CHECK(promises_more(bytes->front, 100));
  ProgressiveMesh none;
  CHECK(!none.begin(bytes->front, 100));
  CHECK(!none.add(bytes->segments[0]));
  std::mt19937 random(5);
  for (int round = 0; round < (watched() ? 40 : 200); ++round) {
    ProgressiveBytes changed = *bytes;
    for (int k = 0; k < 3; ++k) {
      Bytes& of = random() % 4 == 0 ? changed.front : changed.segments[random() % changed.segments.size()];
      of[random() % of.size()] = static_cast<std::byte>(random());
    }
    ProgressiveMesh read;
    if (!read.begin(changed.front, kMax)) continue;
    for (const Bytes& segment : changed.segments) (void)read.add(segment);
    REQUIRE_EACH(read.vertices() <= kMax);
    check_sound(read.mesh());
  }
}

}  // namespace gs::qnv::progressive::progressive_test
