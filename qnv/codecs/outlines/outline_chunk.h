#pragma once

#include "qnv/codecs/outlines/outline_bits.h"
#include "qnv/container/outline_header.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Chunk of outlines or of inner polygons: a head, then records. Internal to the encoder and decoder of outline streams.
// FORMAT.md, "Outlines payload", defines every bit.
namespace gs::qnv::outline {

/// Corner on the lattices: x, y, z for the position, s, t for the texture.
struct Corner {
  std::array<std::uint32_t, 3> p{};
  std::array<std::uint32_t, 2> t{};
};

/// Number of coordinates of a written corner (u, v, w, s, t), and number of coordinates that depend on the plane (u, v,
/// w).
constexpr std::size_t kAxes = 5, kPlaneAxes = 3;
using Place = std::array<std::int64_t, kAxes>;

/// Plane of polygons. `axis` is the axis w; u and v are the next two axes in the order x, y, z, x. Subtracting the rise
/// of the plane makes w nearly constant in the plane.
struct Plane {
  static constexpr std::array<int, 4> kSlopeBits{0, 6, 10, 14};
  std::uint8_t axis = 2, precision = 0;  // precision of the slopes, 0..3; 0 means no slopes
  std::array<std::int32_t, 2> slopes{};  // in units of 1 / 2^(bits - 2)

  [[nodiscard]] std::size_t u() const { return (axis + 1u) % 3; }
  [[nodiscard]] std::size_t v() const { return (axis + 2u) % 3; }
  /// Returns the rise of the plane at (u, v) in lattice steps, rounded down.
  [[nodiscard]] std::int64_t rise(std::int64_t u, std::int64_t v) const {
    return precision == 0 ? 0 : (slopes[0] * u + slopes[1] * v) >> (kSlopeBits[precision] - 2);
  }
  /// Returns the number of bits that write() writes.
  [[nodiscard]] int cost() const { return 4 + 2 * kSlopeBits[precision]; }
  void write(BitWriter& to) const;
  static Plane read(BitReader& from);  // may return axis 3; the caller must reject it
  [[nodiscard]] bool good() const { return axis < 3; }
};

/// Converter of corners to coordinates relative to a point on the lattice, in the axes of a plane.
class PlaneView {
 public:
  PlaneView(const Plane& plane, const std::array<std::int64_t, 3>& origin) : plane_(plane), origin_(origin) {}
  [[nodiscard]] Place place(const Corner& corner) const;
  /// Converts coordinates back to x, y, z; s and t do not change.
  [[nodiscard]] Place lattice(const Place& place) const;

 private:
  Plane plane_;
  std::array<std::int64_t, 3> origin_;
};

/// Orders of the Exp-Golomb codes for the zigzag differences of corners.
struct Code {
  std::array<std::uint8_t, kAxes> orders{};

  void write(BitWriter& to, std::size_t axes) const;
  static Code read(BitReader& from, std::size_t axes);
};

/// Parameters that several records of a chunk share.
struct Frame {
  std::uint32_t first_group = 0;  // lowest group index; records add an offset
  int group_bits = 0;  // bits of that offset, 0..31
  Plane plane;
  Place origin{};  // lower corner of the box of first corners
  std::array<std::uint8_t, kAxes> bits{};  // bit widths of coordinates in that box
  Code code;
  std::uint8_t count_order = 0;  // for outlines: order of the code for the number of inner polygons

  /// Converts a first corner to coordinates relative to the box, as they are written.
  [[nodiscard]] Place place(const Corner& corner) const;
  /// Converts such coordinates back to x, y, z, s, t on the lattices.
  [[nodiscard]] Place lattice(Place place) const;

 private:
  /// Returns the view relative to the origin of the box in u and v, and to w = 0.
  [[nodiscard]] PlaneView view() const;
};

/// Bit widths of numbers in heads. The lattices of the stream determine them.
struct LatticeBits {
  explicit LatticeBits(const OutlineHeader& header);
  std::array<int, 3> positions{};
  std::array<int, 2> texture_coordinates{};
  int sheared = 0;  // bits of w minus a rise, including the sign
};

struct ChunkHead {
  static constexpr std::size_t kFixedBytes = 21;
  std::uint32_t number = 0;
  std::uint16_t appearance = 0;
  bool inner = false, textured = false;
  std::uint32_t first_group = 0;
  std::vector<Frame> frames;           // 1..255
  std::vector<std::uint16_t> lengths;  // size of each record in bytes, including its checksum

  [[nodiscard]] std::size_t axes() const { return textured ? kAxes : kPlaneAxes; }
  [[nodiscard]] int frame_bits() const { return static_cast<int>(std::bit_width(frames.size() - 1)); }
  /// Encodes the head, including its checksum.
  [[nodiscard]] std::vector<std::byte> encode(const LatticeBits& bits) const;
};

/// Decodes a head. Returns false if it is damaged or invalid, or if its records do not fill the payload exactly. Sets
/// `head_bytes` to the offset of the first record. Safe for untrusted bytes.
[[nodiscard]] bool decode_head(std::span<const std::byte> payload, const LatticeBits& bits, ChunkHead& head,
                               std::size_t& head_bytes);

}  // namespace gs::qnv::outline
