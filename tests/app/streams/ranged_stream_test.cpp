#include "app/streams/ranged_stream.h"

#include <catch2/catch.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace gs::app::ranged_stream_test {
namespace {

constexpr std::uint64_t kFront = 65536, kDirectory = 12'100'000, kDirectoryBytes = 300'000;

/// Loader that records all requests, and answers none.
class KeptRequests final : public net::LoadRequests {
 public:
  net::RequestId request(net::Request request) override {
    requests.push_back(std::move(request));
    return {requests.size()};
  }
  void cancel(net::RequestId id) override { cancelled.push_back(id.value); }

  std::vector<net::Request> requests;
  std::vector<std::uint64_t> cancelled;
};

/// Requests of views that want given chunks, in their order.
template <class Base>
class Wanting : public Base {
 public:
  bool set_directory(std::span<const std::byte>) override { return true; }
  void note(const qnv::LodView&) override {}
  void forget(std::uint32_t) override {}
  [[nodiscard]] std::vector<qnv::LodView> views() const override { return {}; }
  [[nodiscard]] const Box& box() const override { return box_; }
  [[nodiscard]] std::uint64_t directory() const override { return kDirectory; }
  [[nodiscard]] bool in_stream_order() const override { return false; }
  [[nodiscard]] std::vector<qnv::ChunkRange> wanted() const override { return chunks; }

  std::vector<qnv::ChunkRange> chunks;

 private:
  Box box_;
};

/// Stream with views that want given chunks.
class WantingStream final : public Wanting<qnv::ViewedStream> {
 public:
  bool push(std::span<const std::byte>) override { return true; }
  void finish() override {}
  bool add(std::uint64_t, std::span<const std::byte>) override { return true; }
};

/// Stream that the reader thread decodes, with chunks in the order of their importance.
using OrderedChunks = Wanting<qnv::ChunkRequests>;

RangedStream::Place place_of_stream() {
  RangedStream::Place place;
  place.url = "http://example.org/a.qnv";
  place.front = kFront;
  place.directory = kDirectory;
  place.total = kDirectory + kDirectoryBytes;
  place.ledger = std::make_shared<LoadLedger>();
  return place;
}

void receive_directory_of(RangedStream& transfer) {
  for (const bool end : {false, true}) {
    net::LoadEvent event{{1}, net::LoadDone{}};
    if (!end) event.what = net::LoadData{kDirectory, std::vector<std::byte>(kDirectoryBytes)};
    REQUIRE(transfer.take(event));
  }
}

/// Transfer of a stream with a requested directory.
struct Transfer {
  Transfer() { transfer = std::make_unique<RangedStream>(loader, feed, place_of_stream()); }
  void receive_directory() {
    receive_directory_of(*transfer);
    (void)feed->apply();
    feed->ask();
  }

  KeptRequests loader;
  std::shared_ptr<WantingStream> stream = std::make_shared<WantingStream>();
  std::shared_ptr<StreamFeed> feed = std::make_shared<StreamFeed>(stream, nullptr);
  std::unique_ptr<RangedStream> transfer;
};

}  // namespace

TEST_CASE("reads at most as many bytes of the front as the directory has, while it reads that") {
  Transfer all;
  REQUIRE(all.loader.requests.size() == 2);
  CHECK(all.loader.requests[0].ranges == std::vector{net::ByteRange{kDirectory, kDirectory + kDirectoryBytes}});
  CHECK(all.loader.requests[1].ranges == std::vector{net::ByteRange{kFront, kFront + kDirectoryBytes}});
  all.receive_directory();
  CHECK(all.loader.cancelled == std::vector<std::uint64_t>{2});
}

TEST_CASE("requests less important chunks together with the important ones beside them") {
  // The view wants every third chunk, in an order without neighbours.
  constexpr std::uint64_t kChunks = 4000, kBytes = 1000, kStep = 3000;
  Transfer all;
  for (std::uint64_t i = 0; i < kChunks; ++i)
    all.stream->chunks.push_back({kFront + i * 1597 % kChunks * kStep, kBytes});
  all.receive_directory();
  REQUIRE(all.transfer->ask_for_more());
  REQUIRE(all.loader.requests.size() > 2);
  std::vector<bool> asked(kChunks);
  for (std::size_t i = 2; i < all.loader.requests.size(); ++i) {
    const auto& ranges = all.loader.requests[i].ranges;
    CHECK(ranges.size() <= 8);
    std::uint64_t chunks = 0;
    for (const net::ByteRange& range : ranges)
      for (std::uint64_t at = range.begin; at < range.end; at += kStep, ++chunks) {
        const std::uint64_t number = (at - kFront) / kStep;
        CHECK_FALSE(asked[number]);
        asked[number] = true;
      }
    CHECK(chunks >= 256);
    CHECK(chunks <= 300);
  }
  // The most important chunk is among the first.
  CHECK(asked[0]);
}

TEST_CASE("requests hidden chunks of a stream without cuts after the visible ones") {
  // Every tenth chunk is visible.
  constexpr std::uint64_t kChunks = 4000, kBytes = 3000, kVisible = 10;
  const auto requests = std::make_shared<OrderedChunks>();
  for (const bool visible : {true, false})
    for (std::uint64_t i = 0; i < kChunks; ++i)
      if ((i % kVisible == 0) == visible) requests->chunks.push_back({kFront + i * kBytes, kBytes});
  KeptRequests loader;
  RangedStream transfer(loader, std::make_shared<StreamFeed>(requests, nullptr), place_of_stream(),
                        {[](const auto&) {}, [](const auto&) {}, [] {}});
  receive_directory_of(transfer);
  REQUIRE(transfer.ask_for_more());
  REQUIRE(loader.requests.size() > 1);
  for (const net::Request& request : std::span(loader.requests).subspan(1))
    for (const net::ByteRange& range : request.ranges) {
      CHECK((range.begin - kFront) % (kVisible * kBytes) == 0);
      CHECK(range.end - range.begin == kBytes);
    }
}

}  // namespace gs::app::ranged_stream_test
