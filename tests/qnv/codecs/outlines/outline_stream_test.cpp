#include "qnv/codecs/outlines/outline_stream.h"
#include "tests/qnv/outline_decoding.h"
#include "tests/qnv/outline_shapes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace {

using namespace outlines;
using shapes::flat_group;
using shapes::square;

std::vector<OutlineAppearance> looks(std::size_t count) {
  std::vector<OutlineAppearance> all(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<std::uint8_t>(10 * i);
    all[i].diffuse = {n, 1, 2};
    all[i].emissive = {3, n, 4};
    all[i].specular = {5, 6, n};
    all[i].ambient_intensity = static_cast<std::uint8_t>(n + 1);
    all[i].shininess = static_cast<std::uint8_t>(n + 2);
    all[i].transparency = static_cast<std::uint8_t>(n + 3);
    all[i].lit = i % 2 == 0;
    all[i].solid = i % 3 == 0;
    all[i].textured = i % 4 == 1;
    all[i].crease_angle = 0.25f * static_cast<float>(i);
    all[i].texture_url = i % 4 == 1 ? "br\xc3\xbc"
                                      "cke.png"
                                    : "";
  }
  return all;
}

/// Returns squares with holes and texture coordinates, all multiples of 1/8. Groups have several outlines, with
/// textured inner polygons in untextured outlines.
OutlineGroups mixed() {
  OutlineGroups groups;
  groups.groups.push_back(flat_group({square({-4, 2, 1.5f}, 10),
                                      {{-3, 3, 1.5f}, {-3, 5, 1.5f}, {-1, 3, 1.5f}},
                                      {{0, 4, 1.5f}, {0, 5, 1.5f}, {1, 5, 1.5f}, {1.125f, 4, 1.5f}, {0.5f, 3, 1.5f}}}));
  OutlineGroup folded;
  folded.appearance = 1;
  folded.area = 32;
  shapes::add_polygon(folded.outline, {square({8, 0, -2}, 4)});
  shapes::add_polygon(folded.outline, {square({12, 4, -2}, 4)});
  shapes::add_polygon(folded.inner, {square({12, 4, -2}, 4)}, {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  shapes::add_polygon(folded.inner, {{{8, 0, -2}, {12, 0, -2}, {12, 4, -1}}}, {{0, 0}, {2.5f, 0}, {-3, 1}});
  shapes::add_polygon(folded.inner, {{{8, 0, -2}, {12, 4, -1}, {8, 4, -2}}}, {{0, 0}, {-3, 1}, {0.25f, 1}});
  groups.groups.push_back(folded);
  groups.groups.push_back(flat_group({square({0, 0, 0}, 0.5f)}, 1, {{0, 0}, {0.5f, 0}, {0.5f, 0.5f}, {0, 0.5f}}));
  groups.groups.push_back(flat_group({{{0, 0, 7}, {1, 0, 7}, {0, 0.125f, 7}}}, 2));
  return groups;
}

std::string error_of(const OutlineGroups& groups, std::span<const OutlineAppearance> appearances = {},
                     const OutlineEncodeOptions& options = {}) {
  const auto result = encode_outlines(groups, appearances, options);
  const auto* error = std::get_if<EncodeError>(&result);
  return error ? error->message : "";
}

TEST_CASE("restores positions on a lattice exactly") {
  const OutlineGroups groups = mixed();
  const EncodedStream stream = encoded(groups, looks(3));
  CHECK(stream.header.outlines.positions.exponent == -3);  // coarser than 16 bits would be
  const std::vector<One> all = sorted(decode_all(stream.bytes));
  CHECK((all == expected(groups, stream.header.outlines)));
  // Given numbers outside the lattice are rounded to it.
  const auto first = std::find_if(all.begin(), all.end(), [](const One& one) { return one.group == 0; });
  CHECK(first->rings[0] == std::vector<Point>{{-4, 2, 1.5f}, {6, 2, 1.5f}, {6, 12, 1.5f}, {-4, 12, 1.5f}});
  CHECK(first->rings[2][3] == Point{1.125f, 4, 1.5f});
  const auto textured = std::find_if(all.begin(), all.end(), [](const One& one) { return one.group == 2; });
  CHECK(textured->texture_coordinates[2] == std::array<float, 2>{0.5f, 0.5f});
}

TEST_CASE("reports its appearances and its contents in the header of a stream") {
  const EncodedStream stream = encoded(mixed(), looks(3), {.metadata = {{"title", "squares"}}});
  OutlineDecoder decoder;
  REQUIRE(decoder.push(stream.bytes));
  decoder.finish();
  const StreamHeader* header = decoder.header();
  REQUIRE(header);
  CHECK(encode_header(*header) == encode_header(stream.header));
  CHECK(header->payload == Payload::outlines);
  CHECK(header->outlines.appearances == looks(3));
  CHECK(header->outlines.groups == 4);
  CHECK(header->outlines.outline_polygons == 5);
  CHECK(header->outlines.inner_polygons == 3);
  CHECK(header->vectors == 6);  // polygons of the complete model
  CHECK(header->description.total == Approx(100 - 2 - 1.59375 + 32 + 0.25 + 0.0625).margin(0.1));
  CHECK(header->description.box == Box{{-4, 0, -2}, {16, 12, 7}});
  CHECK(header->description.two_sided);
  CHECK(header->description.metadata.at(0).second == "squares");
  CHECK(decoder.problems().empty());
  CHECK(decoder.refused_chunks() == 0);
  CHECK(decoder.refused_records() == 0);
  REQUIRE(decoder.directory().size() == header->chunks);
  CHECK(decoder.directory().front().level == 0);
  CHECK(decoder.directory().back().level == 1);
  std::size_t polygons = 0;
  for (const DirectoryEntry& entry : decoder.directory()) polygons += entry.vectors;
  CHECK(polygons == 8);
}

TEST_CASE("encodes whether outlines remain, and the areas of their polygons") {
  const EncodedStream stream = encoded(mixed(), looks(3));
  OutlineDecoder decoder;
  (void)decoder.push(stream.bytes);
  std::size_t staying = 0;
  for (const OutlineBatch& batch : decoder.take())
    for (std::size_t i = 0; i < batch.polygons.size(); ++i) {
      if (batch.stays(i)) ++staying;
      if (!batch.inner && batch.groups[i] == 1) CHECK(batch.counts[i] == 3);
      if (batch.groups[i] == 2) CHECK(batch.polygons.areas[i] == Approx(0.25));
      if (batch.groups[i] == 0) CHECK(batch.polygons.areas[i] == Approx(100 - 2 - 1.59375).margin(0.2));
    }
  CHECK(staying == 3);
  CHECK(decoder.take().empty());
}

TEST_CASE("rounds every position to the nearest lattice point, for any number of bits") {
  const OutlineGroups sphere = shapes::sphere(21, 20, 5, 3);
  for (const int bits : {8, 12, 16, 24, 30}) {
    const EncodedStream stream = encoded(sphere, looks(3), {.position_bits = bits});
    const OutlineLattice<3>& lattice = stream.header.outlines.positions;
    CHECK(lattice.step() <= std::ldexp(2.0, 1 - bits) * 2);
    for (const std::uint32_t size : lattice.size) CHECK(size < std::uint32_t{1} << bits);
    CHECK((sorted(decode_all(stream.bytes)) == expected(sphere, stream.header.outlines)));
    // The error per axis is at most half a step plus f32 rounding, so below one step.
    for (const One& one : decode_all(stream.bytes))
      for (const auto& ring : one.rings)
        for (const Point& p : ring)
          CHECK(std::abs(std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1) <= 0.9 * lattice.step() + 1e-6);
  }
}

TEST_CASE("restores distant, tiny and huge models in any direction") {
  std::mt19937 random(6);
  for (const float scale : {1e-40f, 1e-30f, 1.0f, 1e6f, 1e33f})
    for (const float away : {0.0f, 1.0f, 1000.0f}) {
      OutlineGroups groups = shapes::rectangles(40, random(), false);
      for (OutlineGroup& group : groups.groups)
        for (glm::vec3& p : group.outline.positions) p = (p + away * glm::vec3(100, -100, 50)) * scale;
      const EncodedStream stream = encoded(groups, {}, {.position_bits = 14});
      CHECK((sorted(decode_all(stream.bytes)) == expected(groups, stream.header.outlines)));
    }
}

TEST_CASE("restores rings of any length, with holes and texture coordinates") {
  std::mt19937 random(8);
  const auto number = [&](int most) { return static_cast<float>(random() % static_cast<unsigned>(most)) / 16; };
  OutlineGroups groups;
  for (int i = 0; i < 300; ++i) {
    std::vector<shapes::Ring> rings(1 + random() % 4);
    std::vector<glm::vec2> coordinates;
    for (shapes::Ring& ring : rings) {
      for (std::size_t size = 3 + random() % (i % 50 == 0 ? 2000 : 9); size > 0; --size) {
        glm::vec3 p(number(4000), number(1 << (i % 20)), number(16));
        if (!ring.empty() && ring.back() == p) p.x += 1;
        ring.push_back(p);
        coordinates.emplace_back(number(20) - 1, number(2000));
      }
      if (ring.front() == ring.back()) ring.back().x += 1000;
    }
    groups.groups.push_back(
        flat_group(rings, static_cast<std::uint32_t>(i % 3), i % 3 == 1 ? coordinates : std::vector<glm::vec2>{}));
  }
  const EncodedStream stream = encoded(groups, looks(3));
  CHECK((sorted(decode_all(stream.bytes)) == expected(groups, stream.header.outlines)));
}

TEST_CASE("sorts outlines by the area of their groups, before the inner polygons of each group") {
  OutlineGroups sphere = shapes::sphere(41, 40, 10);
  std::stable_sort(sphere.groups.begin(), sphere.groups.end(),
                   [](const auto& a, const auto& b) { return a.area > b.area; });
  const std::vector<One> all = decode_all(encoded(sphere).bytes);
  REQUIRE(all.size() == 20 + 40 * 40 * 2);
  for (std::size_t i = 0; i < all.size(); ++i) REQUIRE(all[i].inner == (i >= 20));
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (i != 20) REQUIRE(all[i].group >= all[i - 1].group);
    // Within a group, the largest polygon is first.
    if (all[i].inner && all[i].group == all[i - 1].group && all[i - 1].inner) {
      const auto area = [](const One& one) {
        std::vector<shapes::Ring> rings(1);
        for (const Point& p : one.rings[0]) rings[0].emplace_back(p[0], p[1], p[2]);
        return shapes::area_of(rings);
      };
      REQUIRE(area(all[i]) <= area(all[i - 1]) * 1.01 + 1e-7);
    }
  }
}

TEST_CASE("sorts chunks of several appearances by their largest polygon, and keeps them short") {
  OutlineGroups sphere = shapes::sphere(61, 60, 4, 5);
  const EncodedStream stream = encoded(sphere, looks(5));
  double before = std::numeric_limits<double>::infinity();
  bool inner = false;
  for (const ChunkAt& chunk : chunks_of(stream.bytes)) {
    if (chunk.type == ChunkType::directory) continue;
    CHECK(chunk.payload.size() <= 1200);
    OutlineDecoder decoder;
    (void)decoder.push(header_of(stream.bytes));
    decoder.add(chunk.type, chunk.payload);
    const std::vector<One> all = take(decoder);
    REQUIRE_FALSE(all.empty());
    if (!std::exchange(inner, all[0].inner) && inner) before = std::numeric_limits<double>::infinity();
    REQUIRE(all[0].inner == inner);  // never returns to outlines
    REQUIRE(sphere.groups[all[0].group].area <= before);
    before = sphere.groups[all[0].group].area;
  }
}

TEST_CASE("encodes the same bytes on any number of threads, and fewer on request") {
  const OutlineGroups sphere = shapes::sphere(101, 100, 25, 2);
  const EncodedStream one = encoded(sphere, looks(2), {.threads = 1});
  CHECK((one.bytes == encoded(sphere, looks(2), {.threads = 3}).bytes));
  CHECK((sorted(decode_all(one.bytes)) == expected(sphere, one.header.outlines)));
  const EncodedStream short_one = encoded(sphere, looks(2), {.max_bytes = 20000});
  CHECK(short_one.bytes.size() <= 20000);
  CHECK(short_one.bytes.size() > 18000);
  const std::vector<One> all = sorted(decode_all(short_one.bytes)), whole = sorted(decode_all(one.bytes));
  CHECK(std::includes(whole.begin(), whole.end(), all.begin(), all.end()));
  CHECK(std::count_if(all.begin(), all.end(), [](const One& o) { return !o.inner; }) == 20);
}

TEST_CASE("leaves out polygons without area on the lattice and counts them") {
  OutlineGroups groups;
  groups.groups.push_back(flat_group({square({0, 0, 0}, 100)}));
  OutlineGroup tiny = flat_group({square({3, 3, 1}, 10)});
  shapes::add_polygon(tiny.inner, {square({3, 3, 1}, 10)});
  shapes::add_polygon(tiny.inner, {square({4, 4, 1}, 0.001f)});
  shapes::add_polygon(tiny.inner, {{{5, 5, 1}, {6, 6, 1}, {7, 7, 1}}});
  shapes::add_polygon(tiny.inner, {{{5, 5, 1}, {6, 6, 1}, {std::numeric_limits<float>::quiet_NaN(), 7, 1}}});
  groups.groups.push_back(tiny);
  OutlineGroup gone = flat_group({square({20, 20, 1}, 5)});
  shapes::add_polygon(gone.inner, {square({20, 20, 1}, 0.001f)});
  groups.groups.push_back(gone);
  const std::vector<One> all = sorted(decode_all(encoded(groups, {}, {.position_bits = 10}).bytes));
  REQUIRE(all.size() == 4);
  CHECK(all[0].count == 0);
  CHECK(all[1].count == 1);
  CHECK(all[2].count == 0);  // no inner polygon replaces the outline, so it remains
  CHECK(all[3].inner);
}

TEST_CASE("drops corners and holes of rings that coincide with others") {
  OutlineGroups groups;
  groups.groups.push_back(
      flat_group({{{0, 0, 0}, {100, 0, 0}, {100.0001f, 0.0001f, 0}, {100, 100, 0}, {0, 100, 0}, {0.0001f, 0, 0}},
                  {{50, 50, 0}, {50.0001f, 50, 0}, {50, 50.0001f, 0}},
                  square({10, 10, 0}, 5)}));
  const std::vector<One> all = decode_all(encoded(groups, {}, {.position_bits = 10}).bytes);
  REQUIRE(all.size() == 1);
  REQUIRE(all[0].rings.size() == 2);
  CHECK(all[0].rings[0] == std::vector<Point>{{0, 0, 0}, {100, 0, 0}, {100, 100, 0}, {0, 100, 0}});
  CHECK(all[0].rings[1][0] == Point{10, 10, 0});
}

TEST_CASE("cuts a polygon that no record can hold, without loss") {
  // A comb with a hole in every other tooth.
  shapes::Ring comb;
  std::vector<shapes::Ring> rings(1);
  constexpr int kTeeth = 6000;
  for (int i = 0; i < kTeeth; ++i) {
    const auto x = static_cast<float>(4 * i);
    for (const auto& [dx, y] : {std::pair{0, 10}, std::pair{1, 40 + i % 7}, std::pair{2, 41 + i % 5}, std::pair{3, 10}})
      comb.emplace_back(x + static_cast<float>(dx), y, 0);
    if (i % 2 == 0) rings.push_back({{x + 1, 3, 0}, {x + 1, 5, 0}, {x + 2, 4, 0}});
  }
  comb.emplace_back(4 * kTeeth, 0, 0);
  comb.emplace_back(0, 0, 0);
  std::reverse(comb.begin(), comb.end());
  rings[0] = comb;
  OutlineGroups groups;
  groups.groups.push_back(flat_group(rings));
  groups.groups.push_back(flat_group({square({0, 0, 1}, 1)}));
  const EncodedStream stream = encoded(groups);
  CHECK(stream.header.outlines.positions.exponent == 0);
  const std::vector<One> all = decode_all(stream.bytes);
  CHECK(all.size() > 3);
  double area = 0;
  std::size_t holes = 0;
  for (const One& one : all) {
    if (one.group != 0) continue;
    std::vector<shapes::Ring> pieces;
    for (const auto& ring : one.rings) {
      shapes::Ring& piece = pieces.emplace_back();
      for (const Point& p : ring) piece.emplace_back(p[0], p[1], p[2]);
    }
    holes += pieces.size() - 1;
    area += shapes::area_of(pieces);
  }
  CHECK(area == Approx(groups.groups[0].area).epsilon(1e-4));
  CHECK(holes >= kTeeth / 2 - 20);
}

TEST_CASE("fits the longest uncut polygons into a chunk, whatever their corners are") {
  std::mt19937 random(9);
  for (const int bits : {16, 30}) {
    OutlineGroups groups;
    for (int i = 0; i < 4; ++i) {
      shapes::Ring ring;
      std::vector<glm::vec2> coordinates;
      const std::size_t size = bits == 16 ? 4000 : 2700;
      for (std::size_t corner = 0; corner < size; ++corner) {
        // Uniform scales, and scales with few large differences.
        const float scale = i < 2 || random() % 50 == 0 ? 1000.0f : 1.0f;
        const auto number = [&] { return scale * static_cast<float>(random() % 1000003) / 1000003; };
        ring.emplace_back(number(), number(), number());
        coordinates.emplace_back(number(), number());
      }
      groups.groups.push_back(flat_group({ring}, 1, coordinates));
    }
    const EncodedStream stream = encoded(groups, looks(2), {.position_bits = bits});
    CHECK((sorted(decode_all(stream.bytes)) == expected(groups, stream.header.outlines)));
    // Twice as many corners cannot be cut, since edges cross everywhere.
    OutlinePolygons& polygons = groups.groups[0].outline;
    const shapes::Ring ring = polygons.positions;
    polygons = {};
    shapes::Ring longer = ring;
    longer.insert(longer.end(), ring.rbegin(), ring.rend());
    for (std::size_t i = 0; i < longer.size(); ++i) longer[i].x += static_cast<float>(i % 7);
    shapes::add_polygon(polygons, {longer});
    CHECK(error_of(groups, looks(2), {.position_bits = bits}).find("because its rings cross") != std::string::npos);
  }
}

TEST_CASE("reports why outlines cannot be encoded") {
  OutlineGroups groups = mixed();
  CHECK(error_of(groups) == "group 1 names appearance 1; expected less than 1");
  CHECK(error_of(OutlineGroups()) == "no finite polygon close enough to the origin for the size of the model");
  groups.groups[1].inner.areas.pop_back();
  CHECK(error_of(groups, looks(3)) == "group 1 has a number of areas that differs from its polygons");
  groups = mixed();
  groups.groups[3].outline.positions.pop_back();
  CHECK(error_of(groups, looks(3)) == "group 3 has ring ends that do not ascend to the number of positions");
  groups = mixed();
  groups.groups[2].outline.texture_coordinates.pop_back();
  CHECK(error_of(groups, looks(3)) == "group 2 has a number of texture coordinates that differs from its positions");
  CHECK(error_of(mixed(), looks(65536)) == "65536 appearances; expected at most 65535");
  CHECK(error_of(mixed(), looks(60000)).find("bytes; expected at most 1048576") != std::string::npos);
  // A plane of x = 1e30 with sides of 1: its lattice is 2^84 steps from the origin.
  groups.groups = {flat_group({{{1e30f, 0, 0}, {1e30f, 1.1f, 0}, {1e30f, 0, 1.1f}}})};
  CHECK(error_of(groups) == "no finite polygon close enough to the origin for the size of the model");
  groups.groups = {flat_group({{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}})};
  CHECK(error_of(groups) == "no polygon has an area at this precision");
  Progress progress;
  progress.cancelled = true;
  const auto cancelled = encode_outlines(mixed(), looks(3), {}, &progress);
  REQUIRE(std::holds_alternative<EncodeError>(cancelled));
  CHECK(std::get<EncodeError>(cancelled).message == "cancelled");
}

TEST_CASE("drops only invalid texture coordinates") {
  OutlineGroups groups = mixed();
  groups.groups[2].outline.texture_coordinates[1] = {std::numeric_limits<float>::quiet_NaN(), 1e30f};
  const EncodedStream stream = encoded(groups, looks(3));
  const std::vector<One> all = decode_all(stream.bytes);
  const auto one = std::find_if(all.begin(), all.end(), [](const One& o) { return o.group == 2; });
  CHECK(one->texture_coordinates[1] == std::array<float, 2>{0, 0});
  CHECK(one->texture_coordinates[2] == std::array<float, 2>{0.5f, 0.5f});
}

}  // namespace
}  // namespace gs::qnv
