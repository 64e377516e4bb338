#pragma once

#include "qnv/codecs/outlines/outline_bits.h"
#include "qnv/container/outline_header.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// A chunk of outlines or of inner polygons: a head, then records. Internal to the encoder and decoder of outline
// streams. FORMAT.md, "Outlines payload", defines every bit.
namespace gs::qnv::outline {

/// Corner: x, y, z on the position lattice, s, t on the texture lattice.
struct Corner {
  std::array<std::uint32_t, 3> p{};
  std::array<std::uint32_t, 2> t{};
};

/// Coordinates of a corner as written: u, v, w, s, t.
constexpr std::size_t kAxes = 5, kPlaneAxes = 3;
using Place = std::array<std::int64_t, kAxes>;

/// Plane of polygons. `axis` is w; u and v are the next two axes in the order x, y, z, x. Subtracting the plane's rise
/// from w makes w nearly constant within the plane.
struct Plane {
  static constexpr std::array<int, 4> kSlopeBits{0, 6, 10, 14};
  std::uint8_t axis = 2, precision = 0;  // precision: 0..3; 0 means no slopes
  std::array<std::int32_t, 2> slopes{};  // in units of 1 / 2^(bits - 2)

  [[nodiscard]] std::size_t u() const { return (axis + 1u) % 3; }
  [[nodiscard]] std::size_t v() const { return (axis + 2u) % 3; }
  /// Returns the rise of the plane at (u, v), rounded down.
  [[nodiscard]] std::int64_t rise(std::int64_t u, std::int64_t v) const {
    return precision == 0 ? 0 : (slopes[0] * u + slopes[1] * v) >> (kSlopeBits[precision] - 2);
  }
  /// Returns the number of bits that write() produces.
  [[nodiscard]] int cost() const { return 4 + 2 * kSlopeBits[precision]; }
  void write(BitWriter& to) const;
  static Plane read(BitReader& from);  // may return axis 3, which the caller must reject
  [[nodiscard]] bool good() const { return axis < 3; }
};

/// Corners relative to a point on the lattice, in a plane's axes.
class PlaneView {
 public:
  PlaneView(const Plane& plane, const std::array<std::int64_t, 3>& origin) : plane_(plane), origin_(origin) {}
  [[nodiscard]] Place place(const Corner& corner) const;
  /// Converts back to x, y, z; s and t are unchanged.
  [[nodiscard]] Place lattice(const Place& place) const;

 private:
  Plane plane_;
  std::array<std::int64_t, 3> origin_;
};

/// Orders of the Exp-Golomb codes for zigzag differences.
struct Code {
  std::array<std::uint8_t, kAxes> orders{};

  void write(BitWriter& to, std::size_t axes) const;
  static Code read(BitReader& from, std::size_t axes);
};

/// Shared parameters of a chunk's records.
struct Frame {
  std::uint32_t first_group = 0;  // base of the records' group numbers
  int group_bits = 0;             // 0..31
  Plane plane;
  Place origin{};                          // of the box of first corners
  std::array<std::uint8_t, kAxes> bits{};  // widths within that box
  Code code;
  std::uint8_t count_order = 0;  // outlines: order of the number of inner polygons

  /// Returns a first corner relative to the box, as written.
  [[nodiscard]] Place place(const Corner& corner) const;
  /// Converts back to x, y, z, s, t on the lattices.
  [[nodiscard]] Place lattice(Place place) const;

 private:
  /// Returns the view from the box's origin (u, v) and w = 0.
  [[nodiscard]] PlaneView view() const;
};

/// Bit widths in heads, which follow from the stream's lattices.
struct LatticeBits {
  explicit LatticeBits(const OutlineHeader& header);
  std::array<int, 3> positions{};
  std::array<int, 2> texture_coordinates{};
  int sheared = 0;  // of w minus a rise, with its sign
};

struct ChunkHead {
  static constexpr std::size_t kFixedBytes = 21;
  std::uint32_t number = 0;
  std::uint16_t appearance = 0;
  bool inner = false, textured = false;
  std::uint32_t first_group = 0;
  std::vector<Frame> frames;           // 1..255
  std::vector<std::uint16_t> lengths;  // of the records in bytes, including their checksums

  [[nodiscard]] std::size_t axes() const { return textured ? kAxes : kPlaneAxes; }
  [[nodiscard]] int frame_bits() const { return static_cast<int>(std::bit_width(frames.size() - 1)); }
  /// Returns the bytes of the head, with its checksum.
  [[nodiscard]] std::vector<std::byte> encode(const LatticeBits& bits) const;
};

/// Reads a head. Returns false if it is damaged or invalid, or if its records do not fill the payload exactly. Sets
/// `head_bytes` to the offset of the first record. Safe for untrusted bytes.
[[nodiscard]] bool decode_head(std::span<const std::byte> payload, const LatticeBits& bits, ChunkHead& head,
                               std::size_t& head_bytes);

}  // namespace gs::qnv::outline
