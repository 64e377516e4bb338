#include "qnv/codecs/gaussians/lod/splat_stream.h"

#include "qnv/codecs/gaussians/encode/gaussians_stream.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/qnv/splat_clouds.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv::splat_stream_test {
namespace {

using Bytes = std::vector<std::byte>;
using Stream = std::unique_ptr<SplatStream>;

EncodedStream encoded_cloud(std::size_t count, int degree = 0) {
  auto encoded = encode_gaussians(test::splat_cloud(count, degree), {});
  REQUIRE(std::holds_alternative<EncodedStream>(encoded));
  return std::get<EncodedStream>(std::move(encoded));
}

Stream opened(SplatStream::Opened made) {
  REQUIRE(std::holds_alternative<Stream>(made));
  return std::get<Stream>(std::move(made));
}

Gaussians decoded(std::span<const std::byte> bytes) {
  StreamDecoder decoder;
  (void)decoder.push(bytes);
  decoder.finish();
  Geometry geometry = decoder.geometry();
  REQUIRE(geometry.as<Gaussians>());
  return std::move(*geometry.as<Gaussians>());
}

/// Numbers of a Gaussian, for sorting.
using Numbers = std::array<float, 10>;

std::vector<Numbers> sorted_numbers(const Gaussians& all) {
  std::vector<Numbers> numbers;
  const std::size_t per = harmonic_count(all.degree);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const glm::vec3 &p = all.positions[i], &s = all.scales[i];
    const glm::vec3 last = per > 0 ? all.harmonics[i * per + per - 1] : glm::vec3(0);
    numbers.push_back({p.x, p.y, p.z, s.x, s.y, s.z, all.opacities[i], all.bases[i].y, last.x, last.z});
  }
  std::ranges::sort(numbers);
  return numbers;
}

/// Returns the Gaussians of a cut. Requires that none fades.
Gaussians gathered(const std::vector<SplatRun>& runs) {
  Gaussians all;
  for (const SplatRun& run : runs) all.degree = std::max(all.degree, run.splats->degree);
  const std::size_t per = harmonic_count(all.degree);
  for (const SplatRun& run : runs) {
    REQUIRE(std::size_t{run.first} + run.count <= run.splats->size());
    CHECK(run.presence == 1);
    for (std::size_t i = run.first; i < std::size_t{run.first} + run.count; ++i) {
      all.positions.push_back(run.splats->positions[i]);
      all.scales.push_back(run.splats->scales[i]);
      all.opacities.push_back(run.splats->opacities[i]);
      all.bases.push_back(run.splats->bases[i]);
      for (std::size_t k = 0; k < per; ++k)
        all.harmonics.push_back(run.splats->degree > 0 ? run.splats->harmonics[i * per + k] : glm::vec3(0));
    }
  }
  return all;
}

std::size_t count_of(const std::vector<SplatRun>& runs) {
  std::size_t count = 0;
  for (const SplatRun& run : runs) count += run.count;
  return count;
}

double opacity_area(const Gaussians& all) {
  double sum = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    sum += double{all.opacities[i]} * double{all.scales[i].x} * double{all.scales[i].y};
  return sum;
}

/// Returns an unbounded view from the distance `away`.
LodView view_from(float away, std::uint32_t viewport = 0) {
  LodView view;
  view.eye = {0, 0, away};
  view.pixels = 1000;
  view.viewport = viewport;
  return view;
}

LodView closest_view() {
  LodView view = view_from(0);
  view.error_pixels = 0;
  return view;
}

/// Source that counts the bytes read from it.
class CountingSource final : public ChunkSource {
 public:
  explicit CountingSource(Bytes bytes) : bytes_(memory_source(std::move(bytes))) {}
  [[nodiscard]] std::uint64_t size() const override { return bytes_->size(); }
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const override {
    const std::size_t count = bytes_->read(offset, to);
    read_ += count;
    return count;
  }
  mutable std::atomic<std::size_t> read_ = 0;

 private:
  std::shared_ptr<const ChunkSource> bytes_;
};

/// Source with bytes that a test changes.
class ChangedSource final : public ChunkSource {
 public:
  explicit ChangedSource(Bytes bytes) : bytes_(std::move(bytes)) {}
  [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const override {
    const std::size_t first = static_cast<std::size_t>(std::min<std::uint64_t>(offset, bytes_.size()));
    const std::size_t count = std::min(to.size(), bytes_.size() - first);
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(first), count, to.begin());
    return count;
  }
  Bytes bytes_;
};

/// Returns the chunks of Gaussians and harmonics of a stream, with their offsets.
std::vector<std::pair<std::uint64_t, Bytes>> chunks_of(const EncodedStream& stream) {
  std::vector<std::pair<std::uint64_t, Bytes>> chunks;
  StreamReader reader;
  (void)reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    if (type == ChunkType::gaussians || is_harmonics(type)) chunks.emplace_back(offset, encode_chunk(type, payload));
  });
  return chunks;
}

Bytes directory_bytes(const EncodedStream& stream) {
  return {stream.bytes.begin() + static_cast<std::ptrdiff_t>(stream.header.directory), stream.bytes.end()};
}

}  // namespace

TEST_CASE("the finest cut of a stream of Gaussians has all of its splats") {
  for (const int degree : {0, 2}) {
    const EncodedStream encoded = encoded_cloud(3000, degree);
    const Gaussians all = decoded(encoded.bytes);
    for (const bool in_memory : {true, false}) {
      const Stream stream =
          opened(in_memory ? SplatStream::open(encoded.bytes) : SplatStream::open(memory_source(encoded.bytes)));
      CHECK(stream->problems().empty());
      const Gaussians cut = gathered(stream->cut(closest_view()));
      CHECK_FALSE(stream->pending());
      CHECK(stream->wanted().empty());
      CHECK(cut.degree == degree);
      CHECK(sorted_numbers(cut) == sorted_numbers(all));
      const Gaussians whole = stream->whole().decode(10'000);
      CHECK(sorted_numbers(whole) == sorted_numbers(all));
    }
  }
}

TEST_CASE("cuts of Gaussians are coarser from far away and within a budget") {
  const Stream stream = opened(SplatStream::open(encoded_cloud(5000).bytes));
  const double truth = opacity_area(gathered(stream->cut(closest_view())));
  std::size_t last = 6000;
  for (const float away : {2.0f, 300.0f, 2000.0f, 20'000.0f}) {
    const Gaussians cut = gathered(stream->cut(view_from(away)));
    CHECK(cut.size() <= last);
    last = cut.size();
    CHECK(opacity_area(cut) > 0.5 * truth);
    CHECK(opacity_area(cut) < 2.5 * truth);
  }
  CHECK(last < 200);
  for (const std::size_t budget : {100u, 700u, 2000u}) {
    LodView view = closest_view();
    view.budget = budget;
    const Gaussians cut = gathered(stream->cut(view));
    CHECK(cut.size() <= budget);
    CHECK(cut.size() > budget / 3);
    CHECK(opacity_area(cut) > 0.5 * truth);
  }
}

TEST_CASE("viewports have independent cuts of Gaussians") {
  const Stream stream = opened(SplatStream::open(encoded_cloud(4000).bytes));
  const std::vector<SplatRun> near = stream->cut(view_from(2, 0)), far = stream->cut(view_from(3000, 1));
  CHECK(count_of(near) > 4 * count_of(far));
  CHECK(stream->cut(view_from(2, 0)) == near);
  CHECK(stream->cut(view_from(3000, 1)) == far);
  CHECK(stream->views().size() == 2);
  stream->forget(1);
  CHECK(stream->views().size() == 1);
}

TEST_CASE("a view of a part reads only that part of a stream of Gaussians") {
  const EncodedStream encoded = encoded_cloud(12'000, 1);
  const auto source = std::make_shared<CountingSource>(encoded.bytes);
  const Stream stream = opened(SplatStream::open(source));
  LodView view = closest_view();
  view.planes[0] = {-1, 0, 0, -0.8f};  // x <= -0.8
  const std::size_t before = source->read_;
  const Gaussians cut = gathered(stream->cut(view));
  CHECK(source->read_ - before < encoded.bytes.size() * 3 / 4);
  // All splats there are final.
  const Gaussians all = decoded(encoded.bytes);
  const auto inside = [](const Gaussians& some) {
    return std::ranges::count_if(some.positions, [](const glm::vec3& p) { return p.x < -0.81f; });
  };
  CHECK(inside(cut) == inside(all));
  CHECK(cut.size() < all.size() / 2);
}

TEST_CASE("cuts of Gaussians are the same with little memory") {
  const EncodedStream encoded = encoded_cloud(12'000, 1);
  const Stream ample = opened(SplatStream::open(memory_source(encoded.bytes))),
               tight = opened(SplatStream::open(memory_source(encoded.bytes)));
  SplatLimits limits;
  limits.cache_bytes = 200'000;
  tight->set_limits(limits);
  for (const float x : {-0.9f, 0.9f, -0.9f}) {
    LodView view = closest_view();
    view.planes[0] = {x < 0 ? -1.0f : 1.0f, 0, 0, -0.7f};
    const std::vector<Numbers> expected = sorted_numbers(gathered(ample->cut(view)));
    CHECK(sorted_numbers(gathered(tight->cut(view))) == expected);
    CHECK(expected.size() > 500);
  }
  const SplatStatistics kept = ample->statistics(), freed = tight->statistics();
  CHECK(freed.cached_bytes < kept.cached_bytes / 2);
  // A distant view needs few clusters, so the memory falls below the limit.
  (void)tight->cut(view_from(1000));
  CHECK(tight->statistics().cached_bytes <= limits.cache_bytes);
  limits.cut_bytes = 500 * bytes_of_splat(1);
  tight->set_limits(limits);
  CHECK(count_of(tight->cut(closest_view())) <= 500);
}

TEST_CASE("views request the chunks of Gaussians that they need") {
  const EncodedStream encoded = encoded_cloud(12'000, 1);
  const auto chunks = chunks_of(encoded);
  const Stream stream = opened(SplatStream::begin(std::span(encoded.bytes).first(2000)));
  REQUIRE(stream->set_directory(directory_bytes(encoded)));
  LodView view = closest_view();
  view.planes[0] = {0, 1, 0, -0.5f};
  std::size_t received = 0, count = 0;
  for (int round = 0; round < 100; ++round) {
    count = std::max(count, count_of(stream->cut(view)));
    const auto wanted = stream->wanted();
    if (wanted.empty()) break;
    for (std::size_t i = 0; i < std::min<std::size_t>(wanted.size(), 40); ++i) {
      const auto chunk = std::ranges::find(chunks, wanted[i].offset, &std::pair<std::uint64_t, Bytes>::first);
      REQUIRE(chunk != chunks.end());
      CHECK(chunk->second.size() == wanted[i].bytes);
      CHECK(stream->add(chunk->first, chunk->second));
      received += chunk->second.size();
    }
  }
  CHECK(stream->wanted().empty());
  CHECK(received < encoded.bytes.size() * 3 / 4);
  // The splats in view are those of the whole stream.
  const auto in_view = [](const Gaussians& all) {
    std::vector<Numbers> numbers = sorted_numbers(all);
    std::erase_if(numbers, [](const Numbers& one) { return one[1] < 0.55f; });
    return numbers;
  };
  CHECK(in_view(gathered(stream->cut(view))) == in_view(decoded(encoded.bytes)));
}

TEST_CASE("Gaussians of chunks in any order give the same cut") {
  const EncodedStream encoded = encoded_cloud(2500, 2);
  auto chunks = chunks_of(encoded);
  const std::vector<Numbers> expected = sorted_numbers(decoded(encoded.bytes));
  std::size_t header_bytes = 0;
  bool need_more = false;
  (void)decode_header(encoded.bytes, header_bytes, need_more);
  std::mt19937 random(5);
  for (int order = 0; order < 3; ++order) {
    std::ranges::shuffle(chunks, random);
    const Stream stream = opened(SplatStream::begin(std::span(encoded.bytes).first(header_bytes)));
    if (order > 0) REQUIRE(stream->set_directory(directory_bytes(encoded)));
    std::size_t i = 0;
    for (const auto& [offset, chunk] : chunks) {
      CHECK(stream->add(offset, chunk));
      if (++i % 10 == 0) (void)stream->cut(closest_view());
    }
    stream->finish();
    CHECK(sorted_numbers(gathered(stream->cut(closest_view()))) == expected);
    CHECK(stream->problems().empty());
  }
}

TEST_CASE("coarse Gaussians of a cut have the harmonics that were received") {
  const EncodedStream stream = encoded_cloud(6000, 2);
  bool coarse = false;
  for (const std::size_t bytes : {9'000u, 25'000u, 60'000u, 120'000u}) {
    const std::span<const std::byte> part =
        std::span(stream.bytes).first(std::min<std::size_t>(bytes, stream.bytes.size()));
    const Gaussians expected = decoded(part);
    coarse = coarse || (expected.degree == 2 && expected.size() < 6000);
    const Stream splats = opened(SplatStream::open(part));
    CHECK(sorted_numbers(gathered(splats->cut(closest_view()))) == sorted_numbers(expected));
    // Adds the chunks one by one, with cuts between them.
    const Stream growing = opened(SplatStream::begin(part.first(1000)));
    for (std::size_t at = 1000; at < part.size(); at += 4000) {
      growing->push(part.subspan(at, std::min<std::size_t>(4000, part.size() - at)));
      (void)growing->cut(closest_view());
    }
    CHECK(sorted_numbers(gathered(growing->cut(closest_view()))) == sorted_numbers(expected));
  }
  CHECK(coarse);
}

TEST_CASE("parity restores lost chunks of Gaussians in a cut") {
  EncodeOptions options;
  options.parity = 0.3;
  auto made = encode_gaussians(test::splat_cloud(3000), options);
  const auto& encoded = std::get<EncodedStream>(made);
  auto chunks = chunks_of(encoded);
  Bytes damaged = encoded.bytes;
  // Damages every tenth chunk.
  for (std::size_t i = 3; i < chunks.size(); i += 10)
    damaged[chunks[i].first + kChunkHeaderBytes + 5] ^= std::byte{255};
  const Stream stream = opened(SplatStream::open(damaged));
  CHECK(sorted_numbers(gathered(stream->cut(closest_view()))) == sorted_numbers(decoded(encoded.bytes)));
}

TEST_CASE("parity restores damaged chunks of Gaussians in a file with a directory") {
  EncodeOptions options;
  options.parity = 0.3;
  auto made = encode_gaussians(test::splat_cloud(6000, 1), options);
  const auto& encoded = std::get<EncodedStream>(made);
  const auto chunks = chunks_of(encoded);
  const std::vector<Numbers> expected = sorted_numbers(decoded(encoded.bytes));
  for (const std::size_t first : {0u, 3u}) {  // with and without the root cluster
    Bytes damaged = encoded.bytes;
    std::size_t harmonics = 0;
    for (std::size_t i = first; i < chunks.size(); i += 10) {
      damaged[static_cast<std::size_t>(chunks[i].first) + kChunkHeaderBytes + 5] ^= std::byte{255};
      harmonics += is_harmonics(static_cast<ChunkType>(chunks[i].second[4])) ? 1 : 0;
    }
    CHECK(harmonics > 0);
    CHECK(harmonics < chunks.size() / 10);
    const auto source = std::make_shared<const CountingSource>(damaged);
    const Stream stream = opened(SplatStream::open(source));
    if (first > 0) CHECK(source->read_ < damaged.size() / 2);
    CHECK(sorted_numbers(gathered(stream->cut(closest_view()))) == expected);
    // Reads the whole file once, and each chunk at most twice.
    CHECK(source->read_ < 4 * damaged.size());
  }
}

TEST_CASE("a cluster that changes its number of Gaussians in the file is left out") {
  EncodeOptions options;
  options.parity = 0;
  auto made = encode_gaussians(test::splat_cloud(6000), options);
  const auto& encoded = std::get<EncodedStream>(made);
  const auto source = std::make_shared<ChangedSource>(encoded.bytes);
  const Stream stream = opened(SplatStream::open(source));
  CHECK(gathered(stream->cut(closest_view())).size() == 6000);
  // A distant view needs only the root cluster, so that the others are dropped.
  stream->set_limits({.cache_bytes = 1});
  (void)stream->cut(view_from(1e6f));
  stream->set_limits({});
  for (const auto& [offset, chunk] : chunks_of(encoded)) {
    const auto packed = gaussians::parse_cluster(std::span(chunk).subspan(kChunkHeaderBytes));
    REQUIRE(packed);
    if (packed->head.level != 1) continue;
    // Each Gaussian stays as it is, instead of getting children.
    const Bytes stays(packed->bytes.size(), std::byte{255});
    const Bytes other = encode_chunk(ChunkType::gaussians, gaussians::pack(packed->head, stays));
    REQUIRE(other.size() == chunk.size());
    std::ranges::copy(other, source->bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  CHECK(gathered(stream->cut(closest_view())).size() < 6000);
  REQUIRE_FALSE(stream->problems().empty());
  CHECK(stream->problems()[0].message == "a cluster of Gaussians is damaged and left out");
}

TEST_CASE("clusters that replace Gaussians of others are left out") {
  const EncodedStream encoded = encoded_cloud(3000);
  const auto chunks = chunks_of(encoded);
  const Stream stream = opened(SplatStream::begin(std::span(encoded.bytes).first(encoded.header.directory)));
  stream->push(std::span(encoded.bytes).subspan(static_cast<std::size_t>(encoded.header.directory)));
  std::uint32_t id = 1'000'000;
  for (const auto& [offset, chunk] : chunks) {
    auto packed = gaussians::parse_cluster(std::span(chunk).subspan(kChunkHeaderBytes));
    REQUIRE(packed);
    if (packed->head.level != 1 && packed->head.level != 2) continue;
    packed->head.id = id++;
    const Bytes copy = encode_chunk(ChunkType::gaussians, gaussians::pack(packed->head, packed->bytes));
    CHECK(stream->add((std::uint64_t{1} << 40) + id, copy));
  }
  REQUIRE(id > 1'000'001);
  const Gaussians cut = gathered(stream->cut(closest_view()));
  CHECK(cut.size() <= 3000);
  CHECK(opacity_area(cut) == Approx(opacity_area(decoded(encoded.bytes))).epsilon(0.2));
  REQUIRE_FALSE(stream->problems().empty());
  CHECK(stream->problems()[0].message == "a cluster replaces Gaussians of another one, or none");
}

TEST_CASE("harmonics of unknown clusters wait in limited memory") {
  gaussians::SplatTree tree;
  std::string why;
  CHECK(tree.arrive(gaussians::HarmonicsHead{1, 0, 5}, 1, 50, why));
  std::size_t waiting = 1;
  for (std::uint32_t id = 2; id < 200'000 && why.empty(); ++id)
    waiting += tree.arrive(gaussians::HarmonicsHead{id, 0, 5}, id, 50, why) ? 1 : 0;
  CHECK(waiting == 65'536);
  CHECK(why == "a chunk of harmonics is left out, because too many wait for their clusters");
  CHECK(tree.size() == 0);
  // A received cluster takes its waiting chunks, which makes room for another chunk.
  why.clear();
  const std::uint32_t root = tree.arrive(gaussians::ClusterHead{}, 300'000, 50, why);
  const std::uint32_t index = tree.arrive(gaussians::ClusterHead{1, 0, 0, 1, 1}, 300'001, 50, why);
  REQUIRE(index != gaussians::kNoCluster);
  CHECK(tree[root].own_harmonics == 0);
  CHECK(tree[index].own_harmonics == 1);
  CHECK(tree.harmonics(tree[index].harmonics).offset == 1);
  CHECK(tree.arrive(gaussians::HarmonicsHead{400'000, 0, 5}, 400'000, 50, why));
  CHECK(why.empty());
}

TEST_CASE("decoding of Gaussians continues in later cuts") {
  const Stream stream = opened(SplatStream::open(encoded_cloud(6000).bytes));
  LodView view = closest_view();
  view.most_decoded = 700;
  std::size_t last = 0, cuts = 0;
  do {
    const std::size_t count = count_of(stream->cut(view));
    CHECK(count >= last);
    CHECK(stream->statistics().decoded < 2500);
    last = count;
  } while (stream->pending() && ++cuts < 100);
  CHECK(cuts > 4);
  CHECK(last == 6000);
}

TEST_CASE("changes of a cut of Gaussians fade") {
  const Stream stream = opened(SplatStream::open(encoded_cloud(6000).bytes));
  const std::size_t coarse = count_of(stream->cut(view_from(3000), 10.0));
  CHECK_FALSE(stream->fading());
  double time = 10, last = 0;
  bool first = true;
  for (int frame = 0; frame < 20; ++frame, time += 0.02) {
    const std::vector<SplatRun> runs = stream->cut(view_from(8), time);
    double present = 0;
    for (const SplatRun& run : runs) {
      CHECK(run.presence > 0);
      CHECK(run.presence <= 1);
      present += double{run.presence} * run.count;
    }
    if (first) CHECK(present == Approx(static_cast<double>(coarse)));
    CHECK(present >= last - 1e-3);
    last = present;
    first = false;
  }
  CHECK_FALSE(stream->fading());
  const Stream other = opened(SplatStream::open(encoded_cloud(6000).bytes));
  CHECK(sorted_numbers(gathered(stream->cut(view_from(8), time))) ==
        sorted_numbers(gathered(other->cut(view_from(8)))));
  // Without a clock, the change is immediate.
  CHECK(count_of(stream->cut(view_from(3000))) < count_of(other->cut(view_from(8))) / 2);
  CHECK_FALSE(stream->fading());
}

TEST_CASE("received Gaussians fade in") {
  const EncodedStream encoded = encoded_cloud(6000);
  const Stream stream = opened(SplatStream::begin(std::span(encoded.bytes).first(9000)));
  (void)stream->cut(view_from(2), 1.0);
  stream->push(std::span(encoded.bytes).subspan(9000));
  (void)stream->cut(view_from(2), 1.1);
  CHECK(stream->fading());
  (void)stream->cut(view_from(2), 1.5);
  CHECK_FALSE(stream->fading());
}

TEST_CASE("a wrong directory of Gaussians is replaced by the chunks") {
  const EncodedStream encoded = encoded_cloud(3000);
  auto entries = read_directory(*memory_source(encoded.bytes), encoded.header);
  REQUIRE(entries.size() > 10);
  std::ranges::reverse(entries);
  Bytes bytes(encoded.bytes.begin(), encoded.bytes.begin() + static_cast<std::ptrdiff_t>(encoded.header.directory));
  const Bytes directory = encode_directory(entries, encoded.header.description.box);
  bytes.insert(bytes.end(), directory.begin(), directory.end());
  const Stream stream = opened(SplatStream::open(memory_source(bytes)));
  CHECK(stream->problems().size() == 1);
  CHECK(count_of(stream->cut(closest_view())) == 3000);
}

TEST_CASE("damaged streams of Gaussians give coarser cuts") {
  const EncodedStream encoded = encoded_cloud(2000, 1);
  std::mt19937 random(11);
  for (int round = 0; round < 60; ++round) {
    Bytes bytes = encoded.bytes;
    for (int change = 0; change < 1 + round % 30; ++change)
      bytes[200 + random() % (bytes.size() - 200)] = static_cast<std::byte>(random());
    if (round % 3 == 0) bytes.resize(bytes.size() - random() % (bytes.size() / 2));
    auto made = round % 2 == 0 ? SplatStream::open(bytes) : SplatStream::open(memory_source(bytes));
    auto* stream = std::get_if<Stream>(&made);
    if (!stream) continue;
    CHECK(count_of((*stream)->cut(closest_view())) <= 2000);
    CHECK((*stream)->whole().decode(100'000).size() <= 2000);
  }
}

TEST_CASE("clusters of Gaussians have limited numbers of children and of chunks of harmonics") {
  gaussians::SplatTree tree;
  std::string why;
  std::uint64_t offset = 0;
  const auto arrive = [&](const gaussians::ClusterHead& head) { return tree.arrive(head, offset++, 50, why); };
  const std::uint32_t first = arrive({});
  CHECK(first == tree.root());
  for (std::uint32_t id = 1; id <= gaussians::kMostNodes; ++id)
    REQUIRE(arrive({id, 0, id - 1, 1, 1}) != gaussians::kNoCluster);
  CHECK(why.empty());
  CHECK(arrive({gaussians::kMostNodes + 1, 0, 0, 1, 1}) == gaussians::kNoCluster);
  CHECK(why == "a cluster contradicts its parent");
  const auto arrive_harmonics = [&](std::uint32_t id, std::uint32_t first) {
    return tree.arrive(gaussians::HarmonicsHead{id, first, 1}, offset++, 50, why);
  };
  for (std::uint32_t i = 0; i < 1024; ++i) REQUIRE(arrive_harmonics(5, i));
  CHECK_FALSE(arrive_harmonics(5, 1024));
  CHECK(arrive_harmonics(6, 0));
}

TEST_CASE("an overview of Gaussians has their extent") {
  const Stream stream = opened(SplatStream::open(encoded_cloud(5000).bytes));
  const Gaussians some = stream->overview(1000);
  CHECK(some.size() <= 1000);
  CHECK(some.size() > 300);
  Box box;
  for (const glm::vec3& p : some.positions) box.add(p);
  CHECK(box.size().x > 2);
  CHECK(box.size().y > 1.4f);
}

}  // namespace gs::qnv::splat_stream_test
