#pragma once

#include "qnv/codecs/values/block_places.h"
#include "qnv/entropy/binary_coder.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::values {

using displaced::BinaryDecoder;
using displaced::BinaryEncoder;

/// Adaptive probability of a 1: the mean of a fast and of a slow estimate.
struct Estimate {
  std::uint16_t fast = 32768, slow = 32768;  // in 1/65536
  std::uint8_t seen = 0;

  void start(std::uint32_t probability) { fast = slow = static_cast<std::uint16_t>(probability); }
  [[nodiscard]] std::uint32_t probability() const {
    return std::clamp<std::uint32_t>((std::uint32_t{fast} + slow) >> 1, 48, 65536 - 48);
  }
  void learn(bool bit) {
    // Early decisions change both estimates fast; later ones change `slow` less.
    const int quick = kQuick[seen], late = kLate[seen];
    const std::int32_t target = bit ? 65535 : 0;
    fast = static_cast<std::uint16_t>(fast + ((target - fast) >> quick));
    slow = static_cast<std::uint16_t>(slow + ((target - slow) >> late));
    seen = static_cast<std::uint8_t>(seen + (seen < kQuick.size() - 1 ? 1 : 0));
  }

 private:
  static constexpr std::array<std::uint8_t, 48> kQuick = [] {
    std::array<std::uint8_t, 48> shifts{};
    for (std::size_t n = 0; n < shifts.size(); ++n) shifts[n] = n < 3 ? 2 : n < 8 ? 3 : 4;
    return shifts;
  }();
  static constexpr std::array<std::uint8_t, 48> kLate = [] {
    std::array<std::uint8_t, 48> shifts{};
    for (std::size_t n = 0; n < shifts.size(); ++n) shifts[n] = n < 3 ? 2 : n < 8 ? 3 : n < 18 ? 4 : n < 40 ? 5 : 7;
    return shifts;
  }();
};

/// Cuboid of samples that one level gives, while its axes are lifted. The rows of x have the even samples first.
/// `first` is even.
struct SplitWindow {
  Extent first{}, size{};
  std::int32_t* samples = nullptr;
};

/// Buffer for the decisions of one block. Each thread reuses one.
struct BlockScratch {
  std::vector<std::uint8_t> sizes;  // of the coefficients in units of the current plane, at most 4; with borders
};

/// Coefficients of a block where a transform keeps them.
struct BlockBands {
  std::array<std::array<std::int32_t*, kBlockEdge>, 8> parts{};  // first sample of each slice of BlockPlace::bands
  std::size_t row = 0;                                           // distance of consecutive rows
};
/// Returns the coefficients of a block in a transformed volume.
[[nodiscard]] BlockBands bands_in_volume(const BlockPlace& place, std::span<std::int32_t> volume, Extent extent);

/// Coefficients of one block while its planes are coded, and the estimates that both sides learn. A step codes one cube
/// in one plane. FORMAT.md, "Values payload", defines the decisions.
class Block {
 public:
  explicit Block(const BlockPlace& place);

  [[nodiscard]] int level() const { return place_.level; }
  /// Number of cubes: the steps of one plane.
  [[nodiscard]] std::size_t cubes() const { return cubes_.size(); }
  /// Returns the memory of the coefficients and of all else.
  [[nodiscard]] std::size_t bytes() const {
    return sizeof(*this) + values_.capacity() * sizeof(std::uint32_t) + cubes_.capacity() * sizeof(Cube) +
           bands_.capacity() * sizeof(Band);
  }
  /// Sets the plane of the first step. Planes above it are zero.
  void start(int plane) { plane_ = plane; }
  /// Cube of the next step.
  [[nodiscard]] std::size_t cube() const { return cube_; }
  /// Plane of the next step. -1 means that the block is exact.
  [[nodiscard]] int plane() const { return plane_; }
  [[nodiscard]] bool at_plane_start() const { return cube_ == 0; }
  /// Plane down to which all coefficients are known.
  [[nodiscard]] int known_plane() const { return plane_ + 1; }

  /// Takes the coefficients to encode. Returns the highest plane that is not zero, or -1.
  int load(const BlockBands& bands);
  /// Returns the squared error of the volume while all coefficients of an encoder are zero.
  [[nodiscard]] double energy() const;
  /// Result of encoding some steps.
  struct Encoded {
    std::uint32_t steps = 0;
    double gain = 0;  // reduction of the squared error of the volume
  };
  /// Encodes steps until the plane ends after at least `plane_bytes`, or until `most_bytes`, or until `last_plane` is
  /// coded. The last step may exceed that limit by less than kMaxClusterBytes - kClusterEnd.
  Encoded encode(BinaryEncoder& encoder, std::size_t plane_bytes, std::size_t most_bytes, int last_plane,
                 BlockScratch& scratch);
  /// Decodes `steps` steps, or fewer if the bytes are exhausted or the block is exact.
  /// Returns the number of decoded steps.
  std::size_t decode(BinaryDecoder& decoder, std::uint32_t steps, BlockScratch& scratch);
  /// Writes the coefficients that are not zero, each at the middle of its possible values.
  void write(const BlockBands& bands) const;
  /// Writes them to the transformed volume; the second function writes only the low band.
  void write(std::span<std::int32_t> bands, Extent extent) const { write(bands_in_volume(place_, bands, extent)); }
  void write_low(std::span<std::int32_t> bands, Extent extent) const;
  /// Writes the coefficients in a window of the samples that its level gives, except the low band.
  void write_split(const SplitWindow& window) const;
  /// Calls visit(at) for those of the cubes `first` to `first + steps - 1` that are not zero. `at` is the place of the
  /// cube in its band. The cubes after the last one are the first ones again.
  template <class Visit>
  void visit_known(std::size_t first, std::size_t steps, const Visit& visit) const {
    for (std::size_t i = 0; i < std::min(steps, cubes_.size()); ++i) {
      const Cube& cube = cubes_[(first + i) % cubes_.size()];
      if (cube.values >= 0) visit(band_place(cube));
    }
  }

 private:
  struct Cube {
    std::uint8_t band = 0, lowest = 0;         // `lowest`: last coded plane
    std::array<std::uint8_t, 3> at{}, size{};  // position in cubes; size in coefficients
    std::int16_t values = -1;                  // index of the values in units of kCubeSize; -1 while all are zero
  };
  struct Band {
    std::uint32_t first = 0, row = 0, slice = 0;  // layout of BlockScratch::sizes
    std::array<std::uint8_t, 3> cubes{};
    std::uint16_t first_cube = 0;
  };
  template <class Side>
  void step(Side& side, std::uint8_t* sizes);
  template <class Side>
  void code_values(Side& outer, Cube& cube, const Band& band, std::uint8_t* sizes);
  [[nodiscard]] Extent band_place(const Cube& cube) const;
  void fill_sizes(std::vector<std::uint8_t>& sizes) const;
  void write(const Cube& cube, const BlockBands& bands) const;
  [[nodiscard]] std::size_t cube_context(std::size_t index) const;

  BlockPlace place_;
  std::vector<Band> bands_;
  std::vector<Cube> cubes_;
  std::vector<std::uint32_t> values_;  // of cubes that are not zero: magnitude, and the sign in the highest bit
  std::vector<std::int32_t> source_;   // encoder: all coefficients, cube by cube
  std::uint32_t sizes_bytes_ = 0;
  std::array<Estimate, 15> cube_models_;
  std::array<std::array<Estimate, 16>, 4> one_models_;
  std::array<Estimate, 4> line_models_, more_models_;
  int plane_ = -1;
  std::size_t cube_ = 0;
};

}  // namespace gs::qnv::values
