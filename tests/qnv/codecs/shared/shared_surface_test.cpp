#include "qnv/codecs/encode.h"
#include "qnv/codecs/shared/shared_records.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"
#include "tests/qnv/surface_shapes.h"
#include "tests/qnv/thread_ranks.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <functional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

namespace gs::qnv::shared_surface_test {
namespace {

/// Returns a source in runs of `size` triangles. The run `broken` cannot be read.
TriangleSource in_runs(const Triangles& triangles, std::size_t size, std::uint64_t broken = ~std::uint64_t{0}) {
  return {(triangles.size() + size - 1) / size,
          [&triangles, size, broken](std::uint64_t run, const TriangleSink& sink) {
            const auto first = static_cast<std::size_t>(run) * size;
            return run != broken && sink(std::span(triangles).subspan(first, std::min(size, triangles.size() - first)));
          }};
}

using Result = std::variant<Encoding, EncodeError>;

std::vector<Result> encode_in(SharedMemory& state, const TriangleSource& source, const EncodeRequest& request,
                              std::uint64_t last_fails_at = 0) {
  const auto count = static_cast<std::uint32_t>(state.stores.size());
  std::vector<Result> results(count, EncodeError{"not run"});
  std::vector<std::jthread> threads;
  for (std::uint32_t rank = 0; rank < count; ++rank)
    threads.emplace_back([&, rank] {
      ThreadRanks ranks(state, rank);
      RankStore store(state, rank);
      if (rank + 1 == count) store.fails_at = last_fails_at;
      EncodeRequest own = request;
      own.options.ranks = &ranks;
      own.options.spill = &store;
      own.options.threads = 1;
      results[rank] = encode(EncodeSource(std::cref(source)), own);
    });
  threads.clear();
  return results;
}

std::vector<Result> encode_together(const TriangleSource& source, const EncodeRequest& request, std::uint32_t count,
                                    std::uint64_t last_fails_at = 0) {
  SharedMemory state(count);
  return encode_in(state, source, request, last_fails_at);
}

std::vector<std::byte> encode_alone(const TriangleSource& source, const EncodeRequest& request,
                                    std::string_view payload) {
  auto made = encode(EncodeSource(std::cref(source)), request);
  if (const auto* problem = std::get_if<EncodeError>(&made)) FAIL(problem->message);
  CHECK(std::get<Encoding>(made).payload->name == payload);
  return std::get<Encoding>(std::move(made)).stream.bytes;
}

}  // namespace

TEST_CASE("ranks: encode a surface that exceeds memory with the bytes of one process") {
  const Triangles ball = sphere(90, 2, {10, 0, 0}, true), heap = random_triangles(9000, 1, 5);
  EncodeRequest automatic, octree, records;
  automatic.options.most_triangles = 4'000;
  octree.payload = Payload::packed;
  records.payload = Payload::records;
  octree.options.vectors = records.options.vectors = 3'000;
  const struct {
    const Triangles& triangles;
    const EncodeRequest& request;
    std::string_view payload;
  } cases[] = {{ball, automatic, "displaced"},
               {heap, automatic, "packed"},  // the displaced encoder rejects it after thinning
               {ball, octree, "packed"},
               {ball, records, "records"}};
  for (const auto& one : cases) {
    INFO(one.payload);
    const TriangleSource source = in_runs(one.triangles, 1'000);
    const std::vector<std::byte> alone = encode_alone(source, one.request, one.payload);
    for (const std::uint32_t count : {1u, 2u, 3u, 5u}) {
      INFO(count);
      const auto results = encode_together(source, one.request, count);
      for (std::uint32_t rank = 0; rank < count; ++rank) {
        REQUIRE(std::holds_alternative<Encoding>(results[rank]));
        const auto& bytes = std::get<Encoding>(results[rank]).stream.bytes;
        CHECK(bytes.size() == (rank == 0 ? alone.size() : 0));
        if (rank == 0) CHECK(bytes == alone);
      }
    }
  }
}

TEST_CASE("ranks: take a thinned surface of an earlier run") {
  const Triangles ball = sphere(90, 2, {10, 0, 0}, true);
  EncodeRequest request;
  request.options.most_triangles = 4'000;
  std::atomic<std::size_t> reads{0};
  const TriangleSource whole = in_runs(ball, 1'000);
  const TriangleSource source{whole.runs(), [&](std::uint64_t run, const TriangleSink& sink) {
                                ++reads;
                                return whole.read(run, sink);
                              }};
  const std::vector<std::byte> alone = encode_alone(source, request, "displaced");
  SharedMemory state(3);
  (void)encode_in(state, source, request);
  CHECK(state.restored == 0);
  const auto bytes_of_first = [](const std::vector<Result>& results) {
    REQUIRE(std::holds_alternative<Encoding>(results.front()));
    return std::get<Encoding>(results.front()).stream.bytes;
  };
  reads = 0;
  CHECK(bytes_of_first(encode_in(state, source, request)) == alone);
  CHECK(reads == 0);
  // A damaged result is not used.
  for (auto& [work, result] : state.finished)
    if (work.starts_with("thinned")) result.resize(result.size() / 2);
  CHECK(bytes_of_first(encode_in(state, source, request)) == alone);
  CHECK(reads > 0);
}

TEST_CASE("ranks: report the error of one rank on all ranks") {
  const Triangles ball = sphere(40);
  EncodeRequest request;
  request.options.most_triangles = 1'000;
  const auto all_fail = [](const std::vector<Result>& results, const std::string& message) {
    for (const Result& result : results) {
      REQUIRE(std::holds_alternative<EncodeError>(result));
      CHECK(std::get<EncodeError>(result).message == message);
    }
  };
  for (const auto payload : {std::optional<Payload>(), std::optional(Payload::packed)}) {
    request.payload = payload;
    all_fail(encode_together(in_runs(ball, 500, 7), request, 3), kUnreadable);
    all_fail(encode_together(in_runs(ball, 500), request, 3, 2'000),
             "cannot pass data between processes: not enough memory");
  }
  const Triangles point{triangle_of({1, 1, 1}, {1, 1, 1}, {1, 1, 1})};
  all_fail(encode_together(in_runs(point, 1), request, 2), "no surface to encode; expected triangles with an area");
}

TEST_CASE("ranks: merge records with equal keys") {
  struct Count {
    std::uint64_t key = 0, count = 0;
    [[nodiscard]] std::uint64_t hash() const { return key / 3; }
    void add(const Count& other) { count += other.count; }
    bool operator==(const Count&) const = default;
  };
  constexpr std::uint32_t kRanks = 4;
  SharedMemory state(kRanks);
  std::vector<std::vector<Count>> merged(kRanks);
  std::vector<std::jthread> threads;
  for (std::uint32_t rank = 0; rank < kRanks; ++rank)
    threads.emplace_back([&, rank] {
      ThreadRanks ranks(state, rank);
      RankStore store(state, rank);
      EncodeOptions options;
      options.ranks = &ranks;
      options.spill = &store;
      EncodeRanks shared(options);
      std::vector<Count> own;
      for (std::uint64_t i = 0; rank != 2 && i < 40; ++i) own.push_back({(i * 7 + rank) % 30, 1});  // rank 2 has none
      auto all = merged_records(shared, std::move(own), true);
      merged[rank] = std::get<std::vector<Count>>(std::move(all));
    });
  threads.clear();
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < merged[0].size(); ++i) {
    CHECK(merged[0][i].key == i);
    sum += merged[0][i].count;
  }
  CHECK(merged[0].size() == 30);
  CHECK(sum == 3 * 40);
  for (const auto& one : merged) CHECK(one == merged[0]);
}

}  // namespace gs::qnv::shared_surface_test
