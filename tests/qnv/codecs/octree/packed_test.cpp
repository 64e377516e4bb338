#include "qnv/codecs/octree/packed.h"

#include "qnv/base/morton.h"
#include "qnv/codecs/octree/decode/packed_kernels.h"
#include "tests/qnv/surface_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace {

Cluster decoded(std::span<const std::byte> payload, const Cluster* parent) {
  auto result = decode_cluster(payload, parent);
  if (const auto* error = std::get_if<PackedError>(&result)) FAIL(error->message);
  return std::get<Cluster>(std::move(result));
}

/// Encoded and decoded shape: all clusters by number, and the true voxels of every level.
struct Packed {
  Cube cube;
  int level;
  PackedOptions options;
  std::vector<EncodedCluster> encoded;
  std::vector<Cluster> clusters;
  std::vector<std::map<std::uint64_t, SurfaceMoments>> truth;

  Packed(const Triangles& triangles, int finest, const PackedOptions& chosen = {})
      : cube(Cube::around(box_of(triangles))), level(finest), options(chosen) {
    std::vector<Voxel> voxels = voxels_of(triangles, level);
    encoded = encode_packed(voxels, level, cube, options);
    for (const EncodedCluster& e : encoded) {
      const auto parent = e.header.parent;
      clusters.push_back(decoded(e.payload, parent == kNoParent ? nullptr : &clusters.at(parent)));
    }
    std::erase_if(voxels, [](const Voxel& voxel) { return voxel.moments.area < 0.03f; });
    truth.resize(static_cast<std::size_t>(level) + 1);
    for (std::size_t l = truth.size(); l-- > 0; voxels = coarsen(voxels))
      for (const Voxel& voxel : voxels) truth[l][voxel.key] = voxel.moments;
  }

  /// Returns the splats of all voxels of one level.
  [[nodiscard]] Splats discs(int at) const {
    Splats geometry;
    for (const Cluster& cluster : clusters)
      if (cluster.level() == at) append_discs(cluster, 0, cluster.voxels.size(), cube, geometry);
    return geometry;
  }
};

std::uint64_t key_of(const PackedVoxels& v, std::size_t i) { return morton_encode(v.x[i], v.y[i], v.z[i]); }

// Checks the encoder's guarantees for every voxel: it contains surface, and its plane is exact within half a step.
void check_promises(const Packed& packed) {
  std::vector<std::size_t> seen(packed.truth.size());
  for (std::size_t c = 0; c < packed.clusters.size(); ++c) {
    const Cluster& cluster = packed.clusters[c];
    const ClusterParameters p = read_parameters(packed.encoded[c].payload);
    double worst_turn = 0, worst_offset = 0;
    const auto& truth = packed.truth[static_cast<std::size_t>(cluster.level())];
    const PackedVoxels& v = cluster.voxels;
    seen[static_cast<std::size_t>(cluster.level())] += v.size();
    for (std::size_t i = 0; i < v.size(); ++i) {
      const auto found = truth.find(key_of(v, i));
      REQUIRE_EACH(found != truth.end());
      const SurfaceMoments& m = found->second;
      if ((v.state[i] & kDouble) != 0) {
        REQUIRE_EACH(glm::length(m.normal) <= 0.3501f * m.area);
        continue;
      }
      const auto l1 = octahedral_normal(v.u[i], v.v[i]);
      REQUIRE_EACH(std::abs(l1[0]) + std::abs(l1[1]) + std::abs(l1[2]) == kOctahedral);
      const glm::vec3 normal = glm::normalize(glm::vec3(l1[0], l1[1], l1[2])), true_normal = glm::normalize(m.normal);
      worst_turn = std::max(worst_turn, static_cast<double>(std::acos(std::min(1.0f, glm::dot(normal, true_normal)))));
      const float one_norm = std::abs(true_normal.x) + std::abs(true_normal.y) + std::abs(true_normal.z);
      const float offset = std::clamp(glm::dot(true_normal, m.position / m.area) / one_norm, -0.5f, 0.5f);
      worst_offset = std::max(worst_offset, std::abs(static_cast<double>(offset) - v.offset[i] / double{kOffsetUnits}));
    }
    // Only the first cluster may have coarser steps.
    REQUIRE_EACH(p.normal_shift <= packed.options.normal_shift + (c == 0 ? 2 : 0));
    REQUIRE_EACH(p.offset_shift <= packed.options.offset_shift + (c == 0 ? 1 : 0));
    // Half a step in both octahedral coordinates, in the middle of an octant where they turn most: sqrt(1 + 1 + 4) *
    // (1/2 step) * sqrt(3).
    const double step = std::ldexp(1.0, p.normal_shift) / kOctahedral;
    REQUIRE_EACH(worst_turn < std::sqrt(6) * std::sqrt(3) * step / 2);
    REQUIRE_EACH(worst_offset <= std::ldexp(0.5, p.offset_shift) / kOffsetUnits + 1e-4);
  }
  // Each true voxel of the levels after the first cluster occurs once.
  for (std::size_t l = static_cast<std::size_t>(packed.clusters.front().level()); l < seen.size(); ++l)
    CHECK(seen[l] == packed.truth[l].size());
}

TEST_CASE("decodes an octree sphere within the promised errors on every level") {
  const Triangles ball = sphere(100, 3, {10, -4, 2});
  for (const bool compact : {false, true}) {
    PackedOptions options;
    options.compact = compact;
    const Packed packed(ball, 7, options);
    check_promises(packed);
    for (int level = packed.clusters.front().level(); level <= 7; ++level) {
      const Splats geometry = packed.discs(level);
      const float edge = packed.cube.edge / static_cast<float>(1 << level);
      INFO("level " << level << ", " << geometry.size() << " discs, compact " << compact);
      CHECK(total_weight(geometry) == Approx(area_of(ball)).epsilon(0.05));
      float furthest = 0, most_turned = 0;
      for (std::size_t i = 0; i < geometry.size(); ++i) {
        const glm::vec3 out = geometry.positions[i] - glm::vec3(10, -4, 2);
        furthest = std::max(furthest, std::abs(glm::length(out) - 3) / edge);
        most_turned = std::max(most_turned, 1 - glm::dot(geometry.normals[i], glm::normalize(out)));
        REQUIRE_EACH(glm::length(geometry.normals[i]) == Approx(1).epsilon(1e-5));
        REQUIRE_EACH(geometry.weights[i] > 0);
        REQUIRE_EACH(geometry.cells[i].edge == edge);
        // The centre of the voxel's cube.
        const glm::vec3 cell =
            (geometry.positions[i] - geometry.normals[i] * geometry.cells[i].offset - packed.cube.lower) / edge - 0.5f;
        for (int axis = 0; axis < 3; ++axis) REQUIRE_EACH(std::abs(cell[axis] - std::round(cell[axis])) < 1e-2f);
      }
      CHECK(furthest < 0.5f);
      if (level >= 5) CHECK(most_turned < 0.03f);
    }
  }
}

TEST_CASE("keeps the faces of an octree cube, and both faces at its edges") {
  const Triangles cube = box_shape({-1, -1, -1}, {1, 1, 1}, 3);
  const Packed packed(cube, 7);
  check_promises(packed);
  const Splats geometry = packed.discs(7);
  CHECK(total_weight(geometry) == Approx(24).epsilon(0.05));
  std::size_t flat = 0;
  for (const glm::vec3& n : geometry.normals) flat += std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) > 0.999f;
  CHECK(flat > geometry.size() * 9 / 10);
}

TEST_CASE("keeps both sides of a thin sheet") {
  const Triangles sheet = two_sided_sheet();
  const Packed packed(sheet, 6);
  check_promises(packed);
  const Splats geometry = packed.discs(6);
  CHECK(total_weight(geometry) == Approx(area_of(sheet)).epsilon(0.1));
  glm::dvec3 sum(0);
  std::size_t up = 0;
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    sum += glm::dvec3(geometry.normals[i]) * static_cast<double>(geometry.weights[i]);
    up += geometry.normals[i].z > 0;
  }
  CHECK(up * 2 == geometry.size());
  CHECK(glm::length(sum) < 1e-3);
}

TEST_CASE("shows a thin plate as a sheet on coarse levels and as two faces on fine levels") {
  // At level 4 most voxels contain both faces, at level 8 one each.
  Triangles plate = two_sided_sheet();
  for (Triangle& t : plate) {
    const glm::vec3 out =
        glm::normalize(glm::cross(t.positions[1] - t.positions[0], t.positions[2] - t.positions[0])) * 0.01f;
    for (glm::vec3& p : t.positions) p += out;
  }
  const Packed packed(plate, 8);
  check_promises(packed);
  for (const int level : {4, 8}) {
    std::size_t doubles = 0, voxels = 0;
    for (const Cluster& cluster : packed.clusters)
      if (cluster.level() == level)
        for (const std::uint8_t state : cluster.voxels.state) {
          doubles += (state & kDouble) != 0;
          ++voxels;
        }
    INFO("level " << level << ": " << doubles << " of " << voxels);
    CHECK((level == 4 ? doubles * 10 > voxels * 6 : doubles * 10 < voxels));
    double up = 0, down = 0;
    const Splats geometry = packed.discs(level);
    for (std::size_t i = 0; i < geometry.size(); ++i) {
      (geometry.normals[i].z > 0 ? up : down) += geometry.weights[i];
    }
    CHECK(up == Approx(area_of(plate) / 2).epsilon(0.15));
    CHECK(down == Approx(area_of(plate) / 2).epsilon(0.15));
  }
}

TEST_CASE("restores colours within half a step") {
  PackedOptions options;
  options.colored = true;
  const Packed packed(sphere(60, 1, {}, true), 6, options);
  check_promises(packed);
  for (const Cluster& cluster : packed.clusters) {
    const PackedVoxels& v = cluster.voxels;
    REQUIRE(v.luma.size() == v.size());
    for (std::size_t i = 0; i < v.size(); ++i) {
      const SurfaceMoments& m = packed.truth[static_cast<std::size_t>(cluster.level())].at(key_of(v, i));
      const auto whole = [&](float sum) { return static_cast<int>(std::lround(sum / m.area)); };
      const auto want = ycocg_of(whole(m.color.x), whole(m.color.y), whole(m.color.z));
      REQUIRE_EACH(std::abs(want[0] - v.luma[i]) <= 4);
      REQUIRE_EACH(std::abs(want[1] - v.co[i]) <= 8);
      REQUIRE_EACH(std::abs(want[2] - v.cg[i]) <= 8);
    }
  }
  const Splats geometry = packed.discs(6);
  REQUIRE(geometry.colors.size() == geometry.size());
  for (int r = 0; r < 256; r += 5)
    for (int g = 0; g < 256; g += 5)
      for (int b = 0; b < 256; b += 5) {
        const auto y = ycocg_of(r, g, b);
        REQUIRE_EACH(rgb_of(y[0], y[1], y[2]) == std::array<int, 3>{r, g, b});
      }
}

TEST_CASE("encodes wires, dust and surfaces without area") {
  // In every voxel, the surface has less than a thirtieth of a face's area.
  Triangles dust;
  std::mt19937 random(3);
  const auto number = [&random] { return static_cast<float>(random() % 1000) / 1000; };
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 p(number(), number(), number());
    dust.push_back(triangle_of(p, p + glm::vec3(1e-3f, 0, 0), p + glm::vec3(0, 1e-3f, 0)));
  }
  const Packed packed(dust, 6);
  std::size_t voxels = 0;
  for (const Cluster& cluster : packed.clusters) voxels += cluster.level() == 6 ? cluster.voxels.size() : 0;
  CHECK(voxels >= 190);
  CHECK(encode_packed({}, 5, Cube{}, {}).empty());
  CHECK(encode_packed({Voxel{}}, 5, Cube{}, {}).empty());
}

TEST_CASE("fits clusters into a datagram, and names only earlier parents") {
  const Packed packed(sphere(80), 8);
  REQUIRE(packed.encoded.size() > 15);
  std::vector<std::vector<bool>> divided;
  for (std::size_t i = 0; i < packed.encoded.size(); ++i) {
    const EncodedCluster& e = packed.encoded[i];
    CHECK(e.payload.size() <= 1200);
    CHECK(packed.clusters[i].header.id == i);
    CHECK(e.voxels == packed.clusters[i].voxels.size());
    divided.emplace_back(e.voxels);
    if (i == 0) {
      CHECK(e.header.parent == kNoParent);
      CHECK(e.payload.size() <= 870);
      continue;
    }
    REQUIRE(e.header.parent < i);
    CHECK(packed.clusters[i].header.levels == 1);
    for (std::size_t k = 0; k < e.header.count; ++k) {
      const std::size_t at = e.header.first + k;
      REQUIRE_FALSE(divided[e.header.parent][at]);
      divided[e.header.parent][at] = true;
    }
    // Divided voxels are in Morton order.
    const PackedVoxels& v = packed.clusters[i].voxels;
    for (std::size_t k = 1; k < v.size(); ++k) REQUIRE_EACH(key_of(v, k - 1) < key_of(v, k));
  }
}

TEST_CASE("keeps a plane along the grid within the maximum voxels per byte") {
  const glm::vec3 a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0);
  Triangles plane{triangle_of(a, b, c), triangle_of(a, c, d)};
  const Packed packed(plane, 9);
  std::size_t voxels = 0;
  double most = 0;
  for (const EncodedCluster& e : packed.encoded) {
    voxels += e.header.level + e.header.levels == 9 ? e.voxels : 0;
    most = std::max(most, static_cast<double>(e.voxels) / static_cast<double>(e.payload.size()));
  }
  CHECK(voxels == packed.truth[9].size());
  CHECK(most < 48);
}

bool same(const PackedVoxels& a, const PackedVoxels& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.u == b.u && a.v == b.v && a.offset == b.offset &&
         a.state == b.state && a.luma == b.luma && a.co == b.co && a.cg == b.cg;
}

TEST_CASE("computes the inner loops with AVX2 to the bits of the scalar ones") {
  const PackedKernels* vector = packed_kernels_avx2();
  if (vector == nullptr) {
    WARN("this machine has no AVX2");
    return;
  }
  PackedOptions colored, fine;
  colored.colored = true;
  fine.normal_shift = 2;  // large differences, which are escaped
  fine.offset_shift = 0;
  std::mt19937 random(7);
  for (const Packed& packed :
       {Packed(sphere(60), 7), Packed(two_sided_sheet(), 6), Packed(random_triangles(60, 1, 3), 6, colored),
        Packed(random_triangles(60, 1, 4), 6, fine)}) {
    check_promises(packed);
    for (std::size_t i = 0; i < packed.encoded.size(); ++i) {
      const Cluster* parent = i == 0 ? nullptr : &packed.clusters[packed.encoded[i].header.parent];
      std::vector<std::byte> payload = packed.encoded[i].payload;
      for (int damage = 0; damage < 4; ++damage) {
        const auto a = decode_cluster(payload, parent, *vector);
        const auto b = decode_cluster(payload, parent, packed_kernels_scalar());
        REQUIRE(a.index() == b.index());
        if (damage == 0) REQUIRE(std::holds_alternative<Cluster>(a));
        if (a.index() == 0)
          REQUIRE(same(std::get<Cluster>(a).voxels, std::get<Cluster>(b).voxels));
        else
          REQUIRE(std::get<PackedError>(a).message == std::get<PackedError>(b).message);
        payload[14 + random() % (payload.size() - 14)] ^= static_cast<std::byte>(1u << random() % 8);
      }
    }
  }
}

TEST_CASE("rejects every prefix and every extension of a cluster") {
  PackedOptions options;
  options.colored = true;
  const Packed packed(sphere(30, 1, {}, true), 6, options);
  for (const std::size_t which : {std::size_t{0}, packed.encoded.size() / 2}) {
    const std::vector<std::byte>& payload = packed.encoded[which].payload;
    const Cluster* parent = which == 0 ? nullptr : &packed.clusters[packed.encoded[which].header.parent];
    for (std::size_t size = 0; size < payload.size(); ++size) {
      // A copy, so that reads beyond its end are detected.
      const std::vector<std::byte> prefix(payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(size));
      REQUIRE(std::holds_alternative<PackedError>(decode_cluster(prefix, parent)));
    }
    for (std::size_t more = 1; more < 40; ++more) {
      std::vector<std::byte> longer = payload;
      longer.resize(payload.size() + more);
      REQUIRE(std::holds_alternative<PackedError>(decode_cluster(longer, parent)));
    }
  }
}

TEST_CASE("survives every flipped bit of a cluster, and detects nearly all") {
  const Packed packed(sphere(30), 5);
  std::size_t unnoticed = 0, all = 0;
  for (const std::size_t which : {std::size_t{0}, packed.encoded.size() - 1}) {
    const Cluster* parent = which == 0 ? nullptr : &packed.clusters[packed.encoded[which].header.parent];
    std::vector<std::byte> payload = packed.encoded[which].payload;
    for (std::size_t bit = 8 * 14; bit < 8 * payload.size(); bit += watched_step(3), ++all) {
      payload[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
      const auto result = decode_cluster(payload, parent);
      if (const auto* cluster = std::get_if<Cluster>(&result)) {
        ++unnoticed;
        REQUIRE(cluster->voxels.size() <= 64 * payload.size());
        Splats geometry;
        append_discs(*cluster, 0, cluster->voxels.size(), packed.cube, geometry);
        for (std::size_t i = 0; i < geometry.size(); ++i) {
          REQUIRE_EACH(geometry.weights[i] > 0);
          REQUIRE_EACH(glm::length(geometry.normals[i]) == Approx(1).epsilon(1e-5));
        }
      }
      payload[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    }
  }
  INFO(unnoticed << " of " << all);
  CHECK(unnoticed * 20 < all);
}

std::vector<std::byte> header_bytes(const ClusterHeader& header, std::size_t size) {
  std::vector<std::byte> out;
  write_cluster_header(header, {}, out);
  out.resize(size);
  return out;
}

std::string refusal(std::span<const std::byte> payload, const Cluster* parent) {
  const auto result = decode_cluster(payload, parent);
  const auto* error = std::get_if<PackedError>(&result);
  return error ? error->message : "";
}

TEST_CASE("rejects impossible headers") {
  Cluster parent;
  parent.header.levels = 3;
  parent.voxels.resize(kMaxVoxels, false);
  const ClusterHeader good{1, 0, 0, 8, 3, 1};
  const auto with = [&](auto change) {
    ClusterHeader header = good;
    change(header);
    return refusal(header_bytes(header, 400), &parent);
  };
  CHECK(with([](ClusterHeader& h) { h.levels = 0; }) ==
        "a cluster divides level 3 0 times; expected at least once, and at most to level 16");
  CHECK(with([](ClusterHeader& h) { h.levels = 14; }) != "");
  CHECK(with([](ClusterHeader& h) { h.levels = 255; }) != "");
  CHECK(with([](ClusterHeader& h) { h.level = 255; }) != "");
  CHECK(with([](ClusterHeader& h) { h.level = 2; }) == "a cluster of another level than its parent");
  CHECK(with([](ClusterHeader& h) { h.count = 0; }) == "a cluster divides no voxel");
  CHECK(with([](ClusterHeader& h) { h.id = kNoParent; }) == "a cluster with the reserved number");
  CHECK(with([](ClusterHeader& h) { h.parent = kNoParent; }) == "a cluster without a parent does not divide the root");
  CHECK(with([](ClusterHeader& h) { h.first = 65535; }) == "a cluster divides voxels 65535 to 65542 of 65535");
  CHECK(with([](ClusterHeader& h) { h.count = 65535; }) ==
        "a cluster of 400 bytes divides 65535 voxels; expected 25600 at most");
  CHECK(refusal(header_bytes(good, 400), nullptr) == "a cluster without its parent");
  CHECK(refusal(header_bytes(good, 21), &parent) == "a cluster of 21 bytes; expected 22 at least");
  // Colours require the parent's colours.
  std::vector<std::byte> colored = header_bytes(good, 400);
  colored[14] |= std::byte{16};
  CHECK(refusal(colored, &parent) == "a coloured cluster under one without colours");
  for (const auto& [at, bit] : {std::pair{14, 0x80}, {15, 0x80}, {20, 8}, {21, 1}}) {
    std::vector<std::byte> later = header_bytes(good, 400);
    later[static_cast<std::size_t>(at)] |= static_cast<std::byte>(bit);
    CHECK(refusal(later, &parent) == "a cluster of a later version: reserved bits are set");
  }
}

TEST_CASE("rejects random bytes, or decodes them to voxels within the limits") {
  std::mt19937 random(99);
  Cluster parent;
  parent.header.levels = 3;
  parent.voxels.resize(5000, true);
  for (std::size_t i = 0; i < parent.voxels.size(); ++i) {
    parent.voxels.u[i] = static_cast<std::int16_t>(static_cast<int>(random() % 2049) - 1024);
    parent.voxels.v[i] = static_cast<std::int16_t>(static_cast<int>(random() % 2049) - 1024);
    parent.voxels.offset[i] = static_cast<std::int8_t>(static_cast<int>(random() % 65) - 32);
    parent.voxels.state[i] = static_cast<std::uint8_t>(random() % 8);
  }
  for (int i = 0; i < 3000; ++i) {
    const bool root = i % 3 == 0;
    ClusterHeader header{1, 0, 0, static_cast<std::uint16_t>(1 + random() % 5000), 3, 1};
    if (root) header = {1, kNoParent, 0, 1, 0, static_cast<std::uint8_t>(1 + random() % 16)};
    std::vector<std::byte> payload = header_bytes(header, 22 + random() % 1500);
    for (std::size_t k = 14; k < payload.size(); ++k)
      payload[k] = i % 7 == 0 ? std::byte{255} : static_cast<std::byte>(random());
    payload[14] &= std::byte{0x7f};
    payload[15] &= std::byte{0x7f};
    if (payload.size() > 21) {
      payload[20] &= std::byte{7};
      payload[21] = std::byte{0};
    }
    const auto result = decode_cluster(payload, root ? nullptr : &parent);
    if (const auto* cluster = std::get_if<Cluster>(&result)) REQUIRE(cluster->voxels.size() <= 64 * payload.size());
  }
}

TEST_CASE("uses the tables of FORMAT.md") {
  for (const ResidualModel& model : residual_models()) {
    std::uint32_t next = 0;
    for (const auto& interval : model.interval) {
      CHECK(interval.start == next);
      CHECK(interval.frequency >= 1);
      next += interval.frequency;
    }
    CHECK(next == 4096);
  }
  // Computed by hand from the rule: weights 2^24, then times 4/256 at each of 30 odd symbols.
  const auto& narrow = residual_models()[0].interval;
  CHECK(narrow[0].frequency == 3943);
  CHECK(narrow[1].frequency == 62);
  CHECK(narrow[2].frequency == 62);
  CHECK(narrow[3].frequency == 1);
  for (const auto& model : occupancy_models())
    for (std::size_t i = 0; i < kOccupancyBins; ++i) {
      CHECK((model[i] > 0 && model[i] < 4096));
      if (i > 0) CHECK(model[i - 1] <= model[i]);
    }
  for (int i = -2000; i <= 2000; ++i) REQUIRE(unzigzag(zigzag(i)) == i);
}

TEST_CASE("encodes octahedral normals with their opposites, wraps and plane areas") {
  for (int u = -1024; u <= 1024; u += 32)
    for (int v = -1024; v <= 1024; v += 32) {
      const auto n = octahedral_normal(u, v);
      REQUIRE(std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]) == 1024);
      int fu = u, fv = v;
      flip_octahedral(fu, fv);
      const auto m = octahedral_normal(fu, fv);
      REQUIRE((m[0] == -n[0] && m[1] == -n[1] && m[2] == -n[2]));
    }
  // Across the right edge and mirrored back: the same normal from the other side of the seam.
  int u = 1030, v = 100;
  wrap_octahedral(u, v);
  CHECK((u == 1018 && v == -100));
  CHECK(plane_section(glm::vec3(0, 0, 1), 0.5f) == Approx(1));
  CHECK(plane_section(glm::vec3(0.5f, 0.5f, 0), 0) == Approx(std::sqrt(2.0)));
  CHECK(plane_section(glm::vec3(1, 1, 1) / 3.0f, 0) == Approx(std::sqrt(3.0) / 2));  // the true hexagon has 1.299
  CHECK(plane_section(glm::vec3(0.5f, 0.5f, 0), 0.5f) == Approx(0.1 * std::sqrt(2.0)));
}

}  // namespace
}  // namespace gs::qnv
