#include "qnv/codecs/octree/packed_neighbours.h"

#include "qnv/base/morton.h"
#include "tests/qnv/surface_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

namespace gs::qnv {
namespace {

constexpr std::uint32_t bits_of(int u, int v, int offset) {
  return static_cast<std::uint32_t>(u + 1024) | static_cast<std::uint32_t>(v + 1024) << 12 |
         static_cast<std::uint32_t>(offset + 32) << 24 | kThere;
}

PackedVoxels voxels_at(std::vector<std::uint64_t> keys) {
  std::sort(keys.begin(), keys.end());
  PackedVoxels voxels;
  voxels.resize(keys.size(), false);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto cell = morton_decode(keys[i]);
    voxels.x[i] = static_cast<std::uint16_t>(cell[0]);
    voxels.y[i] = static_cast<std::uint16_t>(cell[1]);
    voxels.z[i] = static_cast<std::uint16_t>(cell[2]);
    voxels.u[i] = static_cast<std::int16_t>(i % 2049) - 1024;
    voxels.offset[i] = static_cast<std::int8_t>(i % 65) - 32;
  }
  return voxels;
}

TEST_CASE("finds the neighbours in a block across each face") {
  std::mt19937 random(5);
  std::vector<std::uint64_t> keys;
  for (int i = 0; i < 3000; ++i) keys.push_back(morton_encode(random() % 70, random() % 9, random() % 9));
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  PackedVoxels voxels = voxels_at(keys);
  for (std::size_t i = 0; i < voxels.size(); i += 7) voxels.state[i] = kDouble;
  // A run of voxels, as a cluster divides it; all may be neighbours.
  const std::size_t first = voxels.size() / 3, count = voxels.size() / 2;
  std::size_t done = 0, blocks = 0, found = 0;
  for (; done < count; ++blocks) {
    const std::size_t n = plane_blocks().fill(voxels, first + done, count - done);
    REQUIRE(n > 0);
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = first + done + k;
      const auto around = plane_blocks().block().around(k);
      const auto plane_at = [&](int dx, int dy, int dz) -> std::uint32_t {
        const int x = voxels.x[i] + dx, y = voxels.y[i] + dy, z = voxels.z[i] + dz;
        if (x < 0 || y < 0 || z < 0 || x >> 5 != voxels.x[i] >> 5) return 0;
        const std::uint64_t key =
            morton_encode(static_cast<unsigned>(x), static_cast<unsigned>(y), static_cast<unsigned>(z));
        const auto at = std::lower_bound(keys.begin(), keys.end(), key);
        if (at == keys.end() || *at != key) return 0;
        const auto q = static_cast<std::size_t>(at - keys.begin());
        return q % 7 == 0 ? 0 : bits_of(voxels.u[q], voxels.v[q], voxels.offset[q]);
      };
      const std::array<std::uint32_t, 7> want{plane_at(-1, 0, 0), plane_at(1, 0, 0),  plane_at(0, -1, 0),
                                              plane_at(0, 1, 0),  plane_at(0, 0, -1), plane_at(0, 0, 1),
                                              plane_at(0, 0, 0)};
      REQUIRE_EACH(around == want);
      for (const std::uint32_t plane : around) found += plane != 0;
    }
    done += n;
  }
  CHECK(done == count);
  CHECK(blocks >= 2);
  CHECK(found > count);
}

TEST_CASE("predicts a plane exactly that continues into its neighbours") {
  // A plane with normal +z passes through the centres of the voxel and of its neighbours.
  const std::array<std::uint32_t, 7> flat{bits_of(0, 0, 4), bits_of(0, 0, 4), bits_of(0, 0, 4), bits_of(0, 0, 4), 0, 0,
                                          bits_of(0, 0, 4)};
  const FaceChanges changes = face_changes(0, 0, 4, flat);
  for (unsigned c = 0; c < 8; ++c) {
    const PredictedPlane plane = predicted_plane(0, 0, 4, changes, c, true, true);
    CHECK(plane.u == 0);
    CHECK(plane.v == 0);
    // The plane is 4/64 of the voxel's edge above the centre, so 8/64 of the child's edge. The centre of the child is
    // half of its edge away.
    CHECK(plane.offset == (c < 4 ? 32 : 8 - 32));
  }
}

TEST_CASE("predicts turning normals as by hand") {
  // u rises by 160 along x. A child is a quarter of a voxel away: 40, as 3/16 of the slope on its side and 1/16 of the
  // other, each 160.
  const std::array<std::uint32_t, 7> bent{bits_of(-60, 0, 0), bits_of(260, 0, 0), 0, 0, 0, 0, bits_of(100, 0, 0)};
  const FaceChanges changes = face_changes(100, 0, 0, bent);
  CHECK(predicted_plane(100, 0, 0, changes, 0, true, false).u == 60);
  CHECK(predicted_plane(100, 0, 0, changes, 1, true, false).u == 140);
  // If neither normals nor offsets of neighbours are used, the prediction is the parent's plane.
  CHECK(predicted_plane(100, 0, 0, changes, 1, false, false).u == 100);
  CHECK(predicted_plane(100, 0, 0, changes, 1, true, false).offset ==
        predicted_offset(along(octahedral_normal(100, 0), 1), 0));
  // Offset of +x: 2 (0 - 0) + (260 >> 3) = 32, of -x: (60 >> 3) = 7, a quarter of each.
  CHECK(changes.offset == std::array<int, 6>{7, 32, 0, 0, 0, 0});
  // Around the edge of the square, (1010, -20) equals (1038, 20): 38 away, not 10 and 40.
  const std::array<std::uint32_t, 7> edge{0, bits_of(1010, -20, 0), 0, 0, 0, 0, bits_of(1000, 20, 0)};
  CHECK(face_changes(1000, 20, 0, edge).u[1] == 3 * 38);
  CHECK(face_changes(1000, 20, 0, edge).v[1] == 0);
  const std::array<std::uint32_t, 7> seam{0, bits_of(1014, -120, 0), 0, 0, 0, 0, bits_of(1014, 120, 0)};
  CHECK(face_changes(1014, 120, 0, seam).u[1] == 3 * 20);
  CHECK(face_changes(1014, 120, 0, seam).v[1] == 0);
  // A turn of over 700 means another surface. A two-sided sheet has no neighbours.
  const std::array<std::uint32_t, 7> other{0, bits_of(700, 1, 9), 0, 0, 0, 0, bits_of(0, 0, 0)};
  CHECK(face_changes(0, 0, 0, other).u == std::array<int, 6>{});
  CHECK(face_changes(0, 0, 0, other).offset == std::array<int, 6>{});
  std::array<std::uint32_t, 7> sheet = bent;
  sheet[6] = 0;
  CHECK(face_changes(100, 0, 0, sheet).u == std::array<int, 6>{});
}

TEST_CASE("clamps predicted planes for any neighbours") {
  std::mt19937 random(11);
  const auto number = [&random](int most) {
    return static_cast<int>(random() % static_cast<unsigned>(2 * most + 1)) - most;
  };
  for (int i = 0; i < 20000; ++i) {
    std::array<std::uint32_t, 7> around{};
    for (std::uint32_t& plane : around) plane = random() % 4 == 0 ? 0 : bits_of(number(1024), number(1024), number(32));
    const int u = number(1024), v = number(1024), offset = number(32);
    const FaceChanges changes = face_changes(u, v, offset, around);
    const PredictedPlane plane = predicted_plane(u, v, offset, changes, random() % 8, true, true);
    REQUIRE_EACH(std::abs(plane.u) <= 1024);
    REQUIRE_EACH(std::abs(plane.v) <= 1024);
    REQUIRE_EACH(std::abs(plane.offset) <= 32);
  }
}

}  // namespace
}  // namespace gs::qnv
