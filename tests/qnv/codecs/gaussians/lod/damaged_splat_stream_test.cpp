#include "qnv/container/cluster_directory.h"
#include "tests/qnv/codecs/gaussians/lod/splat_stream_helpers.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace gs::qnv::splat_stream_test {
namespace {

/// Source in memory. After `begin_` is set, reads of this offset wait for open().
class GatedSource final : public ChunkSource {
 public:
  explicit GatedSource(Bytes bytes) : bytes_(memory_source(std::move(bytes))) {}
  [[nodiscard]] std::uint64_t size() const override { return bytes_->size(); }
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const override {
    if (offset == begin_) {
      std::unique_lock lock(mutex_);
      opened_.wait(lock, [&] { return open_; });
    }
    return bytes_->read(offset, to);
  }
  void open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    opened_.notify_all();
  }
  std::atomic<std::uint64_t> begin_ = ~std::uint64_t{0};  // reads of this offset wait; none by default

 private:
  std::shared_ptr<const ChunkSource> bytes_;
  mutable std::mutex mutex_;
  mutable std::condition_variable opened_;
  bool open_ = false;
};

}  // namespace

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

TEST_CASE("draws cuts with a clock while damaged chunks of Gaussians are restored") {
  EncodeOptions options;
  options.parity = 0.3;
  auto made = encode_gaussians(test::splat_cloud(6000, 1), options);
  const auto& encoded = std::get<EncodedStream>(made);
  const auto chunks = chunks_of(encoded);
  Bytes damaged = encoded.bytes;
  for (std::size_t i = 3; i < chunks.size(); i += 10)
    damaged[static_cast<std::size_t>(chunks[i].first) + kChunkHeaderBytes + 5] ^= std::byte{255};
  const auto source = std::make_shared<GatedSource>(damaged);
  const Stream stream = opened(SplatStream::open(source));
  source->begin_ = 0;
  // The source blocks the reading of the whole file until open().
  const std::size_t first = count_of(stream->cut(closest_view(), 1.0));
  CHECK(first > 0);
  CHECK(first < 6000);
  CHECK(stream->repairing());
  CHECK_FALSE(stream->pending());
  CHECK(stream->problems().empty());
  CHECK(count_of(stream->cut(closest_view(), 2.0)) == first);
  const std::uint64_t revision = stream->revision();
  source->open();
  // The revision increases, because another cut has more Gaussians.
  for (int i = 0; stream->revision() == revision && i < 10'000; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK(stream->revision() == revision + 1);
  CHECK(stream->repairing());
  CHECK(count_of(stream->cut(closest_view(), 3.0)) > first);
  CHECK_FALSE(stream->repairing());
  CHECK(stream->revision() == revision + 1);
  CHECK(sorted_numbers(gathered(stream->cut(closest_view()))) == sorted_numbers(decoded(encoded.bytes)));
}

TEST_CASE("closes a stream of Gaussians while its damaged chunks are restored") {
  EncodeOptions options;
  options.parity = 0.3;
  auto made = encode_gaussians(test::splat_cloud(3000), options);
  const auto& encoded = std::get<EncodedStream>(made);
  const auto chunks = chunks_of(encoded);
  Bytes damaged = encoded.bytes;
  damaged[static_cast<std::size_t>(chunks.back().first) + kChunkHeaderBytes + 5] ^= std::byte{255};
  auto stream = opened(SplatStream::open(memory_source(damaged)));
  CHECK(count_of(stream->cut(closest_view(), 1.0)) > 0);
  stream = nullptr;
  // A decoder of the whole stream may outlive the stream.
  stream = opened(SplatStream::open(memory_source(damaged)));
  (void)stream->cut(closest_view(), 1.0);
  const WholeSplats whole = stream->whole();
  stream = nullptr;
  CHECK(whole.decode(10'000).size() == 3000);
}

TEST_CASE("restores damaged chunks of Gaussians for the whole stream") {
  EncodeOptions options;
  options.parity = 0.3;
  auto made = encode_gaussians(test::splat_cloud(6000, 1), options);
  const auto& encoded = std::get<EncodedStream>(made);
  const auto chunks = chunks_of(encoded);
  Bytes damaged = encoded.bytes;
  for (std::size_t i = 3; i < chunks.size(); i += 10)
    damaged[static_cast<std::size_t>(chunks[i].first) + kChunkHeaderBytes + 5] ^= std::byte{255};
  const Stream stream = opened(SplatStream::open(memory_source(damaged)));
  const std::vector<Numbers> expected = sorted_numbers(decoded(encoded.bytes));
  CHECK(sorted_numbers(stream->whole().decode(100'000)) == expected);
  (void)stream->cut(closest_view());
  CHECK(sorted_numbers(stream->whole().decode(100'000)) == expected);
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
  // Merged Gaussians cover less than their leaves together. Gaussians beside their replacements would double the area.
  CHECK(opacity_area(cut) == Approx(opacity_area(decoded(encoded.bytes))).epsilon(0.3));
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

TEST_CASE("reads the chunks if a directory of clusters has wrong offsets") {
  const EncodedStream encoded = encoded_cloud(3000);
  auto entries = read_directory(*memory_source(encoded.bytes), encoded.header);
  REQUIRE(entries.size() == encoded.header.chunks);
  for (DirectoryEntry& entry : entries) entry.offset += 2;
  const auto payloads = pack_clusters(entries, encoded.header.description.box);
  REQUIRE(payloads);
  REQUIRE(payloads->size() == 1);
  Bytes bytes(encoded.bytes.begin(), encoded.bytes.begin() + static_cast<std::ptrdiff_t>(encoded.header.directory));
  const Bytes directory = encode_chunk(ChunkType::cluster_directory, payloads->front());
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

}  // namespace gs::qnv::splat_stream_test
