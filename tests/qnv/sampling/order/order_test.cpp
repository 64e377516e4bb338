#include "qnv/sampling/order/order.h"

#include "qnv/sampling/order/order_spread.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace gs::qnv {
namespace {

struct Vectors {
  std::vector<glm::vec3> positions, normals;
  std::vector<float> weights;
  [[nodiscard]] double area() const {
    double sum = 0;
    for (const float weight : weights) sum += weight;
    return sum;
  }
  void add(const glm::vec3& position, const glm::vec3& normal, float weight) {
    positions.push_back(position);
    normals.push_back(normal);
    weights.push_back(weight);
  }
};

std::vector<std::uint32_t> order_of(const Vectors& v, std::uint64_t seed = 1, unsigned threads = 1,
                                    Kind kind = Kind::surface) {
  return progressive_order(v.positions, v.normals, v.weights, {seed, kind, threads, nullptr});
}

bool is_permutation(std::vector<std::uint32_t> order, std::size_t count) {
  std::sort(order.begin(), order.end());
  if (order.size() != count) return false;
  for (std::size_t i = 0; i < count; ++i)
    if (order[i] != i) return false;
  return true;
}

float random_float(std::mt19937& random) { return static_cast<float>(random() >> 8) / 16777216.0f; }

Vectors sphere_vectors(std::size_t count) {
  Vectors v;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - 2 * (static_cast<double>(i) + 0.5) / static_cast<double>(count), r = std::sqrt(1 - z * z);
    const double a = static_cast<double>(i) * std::numbers::pi * (3 - std::sqrt(5));
    const glm::vec3 p(r * std::cos(a), r * std::sin(a), z);
    v.add(p, p, static_cast<float>(4 * std::numbers::pi / static_cast<double>(count)));
  }
  return v;
}

glm::vec3 cross(const glm::vec3& a, const glm::vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Returns a vector per triangle of an ASCII PLY file.
Vectors triangles_of(const char* path) {
  Vectors result;
  std::ifstream in(path);
  std::string line, word, kind;
  std::size_t vertices = 0, faces = 0;
  while (std::getline(in, line) && line != "end_header") {
    std::istringstream words(line);
    words >> word >> kind;
    if (word == "element") words >> (kind == "vertex" ? vertices : faces);
  }
  std::vector<glm::vec3> corners(vertices);
  for (glm::vec3& p : corners) {
    std::getline(in, line);
    std::istringstream(line) >> p.x >> p.y >> p.z;
  }
  for (std::size_t i = 0; i < faces; ++i) {
    std::size_t count = 0, a = 0, b = 0, c = 0;
    in >> count >> a >> b >> c;
    const glm::vec3 n = cross(corners[b] - corners[a], corners[c] - corners[a]);
    const float length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    if (length > 0) result.add((corners[a] + corners[b] + corners[c]) / 3.0f, n / length, length / 2);
  }
  return result;
}

// Returns the largest distance of a surface point from the nearest of the first `count` vectors.
double largest_hole(const Vectors& v, const std::vector<std::uint32_t>& order, std::size_t count) {
  double worst = 0;
  const std::size_t step = std::max<std::size_t>(1, v.positions.size() / 5000);
  for (std::size_t i = 0; i < v.positions.size(); i += step) {
    float nearest = std::numeric_limits<float>::infinity();
    const glm::vec3 p = v.positions[i];
    for (std::size_t k = 0; k < count; ++k) {
      const glm::vec3& q = v.positions[order[k]];
      nearest = std::min(nearest, (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z));
    }
    worst = std::max<double>(worst, nearest);
  }
  return std::sqrt(worst);
}

// Returns the hole of `count` vectors in a triangular grid, the smallest possible. Area per vector: 3 sqrt(3) / 2 *
// hole^2.
double ideal_hole(double area, std::size_t count) {
  return std::sqrt(2 * area / static_cast<double>(count) / (3 * std::sqrt(3.0)));
}

std::vector<std::uint32_t> shuffled(std::size_t count) {
  std::vector<std::uint32_t> order(count);
  std::mt19937 random(99);
  for (std::uint32_t i = 0; i < count; ++i) {
    order[i] = i;
    std::swap(order[i], order[random() % (i + 1)]);
  }
  return order;
}

void check_holes(const Vectors& v, double limit) {
  const std::vector<std::uint32_t> order = order_of(v), random = shuffled(v.positions.size());
  REQUIRE(is_permutation(order, v.positions.size()));
  for (const std::size_t count : {50, 200, 1000, 5000}) {
    const double ideal = ideal_hole(v.area(), count);
    const double got = largest_hole(v, order, count) / ideal, by_chance = largest_hole(v, random, count) / ideal;
    INFO(count << " vectors: " << got << " times the ideal hole; shuffled " << by_chance);
    CHECK(got < limit);
    CHECK(got < 0.8 * by_chance);
    if (count >= 200) CHECK(got < 0.7 * by_chance);
  }
}

}  // namespace

TEST_CASE("covers a sphere evenly with every prefix") { check_holes(sphere_vectors(40'000), 1.7); }

TEST_CASE("covers the bunny evenly with every prefix", "[optimised]") {
  const char* path = GHOSTSPACE_TESTS "/../../shared/data/meshes/scans/bun_zipper.ply";
  if (!std::ifstream(path)) {
    WARN("no bunny at " << path);
    return;
  }
  check_holes(triangles_of(path), 2);
}

TEST_CASE("keeps holes small between the tested prefixes", "[optimised]") {
  const Vectors v = sphere_vectors(8000);
  const std::vector<std::uint32_t> order = order_of(v);
  for (std::size_t count = 8; count < 3000; count += 1 + count / 4) {
    INFO(count);
    CHECK(largest_hole(v, order, count) / ideal_hole(v.area(), count) < 1.8);
  }
}

TEST_CASE("makes an order that depends on the seed only", "[optimised]") {
  const Vectors v = sphere_vectors(60'000);
  const std::vector<std::uint32_t> order = order_of(v, 7, 1);
  CHECK(order == order_of(v, 7, 1));
  CHECK(order == order_of(v, 7, 2));
  CHECK(order == order_of(v, 7, 5));
  const std::vector<std::uint32_t> other = order_of(v, 8, 1);
  CHECK(is_permutation(other, v.positions.size()));
  std::size_t same = 0;
  for (std::size_t i = 0; i < order.size(); ++i) same += order[i] == other[i];
  CHECK(same < order.size() / 100);
  const auto volume = order_of(v, 7, 1, Kind::volume);
  CHECK(is_permutation(volume, v.positions.size()));
  CHECK(volume == order_of(v, 7, 3, Kind::volume));
  CHECK(volume != order_of(v, 9, 3, Kind::volume));
}

TEST_CASE("orders a few vectors by farthest-point sampling") {
  // Points on a line, from the point that the seed selects.
  Vectors v;
  for (const float x : {0.0f, 1.0f, 2.0f, 4.0f, 8.0f, 16.0f}) v.add({x, 0, 0}, {0, 0, 1}, 1);
  const std::vector<std::uint32_t> order = order_of(v);
  REQUIRE(is_permutation(order, 6));
  std::vector<float> taken{v.positions[order[0]].x};
  for (std::size_t i = 1; i < 6; ++i) {
    const auto gap = [&](float x) {
      float least = 100;
      for (const float t : taken) least = std::min(least, std::abs(x - t));
      return least;
    };
    float most = 0;
    for (const glm::vec3& p : v.positions) most = std::max(most, gap(p.x));
    CHECK(gap(v.positions[order[i]].x) == most);
    taken.push_back(v.positions[order[i]].x);
  }
}

TEST_CASE("makes the pinned order with any compiler") {
  // 40,000 points of a bent sheet. Their numbers are exact, so that library rounding has no effect.
  Vectors v;
  for (int x = 0; x < 200; ++x)
    for (int y = 0; y < 200; ++y) {
      const float height = static_cast<float>((x * x + 3 * y * y) % 64) / 16;
      v.add({static_cast<float>(x), static_cast<float>(y), height},
            x % 2 ? glm::vec3(0, 0, 1) : glm::vec3(0.6f, 0, 0.8f), 1);
    }
  for (const Kind kind : {Kind::surface, Kind::volume}) {
    const std::vector<std::uint32_t> order = order_of(v, 1, 2, kind);
    REQUIRE(is_permutation(order, 40'000));
    std::uint64_t sum = 0;
    for (const std::uint32_t i : order) sum = order::hash(sum ^ i);
    CHECK(sum == (kind == Kind::surface ? 14714462022175476565u : 3747455355406420068u));
  }
}

TEST_CASE("orders empty, single, coincident and NaN vectors") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  std::mt19937 random(3);
  for (const Kind kind : {Kind::surface, Kind::volume}) {
    Vectors v;
    CHECK(order_of(v, 1, 1, kind).empty());
    v.add({1, 2, 3}, {0, 0, 1}, 1);
    CHECK(is_permutation(order_of(v, 1, 1, kind), 1));
    for (int i = 0; i < 20'000; ++i) v.add({1, 2, 3}, {0, 0, i % 2 ? 1.0f : -1.0f}, 1);
    CHECK(is_permutation(order_of(v, 1, 2, kind), v.positions.size()));  // all coincident
    for (int i = 0; i < 5000; ++i) v.add({1 + 1e-7f * random_float(random), 2, 3}, {0, 0, 1}, 0);
    v.add({1e30f, -1e30f, 5}, {0, 0, 1}, 1e30f);  // all but one coincident
    CHECK(is_permutation(order_of(v, 1, 2, kind), v.positions.size()));
    v.add({nan, infinity, -infinity}, {nan, nan, nan}, nan);
    v.add({3e38f, -3e38f, 3e38f}, {1e30f, -1e30f, 0}, -infinity);
    CHECK(is_permutation(order_of(v, 1, 2, kind), v.positions.size()));
    const std::vector<glm::vec3> none;
    CHECK(is_permutation(progressive_order(v.positions, none, v.weights, {1, kind, 1, nullptr}), v.positions.size()));
  }
}

TEST_CASE("orders clusters of all scales in reasonable time") {
  Vectors v;
  std::mt19937 random(4);
  float size = 1;
  for (int cluster = 0; cluster < 20; ++cluster, size *= 0.3f)
    for (int i = 0; i < 2000; ++i) {
      const glm::vec3 p(random_float(random), random_float(random), random_float(random));
      v.add(p * size, {0, 0, i % 3 ? 1.0f : -1.0f}, 1);
    }
  CHECK(is_permutation(order_of(v), v.positions.size()));
  CHECK(is_permutation(order_of(v, 1, 1, Kind::volume), v.positions.size()));
}

TEST_CASE("covers both sides of a thin sheet") {
  Vectors v;
  for (int side = -1; side <= 1; side += 2)
    for (int x = 0; x < 100; ++x)
      for (int y = 0; y < 100; ++y)
        v.add({static_cast<float>(x), static_cast<float>(y), 0.01f * static_cast<float>(side)},
              {0, 0, static_cast<float>(side)}, 1);
  const std::vector<std::uint32_t> order = order_of(v);
  for (const std::size_t count : {50, 200, 1000}) {
    std::size_t lower = 0;
    for (std::size_t i = 0; i < count; ++i) lower += order[i] < 10'000;
    CHECK(lower > count * 4 / 10);
    CHECK(lower < count * 6 / 10);
  }
}

TEST_CASE("takes more vectors at curved parts of a surface") {
  // A flat square beside a square with steep waves. Both have the same size from above.
  Vectors v;
  for (int x = 0; x < 200; ++x)
    for (int y = 0; y < 100; ++y) {
      const float slope = x < 100 ? 0.0f : std::sin(static_cast<float>(x));
      const glm::vec3 n = glm::vec3(slope, 0, 1) / std::sqrt(1 + slope * slope);
      v.add({static_cast<float>(x), static_cast<float>(y), 0}, n, 1);
    }
  const std::vector<std::uint32_t> order = order_of(v);
  for (const std::size_t count : {300, 1500}) {
    std::size_t bent = 0;
    for (std::size_t i = 0; i < count; ++i) bent += v.positions[order[i]].x >= 100;
    INFO(bent << " of " << count);
    CHECK(bent > count * 6 / 10);
    CHECK(bent < count * 8 / 10);
  }
}

TEST_CASE("takes vectors of a volume in proportion to their magnitude") {
  Vectors v;
  for (int x = 0; x < 40; ++x)
    for (int y = 0; y < 40; ++y)
      for (int z = 0; z < 40; ++z)
        v.add({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}, {0, 0, 1}, x < 20 ? 80.0f : 10.0f);
  const std::vector<std::uint32_t> order = order_of(v, 1, 1, Kind::volume);
  for (const std::size_t count : {500, 2000, 8000}) {
    std::size_t strong = 0;
    for (std::size_t i = 0; i < count; ++i) strong += v.positions[order[i]].x < 20;
    INFO(strong << " of " << count);
    CHECK(strong > count * 3 / 4);     // a factor of eight in density would be 8/9
    CHECK(strong < count * 97 / 100);  // and the flat square is not omitted
  }
}

TEST_CASE("returns an empty order after cancellation") {
  Progress progress;
  progress.cancelled = true;
  const Vectors v = sphere_vectors(100'000);
  CHECK(progressive_order(v.positions, v.normals, v.weights, {1, Kind::surface, 1, &progress}).empty());
}

TEST_CASE("computes the distance loop to the same bits on both paths") {
  if (!order::has_relax_avx2()) return;
  std::mt19937 random(5);
  order::Points points;
  points.resize(200);
  std::vector<float> gaps(200);
  for (std::size_t i = 0; i < 200; ++i) {
    points.x[i] = random_float(random), points.y[i] = random_float(random), points.z[i] = random_float(random);
    points.nx[i] = random_float(random) - 0.5f, points.ny[i] = random_float(random) - 0.5f,
    points.nz[i] = random_float(random) - 0.5f;
    points.density[i] = 1 + random_float(random);
    gaps[i] = i % 7 == 0 ? -1 : random_float(random);
  }
  for (int round = 0; round < 300; ++round) {
    const std::size_t first = random() % 200, last = first + random() % (201 - first), i = random() % 200;
    const order::Centre centre{points.x[i], points.y[i], points.z[i], points.nx[i], points.ny[i], points.nz[i]};
    std::vector<float> expected = gaps, got = gaps;
    order::relax_portable(points, first, last, centre, round % 2 == 0, expected.data());
    order::relax_avx2(points, first, last, centre, round % 2 == 0, got.data());
    REQUIRE(expected == got);
  }
}

}  // namespace gs::qnv
