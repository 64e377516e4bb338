#include "qnv/codecs/voxels/encode/encode_voxels.h"

#include "qnv/base/morton.h"
#include "qnv/reader/decode_stream.h"
#include "qnv/reader/loss.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/voxel_volumes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace encode_voxels_test {

using Bytes = std::vector<std::byte>;

/// Set of the octree cells that a volume shows.
class Cells {
 public:
  explicit Cells(const VoxelLattice& lattice) : lattice_(lattice) {
    inverse_ = glm::inverse(glm::dmat3(lattice.axes[0], lattice.axes[1], lattice.axes[2]));
  }
  [[nodiscard]] std::uint64_t key_of(const glm::vec3& position, int level) const {
    const glm::dvec3 at = inverse_ * (glm::dvec3(position) - glm::dvec3(lattice_.origin));
    const int shift = lattice_.depth - level;
    const auto cell = [&](int axis) {
      return static_cast<std::uint32_t>(std::max(0.0, std::floor(at[axis] + 0.51))) >> shift;
    };
    return morton_encode(cell(0), cell(1), cell(2));
  }
  [[nodiscard]] int level_of(const Cell& cell) const {
    for (int level = 0; level < lattice_.depth; ++level)
      if (cell.edge == lattice_.reach(level)) return level;
    CHECK(cell.edge == 0);
    return lattice_.depth;
  }
  /// Checks that every source vector is in one shown cell, and that no cell is inside another.
  void check_cover(const Volume& shown, const Volume& source) const {
    std::set<std::pair<int, std::uint64_t>> cells;
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const int level = level_of(shown.cells[i]);
      REQUIRE_EACH(cells.emplace(level, key_of(shown.positions[i], level)).second);
    }
    for (const glm::vec3& position : source.positions) {
      int covered = 0;
      for (int level = 0; level <= lattice_.depth; ++level)
        covered += cells.contains({level, key_of(position, level)}) ? 1 : 0;
      REQUIRE_EACH(covered == 1);
    }
  }

 private:
  VoxelLattice lattice_;
  glm::dmat3 inverse_;
};

bool same(const Volume& a, const Volume& b) {
  return a.description == b.description && a.positions == b.positions && a.normals == b.normals &&
         a.weights == b.weights && a.classes == b.classes;
}

Volume vectors_of(std::span<const std::byte> bytes) {
  StreamDecoder decoder;
  (void)decoder.push(bytes);
  return content_of<Volume>(decoder.geometry());
}

TEST_CASE("decodes every prefix of a volume stream to a complete picture") {
  const SoftBall ball(24);
  const EncodedStream stream = ball.stream();
  const Cells cells(stream.header.lattice);
  StreamDecoder decoder;
  std::uint64_t last = 0;
  std::size_t pictures = 0;
  for (const std::byte& byte : stream.bytes) {
    REQUIRE(decoder.push(std::span(&byte, 1)));
    if (decoder.revision() == last) continue;
    last = decoder.revision();
    ++pictures;
    const Volume geometry = content_of<Volume>(decoder.geometry());
    REQUIRE(geometry.size() == decoder.vectors());
    cells.check_cover(geometry, ball.geometry);
  }
  decoder.finish();
  CHECK(pictures == stream.header.chunks);
  CHECK(decoder.problems().empty());
  CHECK(decoder.refused_chunks() == 0);
  CHECK(decoder.vectors() == ball.geometry.size());
  CHECK(stream.header.vectors == ball.geometry.size());
  CHECK(decoder.directory().size() == stream.header.chunks);
}

TEST_CASE("decodes a volume stream to the same vectors wherever it is split") {
  const EncodedStream stream = SoftBall(16).stream();
  const Volume whole = vectors_of(stream.bytes);
  for (std::size_t split = 0; split <= stream.bytes.size(); split += watched_step(7)) {
    StreamDecoder decoder;
    (void)decoder.push(std::span(stream.bytes).first(split));
    (void)decoder.push(std::span(stream.bytes).subspan(split));
    REQUIRE(same(content_of<Volume>(decoder.geometry()), whole));
  }
}

TEST_CASE("leaves no hole with voxel clusters in any order and with any losses") {
  const SoftBall ball(24);
  const EncodedStream stream = ball.stream();
  const Cells cells(stream.header.lattice);
  const std::vector<Bytes> payloads = clusters_of(stream.bytes);
  const Volume whole = vectors_of(stream.bytes);
  std::mt19937 random(5);
  for (std::size_t round = 0; round < 60; round += watched_step(7)) {
    std::vector<std::size_t> order(payloads.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    if (round % 2 == 1) {  // loses some clusters, but not the first
      order.resize(order.size() - random() % (order.size() / 2 + 1));
      if (std::find(order.begin(), order.end(), 0u) == order.end()) order.push_back(0);
    }
    StreamDecoder decoder;
    REQUIRE(decoder.push(encode_header(stream.header)));
    for (const std::size_t i : order) decoder.add(ChunkType::voxels, payloads[i]);
    decoder.add(ChunkType::voxels, payloads[order.front()]);  // a repeated cluster is refused, or waits endlessly
    cells.check_cover(content_of<Volume>(decoder.geometry()), ball.geometry);
    if (round % 2 == 0) REQUIRE(same(content_of<Volume>(decoder.geometry()), whole));
  }
  // Lost packets.
  const EncodedStream large = SoftBall(40, 0.3).stream();
  const Bytes lossy = drop_packets(large.bytes, 0.5, 3);
  CHECK(lossy.size() < large.bytes.size());
  const DecodedStream some = decode_stream(lossy, 1 << 20);
  CHECK(some.problems.empty());
  CHECK(std::get<Geometry>(some.content).size() > 0);
}

TEST_CASE("covers the whole volume with the first vectors of a volume stream") {
  const SoftBall ball(32);
  const Volume geometry = vectors_of(ball.stream().bytes);
  REQUIRE(geometry.size() == ball.geometry.size());
  std::map<std::array<int, 3>, std::array<int, 2>> blocks;  // number of vectors in each block: all, first eighth
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    const glm::vec3 part =
        (geometry.positions[i] - geometry.description.box.lower) / geometry.description.box.size() * 3.99f;
    auto& count = blocks[{static_cast<int>(part.x), static_cast<int>(part.y), static_cast<int>(part.z)}];
    ++count[0];
    count[1] += i < geometry.size() / 8 ? 1 : 0;
  }
  std::size_t full = 0;
  for (const auto& [block, count] : blocks) {
    if (count[0] < 80) continue;
    ++full;
    CHECK(count[1] * 16 > count[0]);
    CHECK(count[1] * 4 < count[0]);
  }
  CHECK(full > 10);
}

TEST_CASE("keeps the byte budget of a volume stream, or reports that it cannot") {
  const SoftBall ball(40, 0.3);
  for (const std::size_t most : {1500, 3000, 10000, 30000}) {
    EncodeOptions options;
    options.max_bytes = most;
    const EncodedStream stream = ball.stream(options);
    CHECK(stream.bytes.size() <= most);
    CHECK(vectors_of(stream.bytes).size() == stream.header.vectors);
  }
  EncodeOptions none;
  none.max_bytes = 100;
  CHECK(std::holds_alternative<EncodeError>(encode_voxels(ball.vectors(), none)));
}

TEST_CASE("refuses vectors that are not at the voxels of a volume") {
  const SoftBall ball(12);
  const auto refused = [&](auto change) {
    Volume geometry = ball.geometry;
    VolumeLayout layout = ball.source.layout;
    change(geometry, layout);
    return std::holds_alternative<EncodeError>(encode_voxels(VolumeVectors{geometry, layout}, {}));
  };
  CHECK(!refused([](Volume&, VolumeLayout&) {}));
  CHECK(refused([](Volume& c, VolumeLayout&) { c.positions[3] += 0.2f; }));
  CHECK(refused([](Volume& c, VolumeLayout&) { c.positions[3] = c.positions[4]; }));
  CHECK(refused([](Volume&, VolumeLayout& l) { l.dimensions = {3, 3, 3}; }));
  CHECK(refused([](Volume&, VolumeLayout& l) { l.dimensions = {65537, 3, 3}; }));
  CHECK(refused([](Volume& c, VolumeLayout&) { c.classes.clear(); }));
  CHECK(refused([](Volume& c, VolumeLayout&) {
    Volume empty;
    empty.description = c.description;
    c = empty;
  }));
}

TEST_CASE("rejects volume clusters of a surface and unknown payloads, by name") {
  EncodedStream stream = SoftBall(12).stream();
  StreamHeader header = stream.header;
  header.kind = Kind::surface;
  const auto problem = [](const Bytes& bytes) {
    StreamDecoder decoder;
    CHECK(!decoder.push(bytes));
    return decoder.problems().empty() ? "" : decoder.problems().front().message;
  };
  CHECK(problem(encode_header(header)) == "holds voxels of a surface; expected a volume");
  header = stream.header;
  header.lattice.depth = 0;
  CHECK(problem(encode_header(header)) == "the header's section of the lattice is missing or invalid");
}

TEST_CASE("survives random changes of volume streams") {
  const EncodedStream stream = SoftBall(16).stream();
  std::mt19937 random(11);
  std::vector<Bytes> payloads = clusters_of(stream.bytes);
  const Bytes header = encode_header(stream.header);
  std::size_t taken = 0;
  // Changes bytes after the checksums, which would detect nearly all changes.
  for (std::size_t round = 0; round < 100'000; round += watched_step(50)) {
    StreamDecoder decoder(100'000);
    REQUIRE(decoder.push(header));
    for (const Bytes& payload : payloads) {
      Bytes changed = payload;
      for (std::size_t changes = random() % 3; changes > 0; --changes)
        changed[random() % changed.size()] ^= static_cast<std::byte>(1u << random() % 8);
      decoder.add(ChunkType::voxels, changed);
      if (round % 16 != 0) break;  // in most rounds, only the first chunk is changed
    }
    const Volume geometry = content_of<Volume>(decoder.geometry());
    REQUIRE_EACH(geometry.size() == decoder.vectors());
    for (const float weight : geometry.weights) REQUIRE_EACH((weight > 0 && std::isfinite(weight)));
    taken += geometry.empty() ? 0 : 1;
  }
  CHECK(taken > 0);
}

}  // namespace encode_voxels_test
}  // namespace gs::qnv
