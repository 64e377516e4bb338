#include "qnv/codecs/records/records_payload.h"

#include "qnv/base/palette.h"
#include "qnv/codecs/records/decode/records_assembly.h"
#include "qnv/sampling/order/order.h"
#include "tests/qnv/pinned_vectors.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace {

// Returns a dented ball with colours and different weights.
template <class T = Splats>
T ball(std::size_t count) {
  T geometry;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - 2 * (static_cast<double>(i) + 0.5) / static_cast<double>(count), r = std::sqrt(1 - z * z);
    const double a = static_cast<double>(i) * std::numbers::pi * (3 - std::sqrt(5));
    const glm::vec3 n(r * std::cos(a), r * std::sin(a), z);
    const float size = 1 + 0.1f * std::sin(9 * n.x);
    geometry.positions.push_back(n * size + glm::vec3(10, 20, -5));
    geometry.normals.push_back(n);
    geometry.weights.push_back(1e-4f * (1.5f + std::sin(static_cast<float>(i % 100))));
    if constexpr (std::same_as<T, Splats>) {
      geometry.colors.push_back(
          {static_cast<std::uint8_t>(100 + 99 * n.x), static_cast<std::uint8_t>(n.y > 0 ? 200 : 0), 7});
    } else {
      geometry.classes.push_back(static_cast<std::uint8_t>(i));
    }
    geometry.description.box.add(geometry.positions.back());
    geometry.description.total += geometry.weights.back();
  }
  return geometry;
}

RecordsPatch decoded(const RecordsChunk& chunk) {
  auto result = decode_records(chunk.payload);
  REQUIRE(std::holds_alternative<RecordsPatch>(result));
  return std::get<RecordsPatch>(std::move(result));
}

// Returns a patch with the entries i for which keep(i) is true.
template <class Keep>
RecordsPatch part_of(const RecordsPatch& patch, const Keep& keep) {
  RecordsPatch part;
  part.header = patch.header;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    if (!keep(i)) continue;
    part.indices.push_back(patch.indices[i]);
    part.positions.push_back(patch.positions[i]);
    part.normals.push_back(patch.normals[i]);
    part.weights.push_back(patch.weights[i]);
    part.colors.push_back(patch.colors[i]);
  }
  return part;
}

double sum_of(const std::vector<float>& weights) {
  double sum = 0;
  for (const float weight : weights) sum += weight;
  return sum;
}

// Returns the octant of the box that contains a position.
unsigned octant(const Box& box, const glm::vec3& p) {
  const float half = std::max({box.size().x, box.size().y, box.size().z}) / 2;
  return (p.x >= box.lower.x + half) | (p.y >= box.lower.y + half) << 1 | (p.z >= box.lower.z + half) << 2;
}

std::array<double, 8> by_octant(const Box& box, std::span<const glm::vec3> positions, std::span<const float> weights) {
  std::array<double, 8> sums{};
  for (std::size_t i = 0; i < positions.size(); ++i) sums[octant(box, positions[i])] += weights[i];
  return sums;
}

}  // namespace

TEST_CASE("decodes a pinned chunk to its vectors") {
  const std::vector<std::byte> bytes = read_bytes("records_chunk.bin");
  REQUIRE(bytes.size() == 48 + 12 * 8);
  auto result = decode_records(bytes);
  REQUIRE(std::holds_alternative<RecordsPatch>(result));
  const RecordsPatch& patch = std::get<RecordsPatch>(result);
  CHECK(patch.header.layer == 2);
  CHECK(patch.header.cell == RecordsCell{3, 5, 0, 7});
  CHECK(patch.header.count == 12);
  CHECK(patch.header.frame.lower == glm::vec3(-1.5f, 0.1f, 1000.25f));
  CHECK(patch.header.frame.cell == glm::vec3(0.001953125f, 0.00322294235f, 0.00146484375f));
  CHECK(patch.header.frame.weight_step == 0.01f);
  CHECK(patch.header.cell_weight == 123.5f);
  REQUIRE(patch.size() == 12);
  // Two lines of records.txt, computed by other code.
  CHECK(patch.positions[2] == glm::vec3(-1.49707031f, 0.108057357f, 1000.25513f));
  CHECK(patch.weights[2] == 0.0599999987f);
  CHECK(patch.colors[2] == 7);
  CHECK(patch.positions[11] == glm::vec3(-0.467773438f, 0.965360045f, 1001.52368f));
  CHECK(patch.weights[11] == 282.529999f);
  CHECK(patch.colors[11] == 254);
}

TEST_CASE("pins the encoding of one vector") {
  Volume geometry;
  geometry.positions = {{1, 2, 3}};
  geometry.normals = {{0, 0, 1}};
  geometry.weights = {0.5f};
  geometry.classes = {9};
  geometry.description.box.add({0, 0, 0});
  geometry.description.box.add({4, 4, 4});
  const std::vector<RecordsChunk> chunks = encode_records(geometry, {});
  REQUIRE(chunks.size() == 1);
  const std::vector<std::byte>& p = chunks[0].payload;
  REQUIRE(p.size() == 56);
  const auto number = [&](std::size_t at) {
    std::uint32_t v = 0;
    std::memcpy(&v, &p[at], 4);
    return v;
  };
  CHECK(number(0) == (0u | 0u << 8 | 1u << 16));  // layer, depth, count
  CHECK((number(4) == 0 && number(8) == 0 && number(12) == 0));
  CHECK(number(16) == 0x3f800000);                                 // 1
  CHECK(number(20) == 0x40000000);                                 // 2
  CHECK(number(24) == 0x40400000);                                 // 3
  CHECK((number(28) == 0 && number(32) == 0 && number(36) == 0));  // a box without extent
  CHECK(number(40) == std::bit_cast<std::uint32_t>(0.5f / 32767));
  CHECK(number(44) == 0x3f000000);  // 0.5
  CHECK(number(48) == 0);           // all codes 0
  CHECK(number(52) == (32767u << 9 | 9u << 24));
}

TEST_CASE("encodes each vector in one chunk, within half a step of its position") {
  const Splats geometry = ball(30'000);
  const std::vector<Rgb8> palette = make_palette(geometry.colors);
  const std::vector<std::uint8_t> indices = palette_indices(geometry.colors, palette);
  RecordsOptions options;
  options.palette = palette;
  const std::vector<RecordsChunk> chunks = encode_records(geometry, options);
  const std::vector<std::uint32_t> order =
      progressive_order(geometry.positions, geometry.normals, geometry.weights, {});
  std::vector<std::size_t> rank(geometry.size());
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
  // Finds each record's vector: the nearest one of its layer, by a grid of positions.
  std::map<std::tuple<int, int, int>, std::vector<std::uint32_t>> grid;
  const auto cell_of = [](const glm::vec3& p) {
    return std::tuple(static_cast<int>(std::floor(p.x * 50)), static_cast<int>(std::floor(p.y * 50)),
                      static_cast<int>(std::floor(p.z * 50)));
  };
  for (std::uint32_t i = 0; i < geometry.size(); ++i) grid[cell_of(geometry.positions[i])].push_back(i);
  std::vector<bool> found(geometry.size());
  std::size_t layer_end[] = {768, 3072, 12288, 49152}, total = 0;
  std::uint8_t layer = 0;
  std::size_t last_first_rank = 0;
  for (const RecordsChunk& chunk : chunks) {
    const RecordsPatch patch = decoded(chunk);
    REQUIRE(patch.size() == chunk.header.count);
    REQUIRE(patch.header == chunk.header);
    REQUIRE(patch.size() <= 1000);
    REQUIRE(patch.header.layer >= layer);  // coarse chunks first
    if (patch.header.layer > layer) last_first_rank = 0;
    layer = patch.header.layer;
    REQUIRE(layer < 4);
    total += patch.size();
    std::size_t last_rank = 0;
    for (std::size_t k = 0; k < patch.size(); ++k) {
      const glm::vec3 half = patch.header.frame.cell * 0.5f;
      std::uint32_t match = 0;
      int matches = 0;
      const auto [cx, cy, cz] = cell_of(patch.positions[k]);
      for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dz = -1; dz <= 1; ++dz) {
            const auto cell = grid.find({cx + dx, cy + dy, cz + dz});
            if (cell == grid.end()) continue;
            for (const std::uint32_t i : cell->second) {
              const glm::vec3 d = geometry.positions[i] - patch.positions[k];
              if (found[i] || std::abs(d.x) > half.x + 3e-6f || std::abs(d.y) > half.y + 3e-6f ||
                  std::abs(d.z) > half.z + 3e-6f)
                continue;
              match = i, ++matches;
            }
          }
      REQUIRE(matches == 1);
      found[match] = true;
      REQUIRE(rank[match] < layer_end[layer]);
      REQUIRE((k == 0 || rank[match] > last_rank));  // progressive within the chunk
      last_rank = rank[match];
      if (k == 0) {
        REQUIRE(rank[match] >= last_first_rank);
        last_first_rank = rank[match];
      }
      REQUIRE(std::abs(patch.weights[k] - geometry.weights[match]) <= patch.header.frame.weight_step * 0.51f);
      REQUIRE(patch.colors[k] == indices[match]);
    }
  }
  CHECK(total == geometry.size());
  CHECK(layer == 3);
}

TEST_CASE("makes chunks of useful size that resolve more than the whole box does") {
  const Splats geometry = ball(60'000);
  const std::vector<RecordsChunk> chunks = encode_records(geometry, {});
  REQUIRE(chunks.size() > 30);
  CHECK(chunks[0].header.count == 768);
  CHECK(chunks[0].header.cell == RecordsCell{});
  std::size_t small = 0;
  for (const RecordsChunk& chunk : chunks) {
    CHECK((chunk.payload.size() - kRecordsHeaderBytes) % kRecordBytes == 0);
    small += chunk.header.count < 100;
    if (chunk.header.layer < 3) continue;
    for (int axis = 0; axis < 3; ++axis)
      CHECK(chunk.header.frame.cell[axis] < geometry.description.box.size()[axis] / 1024 / 1.9f);
  }
  CHECK(small < chunks.size() / 6);
}

TEST_CASE("makes chunks that do not depend on threads, within seeds and limits") {
  const Splats geometry = ball(40'000);
  const auto bytes = [&](const RecordsOptions& options) {
    std::vector<std::byte> all;
    for (const RecordsChunk& chunk : encode_records(geometry, options))
      all.insert(all.end(), chunk.payload.begin(), chunk.payload.end());
    return all;
  };
  RecordsOptions one, three, other, few;
  one.threads = 1;
  three.threads = 3;
  other.seed = 2;
  few.vectors = 5000;
  CHECK(bytes(one) == bytes(three));
  CHECK(bytes(one) != bytes(other));
  std::size_t count = 0;
  double weight = 0;
  for (const RecordsChunk& chunk : encode_records(geometry, few)) {
    count += chunk.header.count;
    if (chunk.header.layer == 0) weight = chunk.header.cell_weight;
  }
  CHECK(count == 5000);
  CHECK(weight == Approx(geometry.description.total).epsilon(1e-6));  // of all vectors, sent or not
}

TEST_CASE("encodes inputs with invalid or coincident vectors") {
  CHECK(encode_records(Splats(), {}).empty());
  auto geometry = ball<Volume>(500);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  geometry.positions[3].y = nan;
  geometry.weights[5] = 0;
  geometry.weights[6] = nan;
  geometry.positions[8].z = 1e38f;
  std::size_t count = 0;
  for (const RecordsChunk& chunk : encode_records(geometry, {})) count += decoded(chunk).size();
  CHECK(count == 496);
  Splats same;  // all coincident
  for (int i = 0; i < 3000; ++i) {
    same.positions.push_back({1, 2, 3});
    same.normals.push_back({0, 1, 0});
    same.weights.push_back(2);
  }
  same.description.box.add({1, 2, 3});
  same.description.total = 6000;
  count = 0;
  RecordsAssembly assembly(same.description);
  for (const RecordsChunk& chunk : encode_records(same, {})) {
    const RecordsPatch patch = decoded(chunk);
    count += patch.size();
    CHECK(patch.positions[0] == glm::vec3(1, 2, 3));
    assembly.add(patch);
  }
  CHECK(count == 3000);
  CHECK(sum_of(assembly.conserved_weights()) == Approx(6000));
  Progress progress;
  progress.cancelled = true;
  RecordsOptions options;
  options.progress = &progress;
  CHECK(encode_records(ball(30'000), options).empty());
}

TEST_CASE("decodes every prefix of a chunk to its complete records") {
  const Splats geometry = ball(200);
  const std::vector<RecordsChunk> chunks = encode_records(geometry, {});
  REQUIRE(chunks.size() == 1);
  const RecordsPatch whole = decoded(chunks[0]);
  for (std::size_t bytes = 0; bytes <= chunks[0].payload.size(); ++bytes) {
    const std::vector<std::byte> prefix(chunks[0].payload.begin(),
                                        chunks[0].payload.begin() + static_cast<std::ptrdiff_t>(bytes));
    const auto result = decode_records(prefix);
    if (bytes < kRecordsHeaderBytes) {
      CHECK_FALSE(std::get<RecordsError>(result).message.empty());
      continue;
    }
    const RecordsPatch& patch = std::get<RecordsPatch>(result);
    REQUIRE(patch.size() == (bytes - kRecordsHeaderBytes) / kRecordBytes);
    REQUIRE(std::equal(patch.positions.begin(), patch.positions.end(), whole.positions.begin()));
    REQUIRE(std::equal(patch.weights.begin(), patch.weights.end(), whole.weights.begin()));
  }
  std::vector<std::byte> longer = chunks[0].payload;
  longer.push_back(std::byte{0});
  CHECK(std::holds_alternative<RecordsError>(decode_records(longer)));
}

TEST_CASE("drops records in lost ranges") {
  const RecordsChunk chunk = encode_records(ball(100), {}).at(0);
  const RecordsPatch whole = decoded(chunk);
  const std::vector<ByteRange> missing{{48 + 8 * 20 + 7, 48 + 8 * 22 + 1}, {10, 10}, {48 + 8 * 98, 100'000}, {48, 49}};
  const RecordsPatch patch = std::get<RecordsPatch>(decode_records(chunk.payload, missing));
  std::vector<std::uint16_t> expected;
  for (std::uint16_t i = 0; i < 100; ++i)
    if (i != 0 && !(i >= 20 && i <= 22) && i < 98) expected.push_back(i);
  REQUIRE(patch.indices == expected);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    CHECK(patch.positions[k] == whole.positions[expected[k]]);
    CHECK(patch.normals[k] == whole.normals[expected[k]]);
  }
  const std::vector<ByteRange> in_header{{47, 48}};
  CHECK(std::holds_alternative<RecordsError>(decode_records(chunk.payload, in_header)));
}

TEST_CASE("rejects damaged chunks or decodes them to finite vectors") {
  const Splats geometry = ball(60);
  const std::vector<std::byte> good = encode_records(geometry, {}).at(0).payload;
  std::mt19937 random(1);
  RecordsAssembly assembly(geometry.description);
  std::size_t decoded_ones = 0;
  const auto check = [&](const std::vector<std::byte>& bytes) {
    const auto result = decode_records(bytes);
    const auto* patch = std::get_if<RecordsPatch>(&result);
    if (!patch) return;
    ++decoded_ones;
    for (std::size_t i = 0; i < patch->size(); ++i) {
      REQUIRE_EACH((std::isfinite(patch->positions[i].x) && std::isfinite(patch->positions[i].y) &&
                    std::isfinite(patch->positions[i].z)));
      REQUIRE_EACH((patch->weights[i] > 0 && std::isfinite(patch->weights[i])));
    }
    assembly.add(*patch);
  };
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::vector<std::byte> bytes = good;
    bytes[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    check(bytes);
  }
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::byte> bytes = good;
    for (int k = 0; k < 6; ++k) bytes[random() % 48] = static_cast<std::byte>(random());
    bytes.resize(random() % (bytes.size() + 1));
    check(bytes);
  }
  CHECK(decoded_ones > 500);
  for (const float weight : assembly.conserved_weights()) REQUIRE_EACH((weight >= 0 && std::isfinite(weight)));
}

TEST_CASE("keeps the weight of the whole and of its octants in every prefix of the chunks") {
  const Splats surface = ball(25'000);
  const auto volume = ball<Volume>(25'000);
  for (const VectorView& geometry : {VectorView(surface), VectorView(volume)}) {
    const Box& box = geometry.description.box;
    const std::array<double, 8> source = by_octant(box, geometry.positions, geometry.weights);
    RecordsAssembly assembly(geometry.description);
    for (const RecordsChunk& chunk : encode_records(geometry, {})) {
      CHECK(assembly.add(decoded(chunk)) == chunk.header.count);
      const std::vector<float> weights = assembly.conserved_weights();
      REQUIRE(weights.size() == assembly.size());
      REQUIRE(sum_of(weights) == Approx(geometry.description.total).epsilon(1e-5));
      if (assembly.size() < 768) continue;
      // Only deeper chunks have weights of octants. Before them, the weights of octants are as even as the order of
      // vectors.
      const std::array<double, 8> got = by_octant(box, assembly.positions(), weights);
      for (std::size_t i = 0; i < 8; ++i)
        REQUIRE(got[i] == Approx(source[i]).epsilon(assembly.size() < 4000 ? 0.2 : 0.02));
    }
    CHECK(assembly.size() == geometry.size());
    const std::vector<float> weights = assembly.conserved_weights();
    for (std::size_t i = 0; i < weights.size(); ++i)
      REQUIRE_EACH(weights[i] == Approx(assembly.weights()[i]).epsilon(2e-3));
  }
}

TEST_CASE("keeps the weight of every cell, whichever records are lost") {
  const Splats geometry = ball(30'000);
  const std::vector<RecordsChunk> chunks = encode_records(geometry, {});
  std::mt19937 random(2);
  for (const unsigned loss : {10u, 30u, 50u, 90u, 99u}) {
    RecordsAssembly assembly(geometry.description);
    std::vector<RecordsPatch> patches;
    for (const RecordsChunk& chunk : chunks)
      patches.push_back(part_of(decoded(chunk), [&](std::size_t) { return random() % 100 >= loss; }));
    for (std::size_t i = patches.size(); i > 1; --i) std::swap(patches[i - 1], patches[random() % i]);  // in any order
    for (const RecordsPatch& patch : patches) assembly.add(patch);
    const std::vector<float> weights = assembly.conserved_weights();
    CHECK(sum_of(weights) == Approx(geometry.description.total).epsilon(1e-5));
    // The records of each cell of a chunk sum to the weight in its header, within the shares of empty parts.
    const RecordsCube cube(geometry.description.box);
    std::size_t checked = 0;
    for (const RecordsChunk& chunk : chunks) {
      const RecordsCell& cell = chunk.header.cell;
      const unsigned shift = kDeepestRecordsCell - cell.depth;
      double sum = 0;
      std::size_t inside = 0;
      for (std::size_t i = 0; i < weights.size(); ++i) {
        const auto at = cube.cell_of(assembly.positions()[i]);
        if (at[0] >> shift != cell.x || at[1] >> shift != cell.y || at[2] >> shift != cell.z) continue;
        sum += weights[i];
        ++inside;
      }
      if (inside < 60) continue;  // in smaller cells, a single record on the border would exceed the tolerance
      ++checked;
      INFO("loss " << loss << " depth " << int{cell.depth} << " inside " << inside);
      CHECK(sum == Approx(chunk.header.cell_weight).epsilon(0.03));
    }
    CHECK(checked > (loss == 99 ? 0u : 10u));
  }
}

TEST_CASE("limits the size of a vector to twice its cell") {
  const Splats geometry = ball(30'000);
  const std::vector<RecordsChunk> chunks = encode_records(geometry, {});
  // Only five tiny records of one deep chunk are received.
  RecordsAssembly assembly(geometry.description);
  const RecordsPatch few = part_of(decoded(chunks.back()), [](std::size_t i) { return i < 5; });
  assembly.add(few);
  // The root keeps its weight from the stream's header, because the cell has too few records.
  CHECK(sum_of(assembly.conserved_weights()) == Approx(geometry.description.total).epsilon(1e-5));
  // With the whole chunk, the cell keeps its own weight. It does not get the weight of the missing rest.
  assembly.add(decoded(chunks.back()));
  CHECK(assembly.size() == chunks.back().header.count);
  CHECK(sum_of(assembly.conserved_weights()) == Approx(2 * chunks.back().header.cell_weight).epsilon(1e-4));
  // If the stream has no total, the cell has the weight of its header.
  Description unknown = geometry.description;
  unknown.total = 0;
  RecordsAssembly alone(unknown);
  alone.add(few);
  CHECK(sum_of(alone.conserved_weights()) == Approx(few.header.cell_weight).epsilon(1e-4));
  for (const unsigned kept : {1u, 3u, 20u, 300u}) {
    std::mt19937 random(kept);
    RecordsAssembly some(geometry.description);
    for (const RecordsChunk& chunk : chunks) {
      if (chunk.header.layer == 0) continue;
      some.add(part_of(decoded(chunk), [&](std::size_t) { return random() % 3000 < kept; }));
    }
    const std::vector<float> weights = some.conserved_weights();
    for (const float weight : weights) REQUIRE(weight <= 2 * geometry.description.total);
    CHECK(sum_of(weights) <= 2.00001 * geometry.description.total);
  }
}

TEST_CASE("counts repeated vectors once and adds up parts") {
  const Splats geometry = ball(5000);
  const std::vector<RecordsChunk> chunks = encode_records(geometry, {});
  RecordsAssembly whole(geometry.description), pieces(geometry.description);
  for (const RecordsChunk& chunk : chunks) {
    const RecordsPatch patch = decoded(chunk);
    CHECK(whole.add(patch) == patch.size());
    CHECK(whole.add(patch) == 0);
    const std::size_t odd = pieces.add(part_of(patch, [](std::size_t i) { return i % 2 == 1; }));
    CHECK(pieces.add(patch) == patch.size() - odd);
  }
  CHECK(whole.size() == geometry.size());
  CHECK(pieces.size() == geometry.size());
  CHECK(sum_of(pieces.conserved_weights()) == Approx(sum_of(whole.conserved_weights())));
}

}  // namespace gs::qnv
