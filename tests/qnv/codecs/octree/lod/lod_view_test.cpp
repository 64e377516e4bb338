#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/lod_streams.h"

#include <glm/geometric.hpp>

#include <set>

// Tests of the results and the cache of a view.
namespace gs::qnv {
namespace {

std::set<std::array<float, 3>> facing(const std::vector<Piece>& pieces, const glm::vec3& eye) {
  std::set<std::array<float, 3>> out;
  for (const Piece& piece : pieces)
    for (std::size_t i = piece.first; i < piece.first + piece.count; ++i) {
      const glm::vec3& p = piece.splats->positions[i];
      if (glm::dot(piece.splats->normals[i], p - eye) <= 0) out.insert({p.x, p.y, p.z});
    }
  return out;
}

float finest_edge(const std::vector<Piece>& pieces) {
  float finest = 1e9f;
  for (const Piece& piece : pieces) finest = std::min(finest, piece.splats->cells[piece.first].edge);
  return finest;
}

}  // namespace

TEST_CASE("returns all vectors of the decoder") {
  const EncodedStream stream = stream_of(bumpy_sphere(60), 20'000);
  StreamDecoder decoder;
  REQUIRE(decoder.push(stream.bytes));
  const Splats expected = content_of<Splats>(decoder.geometry());
  const auto lod = opened_there(stream.bytes);
  const Splats all = lod->whole();
  CHECK(all.description == stream.header.description);
  CHECK(places(all.positions) == places(expected.positions));
  CHECK(total_weight(all) == Approx(total_weight(expected)));
  CHECK(all.cells.size() == all.size());
  CHECK(lod->count() == expected.size());
  CHECK(lod->statistics().cached_bytes == 0);
}

TEST_CASE("reports level, chunk and age of each piece of a cut") {
  const EncodedStream& stream = sphere_stream(60'000);
  const auto lod = opened_there(stream.bytes);
  LodView view = from({0, 0, 1.5f}, 300);
  view.each_chunk = true;
  const auto apart = lod->cut(view);
  std::set<std::uint32_t> chunks;
  std::set<int> levels;
  for (const Piece& piece : apart) {
    chunks.insert(piece.chunk);
    levels.insert(piece.level);
    REQUIRE(piece.count > 0);
    REQUIRE(piece.first + piece.count <= piece.splats->size());
    const float edge = stream.header.cube.edge / static_cast<float>(1 << piece.level);
    for (std::size_t i = piece.first; i < piece.first + piece.count; ++i)
      REQUIRE(piece.splats->cells[i].edge == Approx(edge));
    // The encoder numbers chunks in order.
    CHECK(piece.age == Approx(static_cast<double>(piece.chunk) / (stream.header.chunks - 1)));
    CHECK(piece.chunk < stream.header.chunks);
  }
  CHECK(chunks.size() > 20);
  CHECK(levels.size() > 1);
  // Joined pieces have the same content.
  view.each_chunk = false;
  const auto joined = lod->cut(view);
  CHECK(places(joined) == places(apart));
  CHECK(joined.size() < apart.size());
  CHECK(chunks.size() <= apart.size());
}

TEST_CASE("decodes at most the allowed vectors per cut until the view is complete") {
  const EncodedStream& stream = sphere_stream(60'000);
  const auto at_once = opened_there(stream.bytes), step_by_step = opened_there(stream.bytes);
  LodView view = from({0, 0, 1.5f}, 500);
  const auto whole = places(at_once->cut(view));
  CHECK(at_once->complete());
  CHECK(at_once->statistics().decoded > 20'000);
  view.most_decoded = 4200;
  std::size_t before = 0, steps = 0;
  float finest = 1e9f;
  for (; steps < 100; ++steps) {
    const auto pieces = step_by_step->cut(view);
    CHECK(step_by_step->statistics().decoded <= 4200);
    CHECK(area(pieces) == Approx(kSphereArea).epsilon(0.06));
    CHECK(count(pieces) > before);
    CHECK(finest_edge(pieces) <= finest);
    before = count(pieces);
    finest = finest_edge(pieces);
    CHECK(step_by_step->complete() == !step_by_step->pending());
    if (step_by_step->complete()) break;
  }
  CHECK(steps > 3);
  CHECK(steps < 60);
  CHECK(places(step_by_step->cut(view)) == whole);
  CHECK(step_by_step->statistics().decoded == 0);
  // Each cut decodes at least one cluster.
  const auto slow = opened_there(stream.bytes);
  view.most_decoded = 1;
  before = 0;
  for (int i = 0; i < 10; ++i) {
    const std::size_t now = count(slow->cut(view));
    CHECK(now > before);
    before = now;
  }
}

TEST_CASE("fills a tight budget, and keeps the cut of an unchanged view") {
  const EncodedStream& stream = sphere_stream(60'000);
  for (const std::size_t allowed : {0u, 1500u}) {
    const auto lod = opened_there(stream.bytes);
    LodView view = from({0.2f, 0.1f, 1.4f}, 5000);
    view.budget = 10'000;
    view.most_decoded = allowed;
    std::set<std::array<float, 3>> before;
    std::size_t discs = 0;
    for (int i = 0; i < 30; ++i) {
      const auto pieces = lod->cut(view);
      CHECK(count(pieces) <= view.budget);
      CHECK(count(pieces) >= discs);
      discs = count(pieces);
      CHECK(area(pieces) == Approx(kSphereArea).epsilon(0.06));
    }
    CHECK(lod->complete());
    CHECK(discs > 9000);
    const auto last = places(lod->cut(view));
    CHECK(places(lod->cut(view)) == last);
    // Other views do not change the cut of this view.
    LodView other = from({0, -1.3f, 0}, 5000);
    other.budget = 10'000;
    other.viewport = 7;
    (void)lod->cut(other);
    CHECK(places(lod->cut(view)) == last);
  }
}

TEST_CASE("keeps existing detail until it is clearly too fine", "[optimised]") {
  const EncodedStream& stream = sphere_stream(400'000);
  const auto fresh = [&](const LodView& view) { return count(opened_there(stream.bytes)->cut(view)); };
  const auto lod = opened_there(stream.bytes);
  LodView view = from({0, 0, 3}, 300);
  const auto at_three = places(lod->cut(view));
  view.eye.z = 3.3f;
  const auto further = places(lod->cut(view));
  CHECK(further == at_three);
  CHECK(fresh(view) < further.size());
  view.eye.z = 3;
  CHECK(places(lod->cut(view)) == at_three);
  // At less than half the size, the extra detail is dropped.
  view.eye.z = 8;
  CHECK(count(lod->cut(view)) == fresh(view));
  // A viewport does not show detail that another viewport keeps.
  LodView kept = from({0, 0, 3.3f}, 300), other = kept;
  other.viewport = 1;
  (void)lod->cut(from({0, 0, 3}, 300));
  CHECK(count(lod->cut(kept)) == at_three.size());
  CHECK(count(lod->cut(other)) == fresh(other));
  // The detail is dropped when its viewport closes.
  lod->forget(0);
  CHECK(count(lod->cut(kept)) == fresh(kept));
  (void)lod->cut(from({0, 0, 3}, 300));
  for (std::uint32_t i = 10; i < 30; ++i) {
    other.viewport = i;
    CHECK(count(lod->cut(other)) == fresh(other));
  }
  CHECK(count(lod->cut(kept)) == fresh(kept));
}

TEST_CASE("leaves out only clusters that face away", "[optimised]") {
  const EncodedStream stream = stream_of(bumpy_sphere(200), 100'000);
  const auto lod = opened_there(stream.bytes), all = opened_there(stream.bytes);
  REQUIRE_FALSE(stream.header.description.two_sided);
  std::size_t left = 0, discs = 0;
  for (int i = 0; i < 20; ++i) {
    const float a = static_cast<float>(i) * 1.3f, b = static_cast<float>(i) * 0.7f;
    const glm::vec3 eye =
        glm::vec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)) * (i % 2 == 0 ? 1.3f : 6.0f);
    LodView view = from(eye, i % 3 == 0 ? 300.0f : 3000.0f);
    const auto everywhere = all->cut(view);
    view.leave_backs = true;
    const auto fronts = lod->cut(view);
    // All front-facing splats are drawn at the same detail.
    CHECK(facing(fronts, eye) == facing(everywhere, eye));
    left += count(fronts);
    discs += count(everywhere);
  }
  CHECK(left < discs * 9 / 10);  // clusters are large relative to a small object
  // For a two-sided sheet, all splats are drawn.
  const EncodedStream sheet = stream_of({triangle_of({0, 0, 0}, {1, 0, 0}, {0, 1, 0})}, 5000, true);
  const auto both = opened_there(sheet.bytes);
  LodView behind = everything();
  behind.eye = {0.3f, 0.3f, -5};
  behind.leave_backs = true;
  CHECK(area(both->cut(behind)) == Approx(0.5).epsilon(0.1));
}

TEST_CASE("keeps the budget for thin sheets with two splats per voxel") {
  Triangles plate = box_shape({-1, -1, -0.001f}, {1, 1, 0.001f}, 20);
  const EncodedStream stream = stream_of(plate, 60'000);
  const auto lod = opened_there(stream.bytes);
  for (const std::size_t budget : {3000u, 5000u, 9000u, 20'000u}) {
    LodView view = everything();
    view.budget = budget;
    const auto pieces = lod->cut(view);
    CHECK(count(pieces) <= budget);
    CHECK(count(pieces) > 2000);  // in the first cluster
    CHECK(area(pieces) == Approx(8).epsilon(0.15));
  }
}

TEST_CASE("returns a picture or none for views with invalid numbers") {
  const auto lod = opened_there(sphere_stream(20'000).bytes);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, inf, -inf, -1.0f, 1e38f, 0.0f})
    for (int which = 0; which < 4; ++which) {
      LodView view;
      view.leave_backs = true;
      if (which == 0) view.eye = {bad, 0, bad};
      if (which == 1) view.pixels = bad;
      if (which == 2) view.error_pixels = bad;
      if (which == 3) view.planes[2] = {bad, bad, 0, bad};
      CHECK(count(lod->cut(view)) < 100'000);
    }
  CHECK(area(lod->cut(everything())) == Approx(kSphereArea).epsilon(0.06));
}

}  // namespace gs::qnv
