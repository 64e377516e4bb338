#include "qnv/codecs/voxels/voxels.h"

#include "qnv/base/morton.h"
#include "qnv/codecs/voxels/voxels_layout.h"
#include "tests/qnv/voxel_volumes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace volume_voxels_test {

using Bytes = std::vector<std::byte>;

/// All clusters of a stream; a parent's index is its number.
struct Decoded {
  VoxelLattice lattice;
  std::vector<Bytes> payloads;
  std::vector<VolumeCluster> clusters;

  explicit Decoded(const EncodedStream& stream) : lattice(stream.header.lattice), payloads(clusters_of(stream.bytes)) {
    for (const Bytes& payload : payloads) {
      const auto header = std::get<ClusterHeader>(read_volume_cluster_header(payload));
      REQUIRE(header.id == clusters.size());
      REQUIRE((header.parent == kNoParent) == clusters.empty());
      auto result = decode_volume_cluster(payload, parent_of(header), lattice);
      if (const auto* error = std::get_if<PackedError>(&result)) FAIL(error->message);
      clusters.push_back(std::get<VolumeCluster>(std::move(result)));
    }
  }
  [[nodiscard]] const VolumeCluster* parent_of(const ClusterHeader& header) const {
    return header.parent == kNoParent ? nullptr : &clusters.at(header.parent);
  }
};

std::uint64_t key_of(const VolumeVoxels& v, std::size_t i) { return morton_encode(v.x[i], v.y[i], v.z[i]); }

/// vectors of the volume by voxel
std::map<std::uint64_t, std::size_t> places_of(const SoftBall& ball) {
  const VolumeLayout& layout = ball.source.layout;
  const glm::dmat3 inverse = glm::inverse(glm::dmat3(layout.axes[0], layout.axes[1], layout.axes[2]));
  std::map<std::uint64_t, std::size_t> places;
  for (std::size_t i = 0; i < ball.geometry.size(); ++i) {
    const glm::dvec3 at = inverse * (glm::dvec3(ball.geometry.positions[i]) - glm::dvec3(layout.origin));
    const auto whole = [&](int axis) { return static_cast<std::uint32_t>(std::lround(at[axis])); };
    places[morton_encode(whole(0), whole(1), whole(2))] = i;
  }
  return places;
}

TEST_CASE("restores a volume's vectors at their voxels, with small errors") {
  const SoftBall ball(24);
  const Decoded all(ball.stream());
  const std::map<std::uint64_t, std::size_t> truth = places_of(ball);
  REQUIRE(truth.size() == ball.geometry.size());
  std::set<std::uint64_t> seen;
  double turned = 0;
  for (const VolumeCluster& cluster : all.clusters) {
    if (cluster.level() != all.lattice.depth) continue;
    Volume geometry;
    append_vectors(cluster, 0, cluster.voxels.size(), all.lattice, geometry);
    for (std::size_t i = 0; i < geometry.size(); ++i) {
      const auto found = truth.find(key_of(cluster.voxels, i));
      REQUIRE(found != truth.end());
      REQUIRE(seen.insert(found->first).second);
      const std::size_t k = found->second;
      REQUIRE_EACH(glm::distance(geometry.positions[i], ball.geometry.positions[k]) < 1e-4f);
      REQUIRE_EACH(glm::length(geometry.normals[i]) == Approx(1).epsilon(1e-5));
      // The encoder omits corrections below 0.62 of a step of 16. Rounding adds half a unit.
      REQUIRE_EACH(std::abs(geometry.classes[i] - ball.geometry.classes[k]) <= 10);
      // The error of magnitudes is below 0.75 of a step. A step is one and a half octaves.
      const float octaves = std::log2(geometry.weights[i] / ball.geometry.weights[k]);
      REQUIRE_EACH(std::abs(octaves) <= 1.13f);
      const float cosine = glm::dot(geometry.normals[i], ball.geometry.normals[k]);
      REQUIRE_EACH(cosine > 0.5f);
      turned += std::acos(std::min(cosine, 1.0f));
    }
  }
  CHECK(seen.size() == truth.size());
  CHECK(turned / static_cast<double>(seen.size()) < 0.2);  // radians, at the strongest curvature
}

TEST_CASE("gives a coarse voxel a value between its children's, and their mean if they are fine") {
  const SoftBall ball(24);
  const Decoded all(ball.stream());
  const std::map<std::uint64_t, std::size_t> truth = places_of(ball);
  struct Values {
    double sum = 0, least = 255, most = 0;
    int count = 0;
  };
  std::size_t means = 0;
  for (const VolumeCluster& cluster : all.clusters) {
    std::map<std::uint64_t, Values> inside;
    for (const auto& [key, k] : truth) {
      Values& v = inside[key >> (3 * (all.lattice.depth - cluster.level()))];
      const double value = ball.geometry.classes[k];
      v = {v.sum + value, std::min(v.least, value), std::max(v.most, value), v.count + 1};
    }
    for (std::size_t i = 0; i < cluster.voxels.size(); ++i) {
      const auto found = inside.find(key_of(cluster.voxels, i));
      REQUIRE(found != inside.end());
      const Values& v = found->second;
      REQUIRE_EACH(cluster.voxels.value[i] >= v.least - 10);
      REQUIRE_EACH(cluster.voxels.value[i] <= v.most + 10);
      if (cluster.level() + 1 != all.lattice.depth) continue;
      REQUIRE_EACH(std::abs(cluster.voxels.value[i] - v.sum / v.count) <= 10.01);
      ++means;
    }
  }
  CHECK(means > 100);
}

TEST_CASE("finds the voxels of a cluster that share a face") {
  const Decoded all(SoftBall(24).stream());
  std::size_t linked = 0;
  for (const VolumeCluster& cluster : all.clusters) {
    const VolumeVoxels& v = cluster.voxels;
    if (cluster.level() == all.lattice.depth) {
      CHECK(v.neighbours.empty());
      continue;
    }
    REQUIRE(v.neighbours.size() == v.size());
    std::map<std::uint64_t, std::uint16_t> places;
    for (std::size_t i = 0; i < v.size(); ++i) places[key_of(v, i)] = static_cast<std::uint16_t>(i);
    for (std::size_t i = 0; i < v.size(); ++i)
      for (unsigned side = 0; side < 6; ++side) {
        std::array<int, 3> at{v.x[i], v.y[i], v.z[i]};
        at[side / 2] += side % 2 == 0 ? -1 : 1;
        const auto found =
            at[side / 2] < 0
                ? places.end()
                : places.find(morton_encode(static_cast<std::uint32_t>(at[0]), static_cast<std::uint32_t>(at[1]),
                                            static_cast<std::uint32_t>(at[2])));
        REQUIRE(v.neighbours[i][side] == (found == places.end() ? kNoNeighbour : found->second));
        linked += found != places.end();
      }
  }
  CHECK(linked > 100);
}

TEST_CASE("fits volume clusters into a datagram, equally on any number of threads") {
  const SoftBall ball(40, 0.3);
  EncodeOptions one, four;
  one.threads = 1;
  four.threads = 4;
  const EncodedStream stream = ball.stream(one);
  CHECK(stream.bytes == ball.stream(four).bytes);
  const std::vector<Bytes> payloads = clusters_of(stream.bytes);
  CHECK(payloads.size() > 5);
  CHECK(payloads.front().size() <= 640);
  for (const Bytes& payload : payloads) CHECK(payload.size() <= 1200);
}

void check_sound(const VolumeCluster& cluster, std::size_t bytes, const VoxelLattice& lattice) {
  REQUIRE(cluster.voxels.size() <= 64 * bytes);
  Volume geometry;
  append_vectors(cluster, 0, cluster.voxels.size(), lattice, geometry);
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    REQUIRE_EACH((geometry.weights[i] > 0 && std::isfinite(geometry.weights[i])));
    REQUIRE_EACH(glm::length(geometry.normals[i]) == Approx(1).epsilon(1e-5));
    REQUIRE_EACH(cluster.voxels.magnitude[i] <= kMaxMagnitude);
  }
}

TEST_CASE("survives every flipped bit of a volume cluster, and detects nearly all") {
  const Decoded all(SoftBall(24).stream());
  std::size_t unnoticed = 0, bits = 0;
  for (const std::size_t which : {std::size_t{0}, all.payloads.size() - 1}) {
    const VolumeCluster* parent = all.parent_of(all.clusters[which].header);
    Bytes payload = all.payloads[which];
    for (std::size_t bit = 8 * 14; bit < 8 * payload.size(); bit += watched_step(3), ++bits) {
      payload[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
      const auto result = decode_volume_cluster(payload, parent, all.lattice);
      if (const auto* cluster = std::get_if<VolumeCluster>(&result)) {
        ++unnoticed;
        check_sound(*cluster, payload.size(), all.lattice);
      }
      payload[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    }
  }
  INFO(unnoticed << " of " << bits);
  CHECK(unnoticed * 10 < bits);
}

Bytes header_bytes(const ClusterHeader& header, std::size_t size) {
  Bytes out;
  write_volume_cluster_header(header, {}, out);
  out.resize(size);
  return out;
}

TEST_CASE("rejects impossible headers of volume clusters") {
  VoxelLattice lattice;
  lattice.depth = 6;
  lattice.dimensions = {64, 64, 64};
  VolumeCluster parent;
  parent.header.levels = 3;
  parent.voxels.resize(100);
  parent.voxels.neighbours.resize(100);
  for (auto& around : parent.voxels.neighbours) around.fill(kNoNeighbour);
  const ClusterHeader good{1, 0, 0, 8, 3, 1};
  const auto refusal = [&](const Bytes& payload, const VolumeCluster* above) {
    const auto result = decode_volume_cluster(payload, above, lattice);
    const auto* error = std::get_if<PackedError>(&result);
    return error ? error->message : "";
  };
  const auto with = [&](auto change) {
    ClusterHeader header = good;
    change(header);
    return refusal(header_bytes(header, 400), &parent);
  };
  CHECK(with([](ClusterHeader& h) { h.levels = 0; }) != "");
  CHECK(with([](ClusterHeader& h) { h.levels = 4; }) == "a cluster of level 7; the lattice ends at 6");
  CHECK(with([](ClusterHeader& h) { h.level = 255; }) != "");
  CHECK(with([](ClusterHeader& h) { h.level = 2; }) == "a cluster of another level than its parent");
  CHECK(with([](ClusterHeader& h) { h.count = 0; }) == "a cluster divides no voxel");
  CHECK(with([](ClusterHeader& h) { h.id = kNoParent; }) == "a cluster with the reserved number");
  CHECK(with([](ClusterHeader& h) { h.parent = kNoParent; }) == "a cluster without a parent does not divide the root");
  CHECK(with([](ClusterHeader& h) { h.first = 99; }) == "a cluster divides voxels 99 to 106 of 100");
  CHECK(refusal(header_bytes(good, 400), nullptr) == "a cluster without its parent");
  CHECK(refusal(header_bytes(good, 23), &parent) == "a cluster of 23 bytes; expected 24 at least");
  for (const auto& [at, value] : {std::pair{15, 0}, {16, 0}, {16, 65}, {17, 0}, {17, 128}}) {
    Bytes impossible = header_bytes(good, 400);
    impossible[static_cast<std::size_t>(at)] = static_cast<std::byte>(value);
    CHECK(refusal(impossible, &parent) == "a cluster with invalid steps of values, directions or magnitudes");
  }
}

TEST_CASE("rejects random bytes as volume clusters, or decodes them to voxels within the limits") {
  std::mt19937 random(99);
  VoxelLattice lattice;
  lattice.depth = 16;
  lattice.dimensions = {65536, 65536, 65536};
  VolumeCluster parent;
  parent.header.levels = 3;
  VolumeVoxels& voxels = parent.voxels;
  voxels.resize(5000);
  voxels.neighbours.resize(5000);
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    voxels.u[i] = static_cast<std::int16_t>(static_cast<int>(random() % 2049) - 1024);
    voxels.v[i] = static_cast<std::int16_t>(static_cast<int>(random() % 2049) - 1024);
    voxels.value[i] = static_cast<std::uint8_t>(random());
    voxels.magnitude[i] = static_cast<std::uint8_t>(random() % 128);
    voxels.activity[i] = static_cast<std::uint8_t>(random() % 16);
    for (std::uint16_t& n : voxels.neighbours[i])
      n = random() % 3 == 0 ? kNoNeighbour : static_cast<std::uint16_t>(random() % 5000);
  }
  for (int i = 0; i < 3000; i += static_cast<int>(watched_step(5))) {
    const bool root = i % 3 == 0;
    ClusterHeader header{1, 0, 0, static_cast<std::uint16_t>(1 + random() % 5000), 3, 1};
    if (root) header = {1, kNoParent, 0, 1, 0, static_cast<std::uint8_t>(1 + random() % 16)};
    Bytes payload = header_bytes(header, 24 + random() % 1500);
    for (std::size_t k = 14; k < payload.size(); ++k)
      payload[k] = i % 7 == 0 ? std::byte{255} : static_cast<std::byte>(random());
    payload[16] = static_cast<std::byte>(1 + random() % 64);
    payload[17] = static_cast<std::byte>(1 + random() % 127);
    const auto result = decode_volume_cluster(payload, root ? nullptr : &parent, lattice);
    if (const auto* cluster = std::get_if<VolumeCluster>(&result)) check_sound(*cluster, payload.size(), lattice);
  }
}

TEST_CASE("uses the voxel tables of FORMAT.md") {
  const auto& logistic = logistic_table();
  for (std::size_t i = 0; i < logistic.size(); ++i) {
    const double exact = 4096 / (1 + std::exp(-static_cast<double>(i) / 8));
    CHECK(std::abs(logistic[i] - exact) <= 0.5);
  }
  CHECK(probability_of(-1000, logistic, 32) == 1);
  CHECK(probability_of(1000, logistic, 32) == 4095);
  CHECK(probability_of(0, logistic, 16) == 2048);
  CHECK(probability_of(16, logistic, 16) == 2994);  // 16/16 * 16/16: one, 8 eighths
  CHECK(probability_of(-16, logistic, 16) == 4096 - 2994);
  CHECK(occupancy_odds()[0][1][0][1] == -42);
}

TEST_CASE("rejects impossible lattices") {
  VoxelLattice good;
  good.depth = 5;
  good.dimensions = {32, 20, 1};
  good.lengths = {256, 128, 1};
  const auto again = decode_voxel_lattice(encode_voxel_lattice(good));
  REQUIRE(again);
  CHECK(*again == good);
  const auto refused = [&](auto change) {
    VoxelLattice lattice = good;
    change(lattice);
    return !decode_voxel_lattice(encode_voxel_lattice(lattice));
  };
  CHECK(refused([](VoxelLattice& l) { l.depth = 0; }));
  CHECK(refused([](VoxelLattice& l) { l.depth = 17; }));
  CHECK(refused([](VoxelLattice& l) { l.dimensions[0] = 33; }));
  CHECK(refused([](VoxelLattice& l) { l.dimensions[2] = 0; }));
  CHECK(refused([](VoxelLattice& l) { l.lengths[1] = 0; }));
  CHECK(refused([](VoxelLattice& l) { l.lengths[1] = 257; }));
  CHECK(refused([](VoxelLattice& l) { l.unit = 0; }));
  CHECK(refused([](VoxelLattice& l) { l.unit = std::numeric_limits<float>::infinity(); }));
  CHECK(refused([](VoxelLattice& l) { l.axes[2] = l.axes[0] + l.axes[1]; }));
  CHECK(refused([](VoxelLattice& l) { l.axes[0] = glm::vec3(3e38f, 0, 0); }));
  CHECK(refused([](VoxelLattice& l) { l.axes[1] = glm::vec3(0); }));
  CHECK(refused([](VoxelLattice& l) { l.origin.y = std::numeric_limits<float>::quiet_NaN(); }));
  const Bytes section = encode_voxel_lattice(good);
  CHECK(section.size() == 72);
  for (std::size_t bytes = 0; bytes < section.size(); ++bytes)
    CHECK(!decode_voxel_lattice(std::span(section).first(bytes)));
}

}  // namespace volume_voxels_test
}  // namespace gs::qnv
