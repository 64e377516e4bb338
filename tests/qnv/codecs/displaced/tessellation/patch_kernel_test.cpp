#include "qnv/codecs/displaced/tessellation/patch_kernel.h"

#include "qnv/codecs/displaced/subdivision.h"
#include "qnv/codecs/displaced/tessellation/patch_surface.h"
#include "tests/qnv/codecs/displaced/tessellation/patch_shapes.h"

#include <glm/geometric.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace gs::qnv::patch_kernel_test {
namespace {

using displaced::row_start;

bool same(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }
bool same(const glm::vec3& a, const glm::vec3& b) { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }

glm::vec3 unit(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 0 ? v / length : glm::vec3(0);
}

Columns columns_of(const std::vector<glm::vec3>& all) {
  Columns out;
  out.resize(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) out.put(i, all[i]);
  return out;
}

/// Returns vectors, some coincident or of length 0.
std::vector<glm::vec3> any_vectors(std::size_t count, std::uint32_t seed, bool units = false) {
  std::mt19937 random(seed);
  std::vector<glm::vec3> out(count);
  for (glm::vec3& v : out) {
    for (int axis = 0; axis < 3; ++axis) v[axis] = static_cast<float>(random() % 2001) / 1000 - 1;
    if (random() % 9 == 0) v = glm::vec3(0);
    if (units) v = unit(v);
  }
  return out;
}

}  // namespace

TEST_CASE("evaluates a patch in the loops of every instruction set as vertex by vertex") {
  for (const PatchLoops& loops : patch_loops()) {
    CAPTURE(loops.name);
    for (int level = 0; level <= 5; ++level) {
      CAPTURE(level);
      const std::size_t n = std::size_t{1} << level, count = patch_vertices(level);
      const std::vector<glm::vec3> at = any_vectors(count, 3);
      Columns places = columns_of(at), products, units, normals;
      loops.products(places, n, products);
      std::vector<glm::vec3> sums(count, glm::vec3(0)), turns(n * n);
      const auto product = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t to) {
        turns[to] = glm::cross(at[b] - at[a], at[c] - at[a]);
        for (const std::size_t v : {a, b, c}) sums[v] += turns[to];
      };
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t i = 0; i + j < n; ++i) {
          const std::size_t row = row_start(j, n) + i, above = row_start(j + 1, n) + i;
          product(row, row + 1, above, upright_row(j, n) + i);
          if (i + j + 1 < n) product(row + 1, above + 1, above, turned_row(j, n) + i);
        }
      bool right = true;
      for (std::size_t t = 0; t < n * n; ++t) right = right && same(products.at(t), turns[t]);
      CHECK(right);
      if (n > 2) loops.inner_normals(products, n, normals);
      std::size_t to = 0;
      for (std::size_t j = 1; j + 1 < n; ++j)
        for (std::size_t i = 1; i + j < n; ++i)
          right = right && same(normals.at(to++), unit(sums[row_start(j, n) + i]));
      CHECK(right);
      loops.directions(products, n * n, units);
      const glm::vec3 axis = unit({1, 2, -3});
      float least = 1;
      for (std::size_t t = 0; t < n * n; ++t) {
        right = right && same(units.at(t), unit(turns[t]));
        if (glm::length(turns[t]) > 0) least = std::min(least, glm::dot(unit(turns[t]), axis));
      }
      CHECK(right);
      CHECK(loops.least_cosine(units, n * n, axis) == least);
      float most = 0;
      for (const glm::vec3& p : at) most = std::max(most, glm::length(p - axis));
      CHECK(same(loops.farthest(places, count, axis), most));
    }
  }
}

TEST_CASE("predicts vertices between others in the loops of every instruction set") {
  const std::size_t count = 21;
  const std::vector<glm::vec3> places = any_vectors(2 * count, 5), shifts = any_vectors(2 * count, 6),
                               normals = any_vectors(2 * count, 7, true);
  const Columns of_places = columns_of(places), of_shifts = columns_of(shifts), of_normals = columns_of(normals);
  std::vector<float> first(count + Columns::kRoom, 0.25f), third(count + Columns::kRoom, -0.01f);
  for (const PatchLoops& loops : patch_loops()) {
    CAPTURE(loops.name);
    PatchMiddles of{count, &of_places, &of_shifts, &of_normals, 1, count, {}};
    of.moved[0] = first.data();
    of.moved[2] = third.data();
    Columns made, made_shifts;
    made.resize(count);
    made_shifts.resize(count);
    loops.middles(of, made, made_shifts);
    bool right = true;
    for (std::uint32_t i = 0; i < count; ++i) {
      displaced::NewVertex fresh;
      fresh.a = fresh.slot_a = fresh.other_a = 1 + i;
      fresh.b = fresh.slot_b = fresh.other_b = static_cast<std::uint32_t>(count) + i;
      const displaced::Prediction p = displaced::predict(fresh, false, places, normals);
      glm::vec3 shift = 0.5f * (shifts[fresh.a] + shifts[fresh.b]);
      for (const glm::vec3& by : {glm::vec3(0), p.normal * third[i], glm::vec3(0)}) shift += by;
      right = right && same(made.at(i), p.position + p.normal * first[i]) && same(made_shifts.at(i), shift);
    }
    CHECK(right);
  }
}

TEST_CASE("packs directions like pack_direction, and replaces invalid positions by the corner") {
  std::vector<glm::vec3> normals = any_vectors(300, 8, true), places = any_vectors(300, 9);
  const float nan = std::numeric_limits<float>::quiet_NaN(), huge = std::numeric_limits<float>::max();
  normals[3] = {nan, 0.5f, -nan};
  normals[4] = {huge, -huge, std::numeric_limits<float>::infinity()};
  normals[5] = {0.5f / 1023, -0.5f / 1023, 0.5f / 511};
  places[7].y = nan;
  places[8].z = huge;  // far outside of the picture
  const glm::vec3 lower(1, -2, 3);
  for (const PatchLoops& loops : patch_loops()) {
    CAPTURE(loops.name);
    Columns at = columns_of(places);
    std::vector<std::uint32_t> packed(places.size() + Columns::kRoom);
    loops.pack_directions(columns_of(normals), normals.size(), packed.data());
    loops.leave_frame(at, places.size(), lower, 7.5f);
    bool right = true;
    for (std::size_t i = 0; i < places.size(); ++i)
      right = right && packed[i] == pack_direction(normals[i]) &&
              same(at.at(i), i == 7 || i == 8 ? lower : lower + places[i] * 7.5f);
    CHECK(right);
  }
  // These values are between two codes; both are valid.
  const auto low = [](float v) { return static_cast<std::int32_t>(pack_direction({v, 0, 0}) << 21) >> 21; };
  for (int i = -5000; i <= 5000; ++i) {
    const float v = static_cast<float>(i) / 4711;
    REQUIRE(low(v) == std::lround(std::clamp(v, -1.0f, 1.0f) * 1023));
  }
}

TEST_CASE("places the triangles of a table in the order of the loops") {
  for (int level = 0; level <= 4; ++level) {
    const PatchTable& table = patch_table(level);
    const std::size_t n = std::size_t{1} << level;
    REQUIRE(table.turns.size() == n * n);
    std::vector<glm::vec3> at(table.grid.size());
    for (const PatchTable::Number v : table.grid) at[v] = any_vectors(1, v)[0];
    Columns grid, products;
    grid.resize(at.size());
    for (std::size_t i = 0; i < at.size(); ++i) grid.put(i, at[table.grid[i]]);
    patch_loops().front().products(grid, n, products);
    std::vector<std::array<PatchTable::Number, 3>> triangles = table.inner;
    triangles.insert(triangles.end(), table.border.begin(), table.border.end());
    bool right = true;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto& [a, b, c] = triangles[t];
      right = right && same(products.at(table.turns[t]), glm::cross(at[b] - at[a], at[c] - at[a]));
    }
    CHECK(right);
  }
}

}  // namespace gs::qnv::patch_kernel_test
