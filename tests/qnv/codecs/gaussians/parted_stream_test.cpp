#include "qnv/codecs/gaussians/encode/gaussians_stream.h"
#include "qnv/codecs/gaussians/encode/splat_parts.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/qnv/splat_clouds.h"
#include "tests/qnv/thread_ranks.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <variant>
#include <vector>

namespace gs::qnv::parted_stream_test {
namespace {

EncodedStream parted(const Gaussians& source, std::size_t part, EncodeOptions options = {}) {
  options.part_splats = part;
  auto encoded = encode_gaussians(source, options);
  REQUIRE(std::holds_alternative<EncodedStream>(encoded));
  return std::get<EncodedStream>(std::move(encoded));
}

Gaussians shown_by(std::span<const std::byte> bytes) {
  StreamDecoder decoder;
  (void)decoder.push(bytes);
  CHECK(decoder.refused_chunks() == 0);
  Geometry geometry = decoder.geometry();
  REQUIRE(geometry.as<Gaussians>());
  return std::move(*geometry.as<Gaussians>());
}

/// Source that passes Gaussians in pieces of 100, and counts how often it is read.
struct Pieces {
  const Gaussians& all;
  std::size_t reads = 0, runs = 0;

  GaussianSource source() {
    return {all, all.degree, all.antialiased, all.size(), [this](const std::function<bool(const Gaussians&)>& take) {
              ++reads;
              for (std::size_t first = 0; first < all.size(); first += 100)
                if (!take(piece_of(first))) return false;
              return true;
            }};
  }
  /// Returns a source with one run per piece.
  GaussianSource source_in_runs() {
    GaussianSource made = source();
    for (std::size_t first = 0; first < all.size(); first += 100)
      made.runs.push_back(std::min<std::size_t>(100, all.size() - first));
    made.read_run = [this](std::uint64_t run, const std::function<bool(const Gaussians&)>& take) {
      ++runs;
      return take(piece_of(100 * static_cast<std::size_t>(run)));
    };
    return made;
  }
  [[nodiscard]] Gaussians piece_of(std::size_t first) const {
    const std::size_t per = harmonic_count(all.degree), last = std::min(all.size(), first + 100);
    Gaussians piece;
    piece.degree = all.degree;
    const auto copy = [](const auto& from, auto& to, std::size_t begin, std::size_t end) {
      to.assign(from.begin() + static_cast<std::ptrdiff_t>(begin), from.begin() + static_cast<std::ptrdiff_t>(end));
    };
    copy(all.positions, piece.positions, first, last);
    copy(all.scales, piece.scales, first, last);
    copy(all.rotations, piece.rotations, first, last);
    copy(all.opacities, piece.opacities, first, last);
    copy(all.bases, piece.bases, first, last);
    copy(all.harmonics, piece.harmonics, per * first, per * last);
    return piece;
  }
};

using PartedResult = std::variant<EncodedStream, EncodeError>;

/// Encodes a source with several ranks. The store of the last one fails after some bytes; 0 means never. Notes the
/// number of runs that each rank reads.
std::vector<PartedResult> encode_ranks(SharedMemory& state, const Gaussians& all, const EncodeOptions& options,
                                       std::vector<std::size_t>& runs, std::uint64_t last_fails_at = 0) {
  const std::size_t count = state.stores.size();
  std::vector<PartedResult> results(count, EncodeError{"not run"});
  runs.assign(count, 0);
  std::vector<std::jthread> threads;
  for (std::uint32_t rank = 0; rank < count; ++rank)
    threads.emplace_back([&, rank] {
      ThreadRanks ranks(state, rank);
      RankStore store(state, rank);
      if (rank + 1 == count) store.fails_at = last_fails_at;
      RankSink sink(state);
      EncodeOptions own = options;
      own.ranks = &ranks;
      own.spill = &store;
      own.sink = &sink;
      own.threads = 1;
      Pieces pieces{all};
      results[rank] = encode_gaussians(pieces.source_in_runs(), own);
      runs[rank] = pieces.runs;
    });
  threads.clear();
  return results;
}

/// Store that fails after some bytes.
class FullStore final : public SpillStore {
 public:
  explicit FullStore(std::size_t most) : most_(most) {}
  bool append(std::span<const std::byte> bytes) override {
    return store_.size() + bytes.size() <= most_ && store_.append(bytes);
  }
  [[nodiscard]] std::uint64_t size() const override { return store_.size(); }
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::byte> to) const override {
    return store_.read(offset, to);
  }
  [[nodiscard]] std::string problem() const override { return "the disk is full"; }

 private:
  std::size_t most_;
  MemoryStore store_;
};

double opacity_area(const Gaussians& g) {
  double sum = 0;
  for (std::size_t i = 0; i < g.size(); ++i)
    sum += double{g.opacities[i]} * double{g.scales[i].x} * double{g.scales[i].y};
  return sum;
}

}  // namespace

TEST_CASE("Gaussians in parts survive a stream") {
  for (const int degree : {0, 2}) {
    const Gaussians source = test::splat_cloud(6000, degree);
    const EncodedStream stream = parted(source, 1500);
    CHECK(stream.header.vectors == 6000);
    const Gaussians back = shown_by(stream.bytes);
    REQUIRE(back.size() == 6000);
    CHECK(back.degree == degree);
    CHECK(opacity_area(back) == Approx(opacity_area(shown_by(parted(source, 6000).bytes))).epsilon(0.01));
    // Each decoded Gaussian is close to one of the source.
    for (std::size_t i = 0; i < back.size(); i += 37) {
      float least = 1;
      for (const glm::vec3& p : source.positions) least = std::min(least, glm::distance(p, back.positions[i]));
      CHECK(least < 0.02f);
    }
  }
}

TEST_CASE("prefixes of Gaussians in parts are whole pictures") {
  const Gaussians source = test::splat_cloud(8000);
  const double truth = opacity_area(source);
  const EncodedStream stream = parted(source, 1000);
  for (const std::size_t bytes : {2'000u, 5'000u, 12'000u, 30'000u}) {
    const Gaussians part = shown_by(std::span(stream.bytes).first(bytes));
    CHECK(part.size() > 20);
    CHECK(opacity_area(part) > 0.4 * truth);
    CHECK(opacity_area(part) < 3 * truth);
    Box box;
    for (const glm::vec3& p : part.positions) box.add(p);
    CHECK(box.size().x > 1.0f);
    CHECK(box.size().y > 0.8f);
  }
}

TEST_CASE("a stream of Gaussians in parts does not depend on threads, memory and pieces") {
  const Gaussians source = test::splat_cloud(5000, 1);
  EncodeOptions options;
  options.threads = 1;
  const EncodedStream one = parted(source, 1200, options);
  options.threads = 4;
  CHECK(parted(source, 1200, options).bytes == one.bytes);
  options.memory = 1;
  CHECK(parted(source, 1200, options).bytes == one.bytes);
  Pieces pieces{source};
  options.part_splats = 1200;
  MemoryStore store;
  std::vector<std::byte> bytes;
  MemorySink sink(bytes);
  options.spill = &store;
  options.sink = &sink;
  const auto encoded = encode_gaussians(pieces.source(), options);
  REQUIRE(std::holds_alternative<EncodedStream>(encoded));
  CHECK(std::get<EncodedStream>(encoded).bytes.empty());
  CHECK(std::get<EncodedStream>(encoded).written == one.bytes.size());
  CHECK(bytes == one.bytes);
  CHECK(pieces.reads == 2);
  // Few Gaussians get one tree, with or without pieces.
  options = {};
  const auto small = encode_gaussians(pieces.source(), options);
  const auto whole = encode_gaussians(source, options);
  REQUIRE(std::holds_alternative<EncodedStream>(small));
  CHECK(std::get<EncodedStream>(small).bytes == std::get<EncodedStream>(whole).bytes);
}

TEST_CASE("ranks that share Gaussians write the bytes of one process") {
  Gaussians source = test::splat_cloud(5000, 2);
  // A cell with more splats than a part: its parts begin in the blocks of different ranks.
  for (std::size_t i = 0; i < source.size(); i += 3) source.positions[i] = source.positions[0];
  EncodeOptions options;
  options.part_splats = 1200;
  SECTION("complete") {}
  SECTION("limited size") { options.max_bytes = 20'000; }
  SECTION("limited number") { options.vectors = 700; }
  SECTION("without parity") { options.parity = 0; }
  const EncodedStream alone = parted(source, 1200, options);
  for (const std::uint32_t count : {2u, 3u, 4u}) {
    SharedMemory state(count);
    std::vector<std::size_t> runs;
    for (const PartedResult& result : encode_ranks(state, source, options, runs)) {
      REQUIRE(std::holds_alternative<EncodedStream>(result));
      CHECK(std::get<EncodedStream>(result).written == alone.bytes.size());
    }
    CHECK(state.stream == alone.bytes);
    for (const std::size_t read : runs) {
      CHECK(read >= 2 * (50 / count));
      CHECK(read <= 2 * (50 / count + 1));
    }
  }
}

TEST_CASE("a later run uses the parts of Gaussians that an earlier run has finished") {
  const Gaussians source = test::splat_cloud(6000, 1);
  EncodeOptions options;
  options.part_splats = 700;
  const std::vector<std::byte> alone = parted(source, 700, options).bytes;
  SharedMemory state(3);
  std::vector<std::size_t> runs;
  (void)encode_ranks(state, source, options, runs);
  REQUIRE(state.stream == alone);
  CHECK(state.restored == 0);
  const std::size_t parts = state.finished.size() / 2;  // each part has a tree and chunks
  REQUIRE(parts > 8);
  // Removes every third result, and exchanges two of the others.
  std::size_t i = 0;
  std::erase_if(state.finished, [&](const auto&) { return i++ % 3 == 0; });
  const std::size_t kept = state.finished.size();
  const auto first_tree = state.finished.lower_bound("tree"), last_chunks = std::prev(first_tree);
  std::swap(first_tree->second, last_chunks->second);
  state.stream.clear();
  const std::uint64_t before = state.stores[0].size();
  for (const PartedResult& result : encode_ranks(state, source, options, runs))
    CHECK(std::holds_alternative<EncodedStream>(result));
  CHECK(state.restored == kept);
  CHECK(state.stream == alone);
  CHECK(state.stores[0].size() - before < before);
}

TEST_CASE("all ranks that share Gaussians report the error of one rank") {
  const Gaussians source = test::splat_cloud(4000, 1);
  EncodeOptions options;
  options.part_splats = 1000;
  // The last rank cannot store its splats, its trees, or its chunks.
  SharedMemory whole(3);
  std::vector<std::size_t> runs;
  (void)encode_ranks(whole, source, options, runs);
  const std::uint64_t bytes = whole.stores.back().size();
  for (const std::uint64_t most : {bytes / 10, bytes / 2, bytes - 1}) {
    SharedMemory state(3);
    for (const PartedResult& result : encode_ranks(state, source, options, runs, most)) {
      REQUIRE(std::holds_alternative<EncodeError>(result));
      CHECK(std::get<EncodeError>(result).message.find("memory") != std::string::npos);
    }
  }
}

TEST_CASE("Gaussians in parts end where the options ask") {
  const Gaussians source = test::splat_cloud(5000, 1);
  EncodeOptions options;
  options.max_bytes = 15'000;
  const EncodedStream small = parted(source, 1000, options);
  CHECK(small.bytes.size() <= 15'000);
  CHECK(small.bytes.size() > 12'000);
  CHECK(shown_by(small.bytes).size() == small.header.vectors);
  options = {};
  options.vectors = 800;
  const EncodedStream few = parted(source, 1000, options);
  CHECK(few.header.vectors >= 800);
  CHECK(few.header.vectors < 1500);
}

TEST_CASE("Gaussians in parts report a full disk, broken numbers and cancellation") {
  Gaussians source = test::splat_cloud(3000);
  EncodeOptions options;
  options.part_splats = 500;
  MemoryStore enough;
  options.spill = &enough;
  REQUIRE(std::holds_alternative<EncodedStream>(encode_gaussians(source, options)));
  // The first limit fails while parts are stored, the others at trees and clusters.
  for (const std::size_t most : {std::size_t{10'000}, std::size_t{170'000}, std::size_t{enough.size()} - 1}) {
    FullStore store(most);
    options.spill = &store;
    const auto encoded = encode_gaussians(source, options);
    REQUIRE(std::holds_alternative<EncodeError>(encoded));
    CHECK(std::get<EncodeError>(encoded).message == "the disk is full");
  }
  options.spill = nullptr;
  Progress progress;
  progress.cancelled = true;
  const auto cancelled = encode_gaussians(source, options, &progress);
  REQUIRE(std::holds_alternative<EncodeError>(cancelled));
  CHECK(std::get<EncodeError>(cancelled).message == "cancelled");
  source.scales[2500].y = std::numeric_limits<float>::infinity();
  const auto broken = encode_gaussians(source, options);
  REQUIRE(std::holds_alternative<EncodeError>(broken));
  CHECK(std::get<EncodeError>(broken).message == "Gaussian 2500 is not finite; expected finite numbers");
}

TEST_CASE("divides coincident Gaussians into parts") {
  Gaussians source = test::splat_cloud(3000);
  for (glm::vec3& p : source.positions) p = glm::vec3(0.25f);
  source.positions[5] = glm::vec3(0.5f, -1, 2);
  source.positions[6] = glm::vec3(1e6f);
  source.description.box = {};
  for (const glm::vec3& p : source.positions) source.description.box.add(p);
  CHECK(shown_by(parted(source, 400).bytes).size() == 3000);
}

TEST_CASE("cells divide positions evenly") {
  const Gaussians cloud = test::splat_cloud(10'000);
  const gaussians::SpaceCells cells(cloud.positions, 700);
  std::vector<std::size_t> counts(cells.size());
  for (const glm::vec3& p : cloud.positions) ++counts[cells.cell_of(p)];
  CHECK(cells.size() >= 15);
  CHECK(cells.size() <= 40);
  CHECK(std::ranges::max(counts) <= 700);
  CHECK(std::ranges::min(counts) >= 100);
}

}  // namespace gs::qnv::parted_stream_test
