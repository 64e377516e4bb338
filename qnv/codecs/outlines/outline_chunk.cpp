#include "qnv/codecs/outlines/outline_chunk.h"

#include "base/bytes.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace gs::qnv::outline {
namespace {

constexpr std::size_t kHeadChecksumAt = 10;
constexpr int kFirstGroupOrder = 4;
enum ChunkFlag : std::uint8_t { kInnerChunk = 1, kTexturedChunk = 2 };

template <class Integer, Integer kPolynomial>
constexpr auto make_table() {
  std::array<Integer, 256> table{};
  for (unsigned i = 0; i < 256; ++i) {
    auto value = static_cast<Integer>(i << (8 * sizeof(Integer) - 8));
    for (int bit = 0; bit < 8; ++bit) {
      const bool high = value >> (8 * sizeof(Integer) - 1) != 0;
      value = static_cast<Integer>(static_cast<unsigned>(value) << 1 ^ (high ? kPolynomial : 0u));
    }
    table[i] = value;
  }
  return table;
}

std::int64_t sign_extended(std::uint64_t value, int width) {
  return width > 0 && (value >> (width - 1) & 1) != 0 ? static_cast<std::int64_t>(value) - (std::int64_t{1} << width)
                                                      : static_cast<std::int64_t>(value);
}

/// Returns the bit widths of the coordinates of a frame's origin.
std::array<int, kAxes> origin_bits(const Plane& plane, const LatticeBits& bits) {
  return {bits.positions[plane.u()], bits.positions[plane.v()],
          plane.precision == 0 ? bits.positions[plane.axis] : bits.sheared, bits.texture_coordinates[0],
          bits.texture_coordinates[1]};
}

void write_frame(const Frame& frame, std::uint32_t previous, const ChunkHead& head, const LatticeBits& bits,
                 BitWriter& to) {
  to.golomb(zigzag(std::int64_t{frame.first_group} - previous), kFirstGroupOrder);
  to.bits(static_cast<std::uint64_t>(frame.group_bits), 5);
  frame.plane.write(to);
  const auto widths = origin_bits(frame.plane, bits);
  for (std::size_t axis = 0; axis < head.axes(); ++axis)
    to.bits(static_cast<std::uint64_t>(frame.origin[axis]), widths[axis]);
  for (std::size_t axis = 0; axis < head.axes(); ++axis) to.bits(frame.bits[axis], 6);
  frame.code.write(to, head.axes());
  if (!head.inner) to.bits(frame.count_order, 5);
}

bool read_frame(BitReader& from, std::uint32_t previous, const ChunkHead& head, const LatticeBits& bits, Frame& frame) {
  const std::int64_t first = previous + unzigzag(from.golomb(kFirstGroupOrder));
  if (first < 0 || first > 0xffffffff) return false;
  frame.first_group = static_cast<std::uint32_t>(first);
  frame.group_bits = static_cast<int>(from.bits(5));
  frame.plane = Plane::read(from);
  if (!frame.plane.good()) return false;
  const auto widths = origin_bits(frame.plane, bits);
  for (std::size_t axis = 0; axis < head.axes(); ++axis) {
    const std::uint64_t value = from.bits(widths[axis]);
    frame.origin[axis] =
        axis == 2 && frame.plane.precision != 0 ? sign_extended(value, widths[axis]) : static_cast<std::int64_t>(value);
  }
  for (std::size_t axis = 0; axis < head.axes(); ++axis) {
    frame.bits[axis] = static_cast<std::uint8_t>(from.bits(6));
    if (frame.bits[axis] > kMaxValueBits) return false;
  }
  frame.code = Code::read(from, head.axes());
  if (!head.inner) frame.count_order = static_cast<std::uint8_t>(from.bits(5));
  return from.good();
}

}  // namespace

std::uint8_t crc8(std::span<const std::byte> bytes) {
  static constexpr auto kTable = make_table<std::uint8_t, 0x07>();
  std::uint8_t sum = 0xff;
  for (const std::byte b : bytes) sum = kTable[sum ^ std::to_integer<std::uint8_t>(b)];
  return sum;
}

std::uint16_t crc16(std::span<const std::byte> bytes, std::uint16_t from) {
  static constexpr auto kTable = make_table<std::uint16_t, 0x1021>();
  unsigned sum = from;
  for (const std::byte b : bytes) sum = (sum << 8 & 0xffff) ^ kTable[sum >> 8 ^ std::to_integer<unsigned>(b)];
  return static_cast<std::uint16_t>(sum);
}

void Plane::write(BitWriter& to) const {
  to.bits(axis, 2);
  to.bits(precision, 2);
  for (const std::int32_t slope : slopes)
    to.bits(static_cast<std::uint64_t>(static_cast<std::int64_t>(slope)), kSlopeBits[precision]);
}

Plane Plane::read(BitReader& from) {
  Plane plane;
  plane.axis = static_cast<std::uint8_t>(from.bits(2));
  plane.precision = static_cast<std::uint8_t>(from.bits(2));
  const int width = kSlopeBits[plane.precision];
  for (std::int32_t& slope : plane.slopes) slope = static_cast<std::int32_t>(sign_extended(from.bits(width), width));
  return plane;
}

Place PlaneView::place(const Corner& corner) const {
  const auto distance = [&](std::size_t axis) { return std::int64_t{corner.p[axis]} - origin_[axis]; };
  const std::int64_t u = distance(plane_.u()), v = distance(plane_.v());
  return {u, v, distance(plane_.axis) - plane_.rise(u, v), corner.t[0], corner.t[1]};
}

Place PlaneView::lattice(const Place& place) const {
  Place xyz = place;
  xyz[plane_.u()] = place[0] + origin_[plane_.u()];
  xyz[plane_.v()] = place[1] + origin_[plane_.v()];
  xyz[plane_.axis] = place[2] + plane_.rise(place[0], place[1]) + origin_[plane_.axis];
  return xyz;
}

void Code::write(BitWriter& to, std::size_t axes) const {
  for (std::size_t axis = 0; axis < axes; ++axis) to.bits(orders[axis], 5);
}

Code Code::read(BitReader& from, std::size_t axes) {
  Code code;
  for (std::size_t axis = 0; axis < axes; ++axis) code.orders[axis] = static_cast<std::uint8_t>(from.bits(5));
  return code;
}

PlaneView Frame::view() const {
  std::array<std::int64_t, 3> from{};
  from[plane.u()] = origin[0];
  from[plane.v()] = origin[1];
  return {plane, from};
}

Place Frame::place(const Corner& corner) const {
  Place place = view().place(corner);
  for (std::size_t axis = 2; axis < kAxes; ++axis) place[axis] -= origin[axis];
  return place;
}

Place Frame::lattice(Place place) const {
  for (std::size_t axis = 2; axis < kAxes; ++axis) place[axis] += origin[axis];
  return view().lattice(place);
}

LatticeBits::LatticeBits(const OutlineHeader& header) {
  int most = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    most = std::max(most, positions[axis] = static_cast<int>(std::bit_width(header.positions.size[axis])));
  for (std::size_t axis = 0; axis < 2; ++axis)
    texture_coordinates[axis] = static_cast<int>(std::bit_width(header.texture_coordinates.size[axis]));
  // Slopes are at most 1, so that w minus the rise spans at most three times the lattice.
  sheared = most + 3;
}

std::vector<std::byte> ChunkHead::encode(const LatticeBits& bits) const {
  std::vector<std::byte> out;
  ByteWriter write(out);
  const auto [shortest, longest] = std::minmax_element(lengths.begin(), lengths.end());
  const int length_bits = static_cast<int>(std::bit_width(static_cast<unsigned>(*longest - *shortest)));
  write.integer(number);
  write.integer(appearance);
  write.integer(static_cast<std::uint8_t>((inner ? kInnerChunk : 0) | (textured ? kTexturedChunk : 0)));
  write.integer(static_cast<std::uint8_t>(frames.size()));
  write.integer(std::uint16_t{0});  // placeholder for the size of the head in bytes
  write.integer(std::uint16_t{0});  // placeholder for the checksum
  write.integer(first_group);
  write.integer(static_cast<std::uint16_t>(lengths.size()));
  write.integer(*shortest);
  write.integer(static_cast<std::uint8_t>(length_bits));
  BitWriter pack(out);
  for (const std::uint16_t length : lengths) pack.bits(static_cast<std::uint64_t>(length - *shortest), length_bits);
  std::uint32_t previous = first_group;
  for (const Frame& frame : frames) {
    write_frame(frame, previous, *this, bits, pack);
    previous = frame.first_group;
  }
  pack.align();
  const auto put = [&](std::size_t at, std::size_t value) {
    out[at] = static_cast<std::byte>(value & 255);
    out[at + 1] = static_cast<std::byte>(value >> 8 & 255);
  };
  put(8, out.size());
  put(kHeadChecksumAt, crc16(out));
  return out;
}

bool decode_head(std::span<const std::byte> payload, const LatticeBits& bits, ChunkHead& head,
                 std::size_t& head_bytes) {
  ByteReader read(payload);
  head.number = read.integer<std::uint32_t>();
  head.appearance = read.integer<std::uint16_t>();
  const auto flags = read.integer<std::uint8_t>();
  const auto frames = read.integer<std::uint8_t>();
  head_bytes = read.integer<std::uint16_t>();
  const auto sum = read.integer<std::uint16_t>();
  head.first_group = read.integer<std::uint32_t>();
  const std::size_t records = read.integer<std::uint16_t>(), shortest = read.integer<std::uint16_t>();
  const auto length_bits = read.integer<std::uint8_t>();
  if (!read.good() || flags > (kInnerChunk | kTexturedChunk) || frames == 0 || records == 0 || length_bits > 16)
    return false;
  if (head_bytes < ChunkHead::kFixedBytes || head_bytes > payload.size()) return false;
  constexpr std::array<std::byte, 2> kZero{};
  const std::uint16_t before = crc16(payload.first(kHeadChecksumAt));
  if (crc16(payload.subspan(kHeadChecksumAt + 2, head_bytes - kHeadChecksumAt - 2), crc16(kZero, before)) != sum)
    return false;
  head.inner = (flags & kInnerChunk) != 0;
  head.textured = (flags & kTexturedChunk) != 0;
  BitReader pack(payload.subspan(ChunkHead::kFixedBytes, head_bytes - ChunkHead::kFixedBytes));
  if (records * std::max<std::size_t>(shortest, 1) > payload.size() || pack.left() < records * length_bits)
    return false;
  head.lengths.resize(records);
  std::size_t all = 0;
  for (std::uint16_t& length : head.lengths) {
    const std::size_t value = shortest + pack.bits(length_bits);
    if (value < 2 || value > 0xffff) return false;  // a record has at least one byte and the checksum
    length = static_cast<std::uint16_t>(value);
    all += value;
  }
  if (all != payload.size() - head_bytes) return false;
  head.frames.resize(frames);
  std::uint32_t previous = head.first_group;
  for (Frame& frame : head.frames) {
    if (!read_frame(pack, previous, head, bits, frame)) return false;
    previous = frame.first_group;
  }
  return pack.at_end();
}

}  // namespace gs::qnv::outline
