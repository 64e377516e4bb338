#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/octree/encode/encode_surface.h"

#include "qnv/reader/loss.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/lod_streams.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace gs::qnv {

TEST_CASE("returns all vectors of the decoder for a cut without limits") {
  const EncodedStream& stream = sphere_stream(60'000);
  StreamDecoder decoder;
  REQUIRE(decoder.push(stream.bytes));
  const Splats all = content_of<Splats>(decoder.geometry());
  std::vector<std::array<float, 3>> expected;
  for (const glm::vec3& p : all.positions) expected.push_back({p.x, p.y, p.z});
  std::sort(expected.begin(), expected.end());
  const auto lod = opened(stream.bytes);
  CHECK(lod->statistics().clusters == stream.header.chunks);
  LodView view;
  view.error_pixels = 0;
  CHECK(places(lod->cut(view)) == expected);
  CHECK(lod->problems().empty());
}

TEST_CASE("keeps the vector budget and still covers the whole surface") {
  const auto lod = opened(sphere_stream(60'000).bytes);
  for (const std::size_t budget : {1200u, 2000u, 5000u, 20'000u}) {
    LodView view;
    view.error_pixels = 0;
    view.budget = budget;
    const auto pieces = lod->cut(view);
    INFO(budget);
    CHECK(count(pieces) <= budget);
    CHECK(area(pieces) == Approx(kSphereArea).epsilon(0.06));
  }
}

TEST_CASE("refines detail by the size on the screen") {
  const auto lod = opened(sphere_stream(60'000).bytes);
  LodView far;
  far.eye = {0, 0, 1000};
  LodView near = far;
  near.eye = {0, 0, 3};
  const std::size_t far_discs = count(lod->cut(far)), near_discs = count(lod->cut(near));
  CHECK(far_discs < 1200);  // the first cluster, a kilobyte
  CHECK(near_discs > 20 * far_discs);
}

TEST_CASE("neither refines nor draws clusters outside of the view") {
  const auto lod = opened(sphere_stream(60'000).bytes);
  LodView view;
  view.error_pixels = 0;
  const std::size_t all = count(lod->cut(view));
  view.planes[0] = {1, 0, 0, -0.5f};  // x > 0.5
  const auto pieces = lod->cut(view);
  CHECK(count(pieces) < all * 3 / 4);  // clusters are large relative to a small sphere
  // A quarter of the sphere's area is visible, and must be drawn.
  double inside = 0;
  for (const Piece& piece : pieces)
    for (std::size_t i = piece.first; i < piece.first + piece.count; ++i)
      if (piece.splats->positions[i].x > 0.5f) inside += piece.splats->weights[i];
  CHECK(inside == Approx(kSphereArea / 4).epsilon(0.06));
}

TEST_CASE("makes the same cuts with a small cache, and keeps it small", "[optimised]") {
  const EncodedStream& stream = sphere_stream(200'000);
  constexpr std::size_t kSmall = 100'000;
  const auto large = opened_there(stream.bytes), small = opened_there(stream.bytes, kSmall);
  std::size_t most_bytes = 0;
  for (int i = 0; i < 24; ++i) {
    // Two alternating views.
    const float angle = 0.5f * static_cast<float>(i / 2) + 3.0f * static_cast<float>(i % 2);
    LodView view = from(glm::vec3(std::sin(angle), 0, std::cos(angle)) * 1.05f, 2000);
    view.budget = 20'000;
    view.viewport = static_cast<std::uint32_t>(i % 2);
    CHECK(places(small->cut(view)) == places(large->cut(view)));
    CHECK(small->complete());
    most_bytes = std::max(most_bytes, small->statistics().cached_bytes);
    // Above the limit, the cache keeps the splats of both cuts (36 bytes each) with their neighbours in the same
    // arrays. It also keeps their source voxels (12 bytes and a third more).
    CHECK(small->statistics().cached_bytes < kSmall + 2 * 20'000 * (2 * 36 + 16));
  }
  CHECK(large->statistics().cached_bytes > 1.5 * most_bytes);
  // Clusters that a closed viewport needed are dropped.
  small->forget(0);
  small->forget(1);
  LodView far = from({0, 0, 1000});
  far.viewport = 2;
  (void)small->cut(far);
  CHECK(small->statistics().cached_bytes <= kSmall);
}

TEST_CASE("shows less, or rejects the stream, for every prefix and damaged byte") {
  const EncodedStream& stream = sphere_stream(3000);
  LodView view;
  view.error_pixels = 0;
  std::size_t most = 0;
  for (std::size_t size = 0; size <= stream.bytes.size(); size += 37) {
    auto made = LodStream::open({stream.bytes.begin(), stream.bytes.begin() + static_cast<std::ptrdiff_t>(size)});
    if (auto* lod = std::get_if<std::unique_ptr<LodStream>>(&made)) {
      const std::size_t discs = count((*lod)->cut(view));
      CHECK(discs >= most);
      most = discs;
    }
  }
  CHECK(most > 2000);
  for (std::size_t at = 0; at < stream.bytes.size(); at += 11) {
    std::vector<std::byte> damaged = stream.bytes;
    damaged[at] ^= std::byte{0x41};
    auto made = LodStream::open(std::move(damaged));
    if (auto* lod = std::get_if<std::unique_ptr<LodStream>>(&made)) CHECK(count((*lod)->cut(view)) <= most);
  }
}

TEST_CASE("loses detail to lost packets, but leaves no hole") {
  const EncodedStream& stream = sphere_stream(200'000);
  CHECK(drop_packets(stream.bytes, 0.3, 1) == drop_packets(stream.bytes, 0.3, 1));
  CHECK(drop_packets(stream.bytes, 0.3, 1) != drop_packets(stream.bytes, 0.3, 2));
  LodView view;
  view.error_pixels = 0;
  std::size_t before = count(opened(stream.bytes)->cut(view));
  for (const double share : {0.1, 0.3, 0.6, 1.0}) {
    const auto arrived = drop_packets(stream.bytes, share, 7);
    const auto pieces = opened(arrived)->cut(view);
    INFO(share);
    CHECK(arrived.size() < stream.bytes.size());
    CHECK(count(pieces) < before);
    CHECK(area(pieces) == Approx(kSphereArea).epsilon(0.06));
    before = count(pieces);
  }
}

TEST_CASE("keeps the other records and the area after lost packets") {
  const Triangles triangles = sphere(200);
  EncodeOptions options;
  options.vectors = 20'000;
  auto encoded = encode_surface_records([&](const TriangleSink& sink) { return sink(triangles); }, options);
  const auto& stream = std::get<EncodedStream>(encoded);
  StreamDecoder decoder;
  REQUIRE(decoder.push(drop_packets(stream.bytes, 0.3, 3)));
  decoder.finish();
  const Splats geometry = content_of<Splats>(decoder.geometry());
  CHECK(geometry.size() > 12'000);
  CHECK(geometry.size() < 16'500);
  double sum = 0;
  for (const float weight : geometry.weights) sum += weight;
  CHECK(sum == Approx(kSphereArea).epsilon(0.03));
}

TEST_CASE("drops no packets of data that are not a stream") {
  const std::vector<std::byte> other(100, std::byte{7});
  CHECK(drop_packets(other, 0.5, 1) == other);
}

}  // namespace gs::qnv
