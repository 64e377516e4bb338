#include "qnv/codecs/values/bricks/brick_volume.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/container/container.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace brick_needs_test {

using values::Extent;
using Bytes = std::vector<std::byte>;

constexpr Extent kExtent{260, 200, 200};

// Low values with noise in the half with low x, and high ones in the other.
const EncodedStream& two_halves() {
  static const EncodedStream stream = [] {
    VolumeLayout layout;
    layout.dimensions = kExtent;
    layout.type = VoxelType::u16;
    std::mt19937 random(3);
    std::vector<std::uint16_t> voxels;
    for (std::uint32_t z = 0; z < kExtent[2]; ++z)
      for (std::uint32_t y = 0; y < kExtent[1]; ++y)
        for (std::uint32_t x = 0; x < kExtent[0]; ++x)
          voxels.push_back(static_cast<std::uint16_t>((x < 128 ? 0 : 3000) + 200 * ((x / 9 + y / 7 + z / 11) % 3) +
                                                      random() % 60));
    auto made = encode_values(test::volume_of(layout, std::move(voxels)), EncodeOptions{});
    return std::move(std::get<EncodedStream>(made));
  }();
  return stream;
}

BrickLimits limits_of(std::size_t brick_bytes) {
  BrickLimits limits;
  limits.base_vectors = values::sample_count(kExtent) / 60 / values::kSamplesPerVector;
  limits.brick_bytes = brick_bytes;
  return limits;
}

LodView far_view() {
  LodView view;
  view.eye = glm::vec3(130, 100, -500);
  view.pixels = 1e6f;
  return view;
}

std::shared_ptr<const Volume> shown_in(BrickVolume& bricks, const LodView& view) {
  bool pending = false;
  return bricks.cut(view, pending);
}

std::shared_ptr<BrickVolume> opened(std::size_t brick_bytes) {
  auto made = BrickVolume::open(memory_source(two_halves().bytes), limits_of(brick_bytes));
  REQUIRE(std::holds_alternative<std::shared_ptr<BrickVolume>>(made));
  return std::get<0>(made);
}

// Counts the bricks of level 0 for which `test`(first, end of the core) holds, and the others.
template <class Test>
std::pair<std::size_t, std::size_t> count_finest(const Volume& volume, const Test& test) {
  std::pair<std::size_t, std::size_t> counts;
  for (const ValueBrick& brick : volume.values->bricks) {
    if (brick.level != 0) continue;
    Extent end = brick.core_first;
    for (std::size_t a = 0; a < 3; ++a) end[a] += brick.core_size[a];
    ++(test(brick.core_first, end) ? counts.first : counts.second);
  }
  return counts;
}

// Bytes that a server sends for a view.
std::uint64_t received_for(const LodView& view, std::size_t brick_bytes) {
  const std::span<const std::byte> bytes = two_halves().bytes;
  auto begun = BrickVolume::begin(bytes.first(8000), limits_of(brick_bytes));
  REQUIRE(std::holds_alternative<std::shared_ptr<BrickVolume>>(begun));
  const auto bricks = std::get<0>(begun);
  REQUIRE(bricks->set_directory(bytes.subspan(static_cast<std::size_t>(bricks->directory()))));
  std::uint64_t all = 0;
  for (int round = 0; round < 100; ++round) {
    (void)shown_in(*bricks, view);
    const auto wanted = bricks->wanted();
    if (wanted.empty()) break;
    for (const ChunkRange& range : wanted) {
      bricks->add(range.offset,
                  bytes.subspan(static_cast<std::size_t>(range.offset), static_cast<std::size_t>(range.bytes)));
      all += range.bytes;
    }
  }
  return all;
}

TEST_CASE("bricks: Views of slices alone get only the bricks that the slices touch") {
  const auto bricks = opened(std::size_t{1} << 30);
  LodView view = far_view();
  view.volume.only_slices = true;
  CHECK(shown_in(*bricks, view)->values->bricks.empty());
  // A slice at z = 100, and one at x = 30 that is given by another multiple of its plane.
  view.volume.slices[0] = glm::vec4(0, 0, 1, -100);
  const auto of_one = shown_in(*bricks, view);
  const auto [touched, others] =
      count_finest(*of_one, [](const Extent& first, const Extent& end) { return first[2] <= 100 && end[2] > 100; });
  CHECK(touched == 5 * 4);
  CHECK(others == 0);
  view.volume.slices[2] = glm::vec4(-0.1f, 0, 0, 3);
  const auto of_two = shown_in(*bricks, view);
  const auto [second, rest] = count_finest(*of_two, [](const Extent& first, const Extent& end) {
    return (first[2] <= 100 && end[2] > 100) || (first[0] <= 30 && end[0] > 30);
  });
  CHECK(second == 5 * 4 + 4 * 3);
  CHECK(rest == 0);
  // Their voxels have the error of the stream.
  for (const ValueBrick& brick : of_two->values->bricks)
    if (brick.level == 0) CHECK(brick.error_of(brick.core_first[0], brick.core_first[1], brick.core_first[2]));
}

TEST_CASE("bricks: Bricks of slices come before others") {
  LodView view = far_view();
  view.volume.slices[0] = glm::vec4(0, 0, 1, -100);
  // Memory for the bricks of the slice, but not for all.
  const auto bricks = opened(std::size_t{80} << 20);
  const auto on_slice = [](const Extent& first, const Extent& end) { return first[2] <= 100 && end[2] > 100; };
  const auto [touched, others] = count_finest(*shown_in(*bricks, view), on_slice);
  CHECK(touched == 5 * 4);
  CHECK(others < 5 * 4 * 3);
  view.volume.slices[0] = glm::vec4(0);
  const auto [left, most] = count_finest(*shown_in(*bricks, view), on_slice);
  CHECK(left < touched);
  CHECK(most > 0);
}

TEST_CASE("bricks: Parts behind a clipping plane are neither shown nor requested") {
  LodView view = far_view();
  view.volume.clip = glm::vec4(-1, 0, 0, 60);  // hides x > 60
  const auto bricks = opened(std::size_t{1} << 30);
  const auto [shown, hidden] =
      count_finest(*shown_in(*bricks, view), [](const Extent& first, const Extent&) { return first[0] <= 60; });
  CHECK(shown > 8);  // of 16, some of which are too small for vectors
  CHECK(hidden == 0);
  const std::uint64_t part = received_for(view, std::size_t{1} << 30),
                      all = received_for(far_view(), std::size_t{1} << 30);
  CHECK(part > 0);
  CHECK(part < all / 2);
}

TEST_CASE("bricks: Chunks from transports without offsets refine the volume, also after the end of its front") {
  const std::span<const std::byte> bytes = two_halves().bytes;
  constexpr std::size_t kFront = 6000;
  auto begun = BrickVolume::begin(bytes.first(kFront), limits_of(std::size_t{1} << 30));
  REQUIRE(std::holds_alternative<std::shared_ptr<BrickVolume>>(begun));
  const auto bricks = std::get<0>(begun);
  bricks->finish();
  (void)shown_in(*bricks, far_view());
  StreamReader reader;
  std::vector<Bytes> chunks;
  const auto take = [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    chunks.push_back(encode_chunk(type, payload));
  };
  reader.push(bytes, take);
  reader.finish(take);
  std::uint64_t number = std::uint64_t{1} << 62;
  for (const Bytes& chunk : chunks) bricks->add(number++, chunk);
  const auto shown = shown_in(*bricks, far_view()), expected = shown_in(*opened(std::size_t{1} << 30), far_view());
  CHECK(bricks->statistics().finest == 0);
  CHECK(shown->positions == expected->positions);
  CHECK(shown->weights == expected->weights);
}

TEST_CASE("bricks: Parts that the transfer function of a view hides come last") {
  constexpr std::size_t kBudget = std::size_t{40} << 20;
  const auto bricks = opened(kBudget);
  const auto is_low = [](const Extent& first, const Extent&) { return first[0] < 128; };
  LodView view = far_view();
  view.volume.hidden_classes.emplace();
  for (std::size_t i = 0; i < 256; ++i) view.volume.hidden_classes->set(i, i > 100);
  const auto [low, high] = count_finest(*shown_in(*bricks, view), is_low);
  CHECK(low > 0);
  CHECK(high == 0);
  view.volume.hidden_classes->flip();
  const auto [low_after, high_after] = count_finest(*shown_in(*bricks, view), is_low);
  CHECK(high_after > 0);
  CHECK(low_after < high_after);
}

}  // namespace brick_needs_test
}  // namespace gs::qnv
