#include "qnv/codecs/records/record.h"

#include "qnv/codecs/records/record_paths.h"
#include "tests/qnv/codecs/records/record_fields.h"
#include "tests/qnv/pinned_vectors.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace gs::qnv {
namespace {

namespace paths = record_paths;

std::uint64_t load(const std::byte* p) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, p, sizeof bits);
  return bits;
}

float random_float(std::mt19937& random, float low, float high) {
  return low + (high - low) * (static_cast<float>(random() >> 8) / 16777216.0f);
}

glm::vec3 random_direction(std::mt19937& random) {
  for (;;) {
    const glm::vec3 v{random_float(random, -1, 1), random_float(random, -1, 1), random_float(random, -1, 1)};
    const float square = v.x * v.x + v.y * v.y + v.z * v.z;
    if (square > 0.01f && square < 1) return v / std::sqrt(square);
  }
}

double angle(const glm::vec3& a, const glm::vec3& b) {
  const double ax = a.x, ay = a.y, az = a.z, bx = b.x, by = b.y, bz = b.z;
  const double cx = ay * bz - az * by, cy = az * bx - ax * bz, cz = ax * by - ay * bx;
  return std::atan2(std::sqrt(cx * cx + cy * cy + cz * cz), ax * bx + ay * by + az * bz);
}

// Packs one vector.
std::uint64_t pack_record(const RecordVector& v, const RecordFrame& frame) {
  std::array<std::byte, 8> bytes{};
  pack_records(std::span(&v.position, 1), std::span(&v.normal, 1), std::span(&v.weight, 1), std::span(&v.color, 1),
               frame, bytes.data());
  std::uint64_t bits = 0;
  for (std::size_t i = 8; i-- > 0;) bits = bits << 8 | std::to_integer<std::uint64_t>(bytes[i]);
  return bits;
}

RecordFrame some_frame() { return frame_for({{-1.5f, 0.1f, 1000.25f}, {0.5f, 3.4f, 1001.75f}}, 327.67f); }

}  // namespace

TEST_CASE("packs the bits of a record as the format defines") {
  CHECK(join_fields({1, 0, 0, 0, 0, 0, 0}) == std::uint64_t{1});
  CHECK(join_fields({0, 1, 0, 0, 0, 0, 0}) == std::uint64_t{1} << 10);
  CHECK(join_fields({0, 0, 1, 0, 0, 0, 0}) == std::uint64_t{1} << 20);
  CHECK(join_fields({0, 0, 0, 1, 0, 0, 0}) == std::uint64_t{1} << 30);
  CHECK(join_fields({0, 0, 0, 0, 1, 0, 0}) == std::uint64_t{1} << 35);
  CHECK(join_fields({0, 0, 0, 0, 0, 1, 0}) == std::uint64_t{1} << 41);
  CHECK(join_fields({0, 0, 0, 0, 0, 0, 1}) == std::uint64_t{1} << 56);
  CHECK(join_fields({1023, 1023, 1023, 31, 63, 32767, 255}) == ~std::uint64_t{0});
  std::mt19937_64 random(1);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t bits = random();
    CHECK(join_fields(split_fields(bits)) == bits);
  }
}

TEST_CASE("stores a record in little-endian order") {
  const RecordFrame frame = frame_for({{0, 0, 0}, {1024, 1024, 1024}}, 32767);
  const std::array positions{glm::vec3(1.5f, 2.5f, 3.5f)};
  const std::array normals{glm::vec3(0, 0, 1)};
  const std::array weights{6.0f};
  const std::array<std::uint8_t, 1> colors{7};
  std::array<std::byte, 8> bytes{};
  pack_records(positions, normals, weights, colors, frame, bytes.data());
  // 1 | 2 << 10 | 3 << 20 = 0x00300801; 6 << 41 = 0x00000c00'00000000; 7 << 56.
  const std::array<int, 8> expected{0x01, 0x08, 0x30, 0x00, 0x00, 0x0c, 0x00, 0x07};
  for (std::size_t i = 0; i < 8; ++i) CHECK(std::to_integer<int>(bytes[i]) == expected[i]);
}

TEST_CASE("decodes pinned records to their pinned numbers") {
  const std::vector<std::byte> records = read_bytes("records.bin");
  REQUIRE(records.size() == 12 * kRecordBytes);
  std::ifstream text(GHOSTSPACE_TESTS "/qnv/vectors/v1/records.txt");
  std::string line, word;
  std::getline(text, line);
  RecordFrame frame;
  text >> word >> frame.lower.x >> frame.lower.y >> frame.lower.z >> frame.cell.x >> frame.cell.y >> frame.cell.z >>
      frame.weight_step;
  REQUIRE(word == "frame");
  REQUIRE(valid(frame));
  for (std::size_t i = 0; i < 12; ++i) {
    RecordVector expected;
    int color = -1;
    text >> expected.position.x >> expected.position.y >> expected.position.z >> expected.normal.x >>
        expected.normal.y >> expected.normal.z >> expected.weight >> color;
    REQUIRE(text.good());
    expected.color = static_cast<std::uint8_t>(color);
    const RecordVector v = unpack_record(load(&records[i * kRecordBytes]), frame);
    CHECK(v.position == expected.position);
    CHECK(v.weight == expected.weight);
    CHECK(v.color == expected.color);
    // These numbers were computed with the sine of another library, so the last bit may differ.
    for (int axis = 0; axis < 3; ++axis) CHECK(std::abs(v.normal[axis] - expected.normal[axis]) < 6e-8f);
  }
}

TEST_CASE("decodes normal codes to the unit vectors of the formula") {
  for (unsigned code = 0; code < kNormalCodes; ++code) {
    const double t = (code % 32 + 0.5) / 32 * std::numbers::pi, f = (code / 32 + 0.5) / 64 * 2 * std::numbers::pi;
    const glm::vec3 n = normal_of(code);
    REQUIRE(std::abs(n.x - std::sin(t) * std::cos(f)) < 4e-8);
    REQUIRE(std::abs(n.y - std::sin(t) * std::sin(f)) < 4e-8);
    REQUIRE(std::abs(n.z - std::cos(t)) < 4e-8);
    REQUIRE(normal_code(n) == code);
    REQUIRE(normal_code(n * 1e-20f) == code);
    REQUIRE(normal_code(n * 1e20f) == code);
  }
}

TEST_CASE("encodes a direction to the nearest code, within the proved bound") {
  std::mt19937 random(2);
  double worst = 0;
  for (int i = 0; i < 300; ++i) {
    const glm::vec3 d = random_direction(random);
    double nearest = 10;
    for (unsigned code = 0; code < kNormalCodes; ++code) nearest = std::min(nearest, angle(d, normal_of(code)));
    const double got = angle(d, normal_of(normal_code(d)));
    REQUIRE(got <= nearest + 1e-6);
  }
  for (int i = 0; i < 20000; ++i) {
    const glm::vec3 d = random_direction(random);
    worst = std::max(worst, angle(d, normal_of(normal_code(d))));
  }
  CHECK(worst <= kLargestNormalError + 1e-7);
  CHECK(worst > 0.9 * kLargestNormalError);  // the bound is nearly reached
  CHECK(kLargestNormalError >= 2 * std::asin(std::sqrt(2) * std::sin(std::numbers::pi / 128)));
}

TEST_CASE("encodes directions at the borders and impossible ones") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  CHECK(normal_code({0, 0, 1}) == 0);
  CHECK(normal_code({0, 0, -1}) == 31);
  CHECK(normal_code({0, 0, 0}) == 0);
  CHECK(normal_code({nan, 0, 0}) == 0);
  CHECK(normal_code({0, infinity, 0}) == 0);
  for (const float x : {-1.0f, -0.0f, 0.0f, 1.0f})
    for (const float y : {-1.0f, -0.0f, 0.0f, 1.0f})
      for (const float z : {-1.0f, -0.0f, 0.0f, 1.0f}) {
        const glm::vec3 d{x, y, z};
        if (x == 0 && y == 0 && z == 0) continue;
        CHECK(normal_code(d) < kNormalCodes);
        CHECK(angle(d, normal_of(normal_code(d))) <= kLargestNormalError + 1e-7);
      }
}

TEST_CASE("restores positions and weights within half a step") {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    const float scale = std::ldexp(1.0f, static_cast<int>(random() % 60) - 30);
    Box box;
    for (int i = 0; i < 2; ++i)
      box.add({random_float(random, -scale, scale), random_float(random, -scale, scale) * 0.01f,
               random_float(random, scale, 1.5f * scale)});
    const float largest = random_float(random, 0.1f, 1) * scale;
    const RecordFrame frame = frame_for(box, largest);
    REQUIRE(valid(frame));
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(frame.box().upper[axis] >= box.upper[axis]);
      CHECK(frame.cell[axis] <= (box.upper[axis] - box.lower[axis]) / 1024 * 1.0005f);
    }
    for (int i = 0; i < 50; ++i) {
      RecordVector v;
      for (int axis = 0; axis < 3; ++axis)
        v.position[axis] =
            std::clamp(random_float(random, box.lower[axis], box.upper[axis]), box.lower[axis], box.upper[axis]);
      v.normal = random_direction(random);
      v.weight = std::max(random_float(random, 0, largest), largest * 1e-6f);
      v.color = static_cast<std::uint8_t>(random());
      const std::uint64_t bits = pack_record(v, frame);
      const RecordVector back = unpack_record(bits, frame);
      for (int axis = 0; axis < 3; ++axis) {
        const double rounding = std::abs(v.position[axis]) * 1.2e-7;
        REQUIRE(std::abs(double{back.position[axis]} - v.position[axis]) <= frame.cell[axis] * 0.5 + rounding);
      }
      const double weight_error = std::abs(double{back.weight} - v.weight);
      REQUIRE(weight_error <= frame.weight_step * (v.weight < frame.weight_step / 2 ? 1 : 0.5) + v.weight * 1.2e-7);
      REQUIRE(back.color == v.color);
      REQUIRE(split_fields(bits).weight >= 1);
      REQUIRE(pack_record(back, frame) == bits);  // repacking changes nothing
    }
  }
}

TEST_CASE("clamps values that do not fit into a record") {
  const RecordFrame frame = frame_for({{0, 0, 0}, {1, 2, 3}}, 10);
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const RecordFields f = split_fields(pack_record({{-5, 7, nan}, {0, 0, 1}, 1e30f, 0}, frame));
  CHECK((f.x == 0 && f.y == 1023 && f.z == 0));
  CHECK(f.weight == kRecordLargestWeight);
  CHECK(split_fields(pack_record({{0, 0, 0}, {0, 0, 1}, 0, 0}, frame)).weight == 1);
  CHECK(split_fields(pack_record({{0, 0, 0}, {0, 0, 1}, -3, 0}, frame)).weight == 1);
  CHECK(split_fields(pack_record({{0, 0, 0}, {0, 0, 1}, nan, 0}, frame)).weight == 1);
  CHECK(split_fields(pack_record({{infinity, 0, 0}, {0, 0, 1}, infinity, 0}, frame)).weight == kRecordLargestWeight);
  CHECK(unpack_record(0, frame).weight == frame.weight_step);  // the reserved weight
  const RecordFrame flat = frame_for({{4, 5, 6}, {4, 5, 6}}, 1);
  CHECK(unpack_record(pack_record({{4, 5, 6}, {1, 0, 0}, 1, 0}, flat), flat).position == glm::vec3(4, 5, 6));
}

TEST_CASE("rejects frames that decode to invalid numbers") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  CHECK(valid(some_frame()));
  for (const float bad : {nan, infinity, -infinity, -1.0f, -0.0f, 1e36f, std::nextafter(1.0f, 2.0f)}) {
    RecordFrame frame = some_frame();
    frame.cell.y = bad;
    CHECK_FALSE(valid(frame));
  }
  for (const float bad : {nan, infinity, -infinity}) {
    RecordFrame frame = some_frame();
    frame.lower.z = bad;
    CHECK_FALSE(valid(frame));
  }
  for (const float bad : {nan, infinity, 0.0f, -1.0f, 1e-40f, 1e35f}) {
    RecordFrame frame = some_frame();
    frame.weight_step = bad;
    CHECK_FALSE(valid(frame));
  }
}

namespace {

// Arrays with guards on both sides, starting `offset` numbers after a cache line.
struct Guarded {
  Guarded(std::size_t count, std::size_t offset)
      : position_floats(3 * count + 64, -1),
        normal_floats(3 * count + 64, -1),
        weights(count + 64, -1),
        colors(count + 64, 0xee) {
    out = {reinterpret_cast<glm::vec3*>(position_floats.data() + 16 + offset),
           reinterpret_cast<glm::vec3*>(normal_floats.data() + 16 + 5 * offset % 16),
           weights.data() + 16 + 3 * offset % 16, colors.data() + 16 + offset};
  }
  bool operator==(const Guarded& o) const {
    return std::memcmp(position_floats.data(), o.position_floats.data(), 4 * position_floats.size()) == 0 &&
           std::memcmp(normal_floats.data(), o.normal_floats.data(), 4 * normal_floats.size()) == 0 &&
           std::memcmp(weights.data(), o.weights.data(), 4 * weights.size()) == 0 && colors == o.colors;
  }
  std::vector<float> position_floats, normal_floats, weights;
  std::vector<std::uint8_t> colors;
  paths::Outputs out{};
};

}  // namespace

TEST_CASE("computes the same bits on all code paths, without writes elsewhere") {
  std::mt19937_64 random(4);
  std::vector<std::byte> records(kRecordBytes * 1500 + 3);
  for (std::byte& b : records) b = static_cast<std::byte>(random());
  std::vector<std::size_t> counts;
  for (std::size_t n = 0; n < 140; ++n) counts.push_back(n);
  counts.insert(counts.end(), {255, 256, 1000, 1499});
  std::mt19937 random32(5);
  for (const std::size_t count : counts) {
    const std::size_t offset = count % 16;
    const float size = std::ldexp(1.0f, static_cast<int>(random32() % 40) - 20);
    const RecordFrame frame =
        frame_for({{-size, size, 3 * size}, {random_float(random32, 0, size), 2 * size, 3 * size}}, size);
    const std::byte* p = records.data() + count % 3;  // records need not be aligned
    Guarded expected(count, offset);
    paths::unpack_portable(p, count, frame, expected.out);
    if (paths::has_avx2()) {
      Guarded got(count, offset);
      paths::unpack_avx2(p, count, frame, got.out);
      REQUIRE(got == expected);
    }
    Guarded got(count, offset);
    unpack_records(std::span(p, kRecordBytes * count + (count == 0 ? 0 : 3 - count % 3)), frame, got.out.positions,
                   got.out.normals, got.out.weights, got.out.colors);
    REQUIRE(got == expected);
    for (std::size_t i = 0; i < count; ++i) {
      const RecordVector v = unpack_record(load(p + kRecordBytes * i), frame);
      REQUIRE(expected.out.positions[i] == v.position);
      REQUIRE(expected.out.normals[i] == v.normal);
      REQUIRE(expected.out.weights[i] == v.weight);
      REQUIRE(expected.out.colors[i] == v.color);
    }
  }
}

}  // namespace gs::qnv
