#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/displaced/encode/stage_encode.h"

#include "qnv/codecs/displaced/cluster_coder.h"
#include "qnv/codecs/displaced/subdivision.h"
#include "qnv/mesh/simplify/simplify.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"
#include "tests/watched.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

namespace gs::qnv::displaced::surface_test {
namespace {

/// Returns a stage of a mesh's triangles, with creases at edges with numbers that `every` divides (0: none).
StageHeader stage_of(const SurfaceMesh& mesh, int depth, std::size_t every = 0) {
  StageHeader stage;
  stage.depth = depth;
  stage.colored = true;
  stage.base.bits = 10;
  stage.base.triangles = mesh.triangles;
  Box box;
  for (const glm::vec3& p : mesh.positions) box.add(p);
  const Frame frame(box);
  for (const glm::vec3& p : mesh.positions)
    stage.base.vertices.push_back(glm::clamp(glm::ivec3(frame.inside(p) * 1024.0f), 0, 1023));
  const Patches patches(mesh.triangles, static_cast<std::uint32_t>(mesh.positions.size()));
  if (every > 0)
    for (std::size_t e = 0; e < patches.edges().size(); ++e)
      stage.base.creases.push_back(e % every == 0 && patches.edges()[e].other != kNone);
  return stage;
}

struct Made {
  ClusterHeader header;
  std::vector<std::byte> payload;
};

/// Fills all numbers that a cluster may contain, mostly small or 0.
void fill(Surface& surface, std::uint32_t seed, int layers) {
  std::mt19937 random(seed);
  const auto number = [&]() -> std::int16_t {
    const auto kind = random() % 100;
    if (kind < 70) return 0;
    if (kind == 99) return static_cast<std::int16_t>(random() % 65535 - 32767);
    return static_cast<std::int16_t>(random() % 11) - 5;
  };
  const Patches& patches = surface.patches();
  for (int level = 0; level <= surface.header().depth; ++level) {
    const auto fresh = [&](auto&& set) {
      if (level == 0)
        for (std::uint32_t v = 0; v < patches.base_vertices(); ++v) set(NewVertex{v, v, v});
      else
        visit_level(patches, surface.slots(), level, set, [](std::uint32_t, std::uint32_t) {});
    };
    for (int layer = 0; layer < layers; ++layer) {
      LevelNumbers& numbers = surface.numbers(layer, level);
      fresh([&](const NewVertex& v) {
        numbers.normal[v.vertex] = number();
        if (v.edge != kNone && patches.edges()[v.edge].line())
          numbers.sideways[v.vertex - patches.base_vertices()] = number();
      });
    }
    for (NumberArray& channel : surface.colors(level)) fresh([&](const NewVertex& v) { channel[v.vertex] = number(); });
  }
}

/// Returns all numbers in clusters of `run` patches.
std::vector<Made> clusters_of(Surface& surface, int layers, std::uint32_t run) {
  std::vector<Made> out;
  for (int level = 1; level <= surface.header().depth; ++level)
    for (std::uint32_t first = 0; first < surface.patches().size(); first += run) {
      ClusterHeader header;
      header.level = level;
      header.first = first;
      header.count = std::min(run, surface.patches().size() - first);
      for (header.layer = 0; header.layer < layers; ++header.layer) out.push_back({header, {}});
      header.layer = 0;
      header.kind = ClusterHeader::Kind::color;
      out.push_back({header, {}});
    }
  for (Made& made : out) made.payload = encode_cluster(surface, made.header);
  return out;
}

bool add(Surface& surface, std::span<const std::byte> payload) {
  const auto header = decode_cluster_header(payload);
  return header && surface.add(*header, payload);
}

bool same(const NumberArray& a, const NumberArray& b, std::size_t size) {
  if (a.empty() || b.empty()) return a.empty() && b.empty();
  for (std::size_t i = 0; i < size; ++i)
    if (a[i] != b[i]) return false;
  return true;
}

bool same_numbers(Surface& a, Surface& b, int layers) {
  for (int level = 0; level <= a.header().depth; ++level) {
    for (int layer = 0; layer < layers; ++layer) {
      const LevelNumbers &x = a.numbers(layer, level), &y = b.numbers(layer, level);
      if (!same(x.normal, y.normal, x.normal.size()) || !same(x.sideways, y.sideways, x.sideways.size())) return false;
    }
    for (std::size_t c = 0; c < 3; ++c)
      if (!same(a.colors(level)[c], b.colors(level)[c], a.colors(level)[c].size())) return false;
  }
  return true;
}

SurfaceMesh shape(int which) {
  return which == 0 ? mesh_of(ball(2)) : which == 1 ? mesh_of(torus(6, 4)) : simplify(mesh_of(sheet(20)), 40);
}

}  // namespace

TEST_CASE("restores the numbers of clusters, whatever their patch ranges are") {
  for (int which = 0; which < 3; ++which)
    for (const std::size_t creases : {0, 4})
      for (const std::uint32_t run : {1u, 5u, 1000u}) {
        INFO(which << " " << creases << " " << run);
        const StageHeader stage = stage_of(shape(which), 4, creases);
        Surface source(stage), copy(stage);
        fill(source, static_cast<std::uint32_t>(which), 3);
        for (const Made& made : clusters_of(source, 3, run)) REQUIRE(add(copy, made.payload));
        CHECK(same_numbers(source, copy, 3));
        CHECK(copy.positions(4) == source.positions(4));
        CHECK(copy.vertex_colors(4) == source.vertex_colors(4));
      }
}

TEST_CASE("restores the header of a stage, and rejects impossible ones") {
  StageHeader stage = stage_of(shape(0), 5);
  stage.step_exponent = 13;
  stage.clusters = 255;
  const CodedBase coded = encode_base(stage.base, [](std::uint32_t, std::uint32_t) { return false; });
  const std::vector<std::byte> bytes = encode_stage(stage, coded.bytes);
  const auto decoded = decode_stage(bytes);
  REQUIRE(decoded);
  CHECK(decoded->depth == 5);
  CHECK(decoded->step_exponent == 13);
  CHECK(decoded->colored);
  CHECK(decoded->clusters == 255);
  CHECK(decoded->base.triangles == coded.mesh.triangles);
  const auto with = [&](std::size_t at, int value) {
    std::vector<std::byte> other = bytes;
    other[at] = static_cast<std::byte>(value);
    return decode_stage(other).has_value();
  };
  CHECK(with(0, 8));
  CHECK(!with(0, 9));
  CHECK(!with(1, 0));
  CHECK(with(1, 24));
  CHECK(!with(1, 25));
  CHECK(with(2, 2));
  CHECK(!with(2, 4));
  CHECK(!with(4, 0));
  CHECK(!decode_stage(std::span(bytes).first(4)));
  CHECK(!decode_stage({}));
}

TEST_CASE("restores cluster headers, and rejects impossible ones") {
  for (const int level : {1, 4, 8})
    for (const int layer : {0, 3})
      for (const std::uint32_t first : {0u, 127u, 128u, 131071u})
        for (const std::uint32_t count : {1u, 300u, 131072u}) {
          ClusterHeader header{ClusterHeader::Kind::color, 15, level, layer, first, count, 0};
          const std::vector<std::byte> bytes = encode_cluster_header(header);
          const auto decoded = decode_cluster_header(bytes);
          REQUIRE(decoded);
          CHECK(decoded->kind == header.kind);
          CHECK(decoded->stage == 15);
          CHECK(decoded->level == level);
          CHECK(decoded->layer == layer);
          CHECK(decoded->first == first);
          CHECK(decoded->count == count);
          CHECK(decoded->bytes == bytes.size());
          for (std::size_t length = 0; length < bytes.size(); ++length)
            CHECK(!decode_cluster_header(std::span(bytes).first(length)));
        }
  const auto refused = [](std::vector<int> bytes) {
    std::vector<std::byte> all;
    for (const int b : bytes) all.push_back(static_cast<std::byte>(b));
    return !decode_cluster_header(all);
  };
  CHECK(!refused({0x01, 0x01, 0, 1}));
  CHECK(refused({0x03, 0x01, 0, 1}));                          // kind
  CHECK(refused({0x01, 0x00, 0, 1}));                          // level
  CHECK(refused({0x01, 0x09, 0, 1}));                          // level
  CHECK(refused({0x01, 0x41, 0, 1}));                          // layer
  CHECK(refused({0x01, 0x01, 0, 0}));                          // no patches
  CHECK(refused({0x01, 0x01, 0xff, 0xff, 0xff, 0xff, 1, 1}));  // a number without end
  CHECK(refused({0x01, 0x01, 0xff, 0xff, 0xff, 0x7f, 1}));     // first patch
  CHECK(refused({0x01, 0x01, 0, 0xff, 0xff, 0xff, 0x7f}));     // number of patches
}

TEST_CASE("leaves no cracks whichever clusters are received") {
  std::mt19937 random(3);
  for (int which = 0; which < 3; ++which) {
    const StageHeader stage = stage_of(shape(which), 4, 5);
    Surface source(stage);
    fill(source, 40 + static_cast<std::uint32_t>(which), 2);
    const std::vector<Made> clusters = clusters_of(source, 2, 3);
    for (std::size_t round = 0; round < 12; round += watched_step(4)) {
      Surface part(stage);
      for (const Made& made : clusters)
        if (random() % 12 < round) REQUIRE(add(part, made.payload));
      for (const int level : {2, 4}) {
        // Vertices by slot: one per corner of the base, and a position for each vertex.
        const std::vector<std::uint32_t> vertex_of = part.vertices_of_slots(level), slots = part.triangles(level);
        std::vector<Corners> triangles;
        for (std::size_t i = 0; i < slots.size(); i += 3)
          triangles.push_back({vertex_of[slots[i]], vertex_of[slots[i + 1]], vertex_of[slots[i + 2]]});
        CHECK(triangles.size() == stage.base.triangles.size() << (2 * level));
        CHECK(sides_once(triangles));
        CHECK(rims_of(triangles) == rims_of(stage.base.triangles) << level);
        CHECK(euler_characteristic(triangles) == euler_characteristic(stage.base.triangles));
        for (const glm::vec3& p : part.positions(level)) REQUIRE_EACH(std::isfinite(p.x + p.y + p.z));
      }
    }
  }
}

TEST_CASE("shares the vertices of a level with the level above") {
  const StageHeader stage = stage_of(shape(2), 4, 5);
  Surface surface(stage);
  fill(surface, 8, 2);
  for (int level = 1; level <= 4; ++level) {
    const auto before = surface.positions(level - 1), now = surface.positions(level);
    visit_level(
        surface.patches(), surface.slots(), level, [](const NewVertex&) {},
        [&](std::uint32_t v, std::uint32_t was) { REQUIRE_EACH(now[v] == before[was]); });
  }
}

TEST_CASE("accepts a cluster once, and rejects clusters that do not fit") {
  const StageHeader stage = stage_of(shape(0), 2);
  Surface source(stage), copy(stage);
  fill(source, 1, 1);
  for (const Made& made : clusters_of(source, 1, 8)) {
    CHECK(add(copy, made.payload));
    const std::size_t bytes = copy.cluster_bytes();
    CHECK(!add(copy, made.payload));
    CHECK(copy.cluster_bytes() == bytes);
  }
  ClusterHeader header;
  const auto refused = [&](int level, std::uint32_t first, std::uint32_t count) {
    Surface fresh(stage);
    header.level = level;
    header.first = first;
    header.count = count;
    std::vector<std::byte> payload = encode_cluster_header(header);
    payload.resize(payload.size() + 400, std::byte{0xff});
    return !add(fresh, payload);
  };
  CHECK(!refused(2, 0, 32));
  CHECK(refused(3, 0, 1));
  CHECK(refused(1, 32, 1));
  CHECK(refused(1, 31, 2));
  StageHeader grey = stage;
  grey.colored = false;
  Surface without(grey);
  header = {ClusterHeader::Kind::color, 0, 1, 0, 0, 1, 0};
  std::vector<std::byte> payload = encode_cluster_header(header);
  payload.resize(40);
  CHECK(!add(without, payload));
}

TEST_CASE("decodes prefixes and mutations of clusters to finite numbers or rejects them") {
  const StageHeader stage = stage_of(shape(2), 5, 4);
  Surface source(stage);
  fill(source, 21, 1);
  std::mt19937 random(4);
  for (const Made& made : clusters_of(source, 1, 12)) {
    for (std::size_t length = 0; length < made.payload.size(); length += watched_step(5)) {
      Surface part(stage);
      (void)add(part, std::span(made.payload).first(length));
      if (length % 64 == 0)
        for (const glm::vec3& p : part.positions(5)) REQUIRE_EACH(std::isfinite(p.x + p.y + p.z));
    }
    for (std::size_t round = 0; round < 150; round += watched_step(3)) {
      std::vector<std::byte> mutated = made.payload;
      for (std::size_t i = 0; i <= round % 4; ++i)
        mutated[random() % std::min<std::size_t>(mutated.size(), round % 2 ? 6 : 100000)] =
            static_cast<std::byte>(random());
      Surface part(stage);
      (void)add(part, mutated);
    }
  }
}

TEST_CASE("gives finite positions for a surface at one point or without area") {
  StageHeader stage = stage_of(shape(0), 3);
  for (glm::ivec3& v : stage.base.vertices) v = {3, 3, 3};
  Surface surface(stage);
  fill(surface, 2, 4);
  for (const glm::vec3& p : surface.positions(3)) CHECK(std::isfinite(p.x + p.y + p.z));
  const Frame point(Box{glm::vec3(7), glm::vec3(7)});
  CHECK(point.outside(glm::vec3(0.5f)) == glm::vec3(7));
  CHECK(point.inside(glm::vec3(7)) == glm::vec3(0));
}

TEST_CASE("reads missing pages of numbers as 0 without allocating them") {
  NumberArray numbers;
  CHECK(numbers.empty());
  numbers.assign_zeros(std::size_t{1} << 20);
  const NumberArray& read = numbers;
  CHECK(read[1 << 19] == 0);
  numbers[5000] = -3;
  CHECK(read[5000] == -3);
  CHECK(read[5001] == 0);
  CHECK(numbers.any(4999, 2));
  CHECK(!numbers.any(5001, 9000));
  numbers.fill_pages();
  CHECK(read[5000] == -3);
}

}  // namespace gs::qnv::displaced::surface_test
