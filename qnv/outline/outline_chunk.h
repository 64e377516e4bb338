#pragma once

#include "qnv/outline/outline_bits.h"
#include "qnv/stream/outline_header.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// A chunk of outlines or of inner polygons: a head, then records. Only for the encoder and the decoder of outline
// streams; FORMAT.md, "Outlines payload", defines every bit.
namespace gs::qnv::outline {

/// A corner: x, y, z on the lattice of positions, s, t on that of texture coordinates.
struct Corner {
  std::array<std::uint32_t, 3> p{};
  std::array<std::uint32_t, 2> t{};
};

/// A corner as it is written: u, v, w, s, t.
constexpr std::size_t kAxes = 5, kPlaneAxes = 3;
using Place = std::array<std::int64_t, kAxes>;

/// Which axis is w, the one that a plane gives: then u and v are the two behind it, in the order x, y, z, x. From w is
/// taken what the slopes give, so that what lies in the plane has about the same w.
struct Plane {
  static constexpr std::array<int, 4> kSlopeBits{0, 6, 10, 14};
  std::uint8_t axis = 2, precision = 0;  // precision: 0..3, none without slopes
  std::array<std::int32_t, 2> slopes{};  // in 1 / 2^(bits - 2)

  [[nodiscard]] std::size_t u() const { return (axis + 1u) % 3; }
  [[nodiscard]] std::size_t v() const { return (axis + 2u) % 3; }
  /// What the slopes give at a distance of (u, v), rounded down.
  [[nodiscard]] std::int64_t rise(std::int64_t u, std::int64_t v) const {
    return precision == 0 ? 0 : (slopes[0] * u + slopes[1] * v) >> (kSlopeBits[precision] - 2);
  }
  /// Bits that `write` takes.
  [[nodiscard]] int cost() const { return 4 + 2 * kSlopeBits[precision]; }
  void write(BitWriter& to) const;
  static Plane read(BitReader& from);  // axis 3 is left for the reader to refuse
  [[nodiscard]] bool good() const { return axis < 3; }
};

/// Corners seen from one of them (or any place on the lattice), in a plane's axes.
class PlaneView {
 public:
  PlaneView(const Plane& plane, const std::array<std::int64_t, 3>& origin) : plane_(plane), origin_(origin) {}
  [[nodiscard]] Place place(const Corner& corner) const;
  /// Back to x, y, z; s and t as they are.
  [[nodiscard]] Place lattice(const Place& place) const;

 private:
  Plane plane_;
  std::array<std::int64_t, 3> origin_;
};

/// How differences are written, as zigzag: the orders of their Exp-Golomb codes.
struct Code {
  std::array<std::uint8_t, kAxes> orders{};

  void write(BitWriter& to, std::size_t axes) const;
  static Code read(BitReader& from, std::size_t axes);
};

/// What records of a chunk have in common unless they say otherwise.
struct Frame {
  std::uint32_t first_group = 0;  // records count from it
  int group_bits = 0;             // 0..31
  Plane plane;
  Place origin{};                          // of the box of first corners
  std::array<std::uint8_t, kAxes> bits{};  // of that box
  Code code;
  std::uint8_t count_order = 0;  // outlines: of the number of inner polygons

  /// Where in the box of first corners one lies: what is written of it.
  [[nodiscard]] Place place(const Corner& corner) const;
  /// Back to x, y, z, s, t on the lattices.
  [[nodiscard]] Place lattice(Place place) const;

 private:
  /// From u and v of the box's origin, and from w = 0.
  [[nodiscard]] PlaneView view() const;
};

/// Widths of numbers in heads: what the stream's lattices need.
struct LatticeBits {
  explicit LatticeBits(const OutlineHeader& header);
  std::array<int, 3> positions{};
  std::array<int, 2> texture_coordinates{};
  int sheared = 0;  // of w less a rise, with its sign
};

struct ChunkHead {
  static constexpr std::size_t kFixedBytes = 21;
  std::uint32_t number = 0;
  std::uint16_t appearance = 0;
  bool inner = false, textured = false;
  std::uint32_t first_group = 0;
  std::vector<Frame> frames;           // 1..255
  std::vector<std::uint16_t> lengths;  // of the records, in bytes, with their checksums

  [[nodiscard]] std::size_t axes() const { return textured ? kAxes : kPlaneAxes; }
  [[nodiscard]] int frame_bits() const { return static_cast<int>(std::bit_width(frames.size() - 1)); }
  /// The bytes of the head, with its checksum.
  [[nodiscard]] std::vector<std::byte> encode(const LatticeBits& bits) const;
};

/// Reads a head; false when it is damaged or impossible, or its records do not fill the payload exactly. `head_bytes`
/// is where the first record begins. Safe for untrusted bytes.
[[nodiscard]] bool decode_head(std::span<const std::byte> payload, const LatticeBits& bits, ChunkHead& head,
                               std::size_t& head_bytes);

}  // namespace gs::qnv::outline
