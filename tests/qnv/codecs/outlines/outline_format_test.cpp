#include "qnv/codecs/outlines/outline_chunk.h"
#include "tests/qnv/outline_decoding.h"
#include "tests/qnv/outline_shapes.h"

#include <catch2/catch.hpp>

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <random>
#include <span>
#include <string_view>
#include <vector>

// Tests of single bytes of the format (FORMAT.md).
namespace gs::qnv::outline {
namespace {

using outlines::Bytes;

Bytes bytes_of(std::initializer_list<unsigned> values) {
  Bytes bytes;
  for (const unsigned value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

/// Returns a square that remains, and a triangle that is its own inner polygon, on a lattice of 5 x 5 x 2 points with
/// step 1.
OutlineGroups tiny() {
  OutlineGroups groups;
  groups.groups.push_back(shapes::flat_group({shapes::square({0, 0, 1}, 4)}));
  OutlineGroup triangle = shapes::flat_group({{{0, 0, 0}, {3, 0, 0}, {0, 1, 0}}});
  triangle.inner = triangle.outline;
  groups.groups.push_back(triangle);
  return groups;
}

// clang-format off
const Bytes kSection = bytes_of({
    4, 0, 97, 0, 0, 0,                                           // the tag, and 78 + 19 bytes
    0, 0,                                                        // steps of 2^0
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  // the origin is 0
    4, 0, 0, 0, 4, 0, 0, 0, 1, 0, 0, 0,                          // the largest coordinates 4, 4, 1
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  // no texture coordinates
    2, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0,                          // groups, outline polygons, inner ones
    1, 0,                                                        // one appearance
    204, 204, 204, 0, 0, 0, 0, 0, 0, 51, 51, 0, 3, 0, 0, 0, 0, 0, 0});
const Bytes kOutlines = bytes_of({
    0x51, 0x43, 38, 0, 2, 0, 0xa1, 0x52, 0xbd, 0x89,  // 38 bytes of outlines
    0, 0, 0, 0,                                       // number 0
    0, 0, 0, 1,                                       // appearance 0, no flags, one frame
    29, 0, 0x54, 0x13,                                // the head's bytes and checksum
    0, 0, 0, 0,                                       // groups from 0
    2, 0, 4, 0, 1,                                    // two records of 4 bytes, and what 1 bit adds
    // From the lowest bit: 1, 0 more bytes; 10000 group 0 in order 4; 10000 one bit a group; 01 w is z, 00 no slopes;
    // 000 000 0 the origin; 000000 100000 100000 bits of first corners: 0, 1, 1; 00000 three times orders 0; 00000 the
    // order of counts.
    0x85, 0x20, 0x00, 0x20, 0x08, 0x00, 0x00, 0x00,
    // The square. 0 its group; 1 it stays; 0, 0 the frame's plane and orders; 0, 1 y and z of the first corner; 010 one
    // corner more than three, 1 a parallelogram; to the second corner 0001100 (8, the zigzag of 4), 1, 1; to the third
    // 1, 0001100, 1; of the fourth 1, 1, 1; 0 no other ring.
    0xa2, 0x62, 0x8e, 0x79, 0x19,
    // The triangle, from the end of its longest edge. 1 its group; 010 one inner polygon; 0, 0; 1, 0 y and z; 1 three
    // corners; to the second 1, 010 (the zigzag of -1), 1; to the third 00111 (6), 1, 1; 0.
    0x45, 0x2b, 0x1f, 0x09});
const Bytes kInner = bytes_of({
    0x51, 0x43, 31, 0, 3, 0, 0xd5, 0xbd, 0x3d, 0x2c,  // 31 bytes of inner polygons
    1, 0, 0, 0, 0, 0, 1, 1, 28, 0, 0x3d, 0xdb,        // number 1, appearance 0, inner, one frame
    1, 0, 0, 0, 1, 0, 3, 0, 0,                        // groups from 1, one record of 3 bytes
    // 10000 group 1; 00000; 01 z, 00; 000 100 0 the origin: y is 1; 000000 three times; 00000 three times.
    0x01, 0x08, 0x02, 0x00, 0x00, 0x00, 0x00,
    // 0, 0; 1; 1, 010, 1; 00111, 1, 1; 0
    0xac, 0x7c, 0x40});
// clang-format on

TEST_CASE("writes the bytes of a tiny outline stream as in FORMAT.md") {
  const EncodedStream stream = outlines::encoded(tiny());
  Bytes expected = kSection;
  for (const Bytes* chunk : {&kOutlines, &kInner}) expected.insert(expected.end(), chunk->begin(), chunk->end());
  REQUIRE(stream.header.directory == 108 + expected.size());
  CHECK((Bytes(stream.bytes.begin() + 108, stream.bytes.begin() + 108 + static_cast<std::ptrdiff_t>(expected.size())) ==
         expected));
  CHECK((outlines::sorted(outlines::decode_all(stream.bytes)) == outlines::expected(tiny(), stream.header.outlines)));
}

TEST_CASE("computes checksums as the CRC catalogues list them") {
  constexpr std::string_view kCheck = "123456789";
  const auto bytes = std::as_bytes(std::span(kCheck));
  CHECK(crc16(bytes) == 0x29b1);  // CRC-16/IBM-3740
  CHECK(crc8(bytes) == 0xfb);
  CHECK(crc8({}) == 0xff);
}

TEST_CASE("restores numbers of any width, and reports truncated ones") {
  std::mt19937_64 random(1);
  struct Number {
    std::uint64_t value;
    int width, order;  // width < 0 means a code
  };
  std::vector<Number> numbers;
  Bytes bytes;
  BitWriter to(bytes);
  for (int i = 0; i < 5000; ++i) {
    Number n{random() >> (24 + random() % 40), static_cast<int>(random() % 41), static_cast<int>(random() % 32)};
    if (random() % 2 == 0) {
      n.width = -1;
      n.value = n.value >> 1;  // and 2^order more: below 2^40
      to.golomb(n.value, n.order);
    } else {
      n.value &= (std::uint64_t{1} << n.width) - 1;
      to.bits(n.value, n.width);
    }
    numbers.push_back(n);
  }
  to.align();
  BitReader from(bytes);
  bool same = true;
  std::size_t bits = 0;
  for (const Number& n : numbers) {
    same = same && (n.width < 0 ? from.golomb(n.order) : from.bits(n.width)) == n.value;
    bits += static_cast<std::size_t>(n.width < 0 ? golomb_bits(n.value, n.order) : n.width);
  }
  CHECK(same);
  CHECK(from.at_end());
  CHECK((bits + 7) / 8 == bytes.size());
  CHECK(from.bits(8) == 0);
  CHECK_FALSE(from.good());
  // A code without an end, and one that is too long.
  const Bytes zeros(100);
  BitReader endless(zeros);
  CHECK(endless.golomb(0) == 0);
  CHECK_FALSE(endless.good());
  for (const std::int64_t value : {std::int64_t{0}, std::int64_t{-1}, std::int64_t{1}, -(std::int64_t{1} << 38)})
    CHECK(unzigzag(zigzag(value)) == value);
  CHECK(zigzag(-2) == 3);
}

TEST_CASE("converts positions to the axes of a plane and back") {
  std::mt19937 random(2);
  bool same = true;
  for (int i = 0; i < 20000; ++i) {
    Plane plane;
    plane.axis = static_cast<std::uint8_t>(random() % 3);
    plane.precision = static_cast<std::uint8_t>(random() % 4);
    const int width = Plane::kSlopeBits[plane.precision];
    if (width > 0)
      for (std::int32_t& slope : plane.slopes) slope = static_cast<std::int32_t>(random()) % (1 << (width - 1));
    const auto coordinate = [&] { return static_cast<std::uint32_t>(random() >> (2 + random() % 28)); };
    const Corner corner{{coordinate(), coordinate(), coordinate()}, {coordinate(), coordinate()}};
    const PlaneView view(plane, {coordinate(), coordinate(), coordinate()});
    const Place back = view.lattice(view.place(corner));
    for (std::size_t axis = 0; axis < kAxes; ++axis)
      same = same && back[axis] == (axis < 3 ? corner.p[axis] : corner.t[axis - 3]);
    Bytes bytes;
    BitWriter to(bytes);
    plane.write(to);
    to.align();
    BitReader from(bytes);
    const Plane read = Plane::read(from);
    same = same && read.axis == plane.axis && read.precision == plane.precision && read.slopes == plane.slopes;
  }
  CHECK(same);
}

}  // namespace
}  // namespace gs::qnv::outline
