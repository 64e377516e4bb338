#pragma once

#include "qnv/codecs/values/block_places.h"
#include "qnv/codecs/values/block_shape.h"
#include "qnv/codecs/values/plane_models.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv::values {

/// Cuboid of samples that one level gives, while its axes are lifted. The rows of x have the even samples first, and
/// the odd ones from `odd` on. `first` is even.
struct SplitWindow {
  Extent first{}, size{};
  std::int32_t* samples = nullptr;
  std::size_t row = 0, odd = 0;  // distance of consecutive rows; place of the odd samples
};

/// Buffers for the decisions of one block. Each thread reuses one.
struct BlockScratch {
  std::vector<std::uint8_t> sizes;    // of the coefficients in units of the current plane, at most 4; with borders
  std::array<std::byte, 2048> bytes;  // of a cluster while it is encoded
  std::vector<std::byte> padded;      // bytes of a cluster while it is decoded, and zeros
};

/// Coefficients of a block where a transform keeps them.
struct BlockBands {
  std::array<std::array<std::int32_t*, kBlockEdge>, 8> parts{};  // first sample of each slice of BlockPlace::bands
  std::size_t row = 0;                                           // distance of consecutive rows
};
/// Returns the coefficients of a block in a transformed volume.
[[nodiscard]] BlockBands bands_in_volume(const BlockPlace& place, std::span<std::int32_t> volume, Extent extent);

/// Coded steps of a cluster.
struct CodedSteps {
  std::span<const std::byte> bytes;
  std::uint32_t steps = 0;
};

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
           active_.capacity();
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
  /// Returns the squared error of the volume while all coefficients of an encoder are zero. Call it before encode().
  [[nodiscard]] double energy() const;
  /// Result of encoding some steps.
  struct Encoded {
    std::uint32_t steps = 0;
    double gain = 0;                   // reduction of the squared error of the volume
    std::span<const std::byte> bytes;  // in the scratch
  };
  /// Encodes steps until the plane ends after at least `plane_bytes`, or until `most_bytes`, or until `last_plane` is
  /// coded. The last step may exceed that limit by less than kMaxClusterBytes - kClusterEnd. Until the last call, no
  /// other block may use `scratch`.
  Encoded encode(std::size_t plane_bytes, std::size_t most_bytes, int last_plane, BlockScratch& scratch);
  /// Decodes the steps of consecutive clusters, or fewer if the bytes are exhausted or the block is exact.
  /// Returns the number of decoded steps.
  std::size_t decode(std::span<const CodedSteps> clusters, BlockScratch& scratch);
  /// Adds the coefficients, each at the middle of its possible values, to those of `bands`, which wrap at 32 bits.
  void write(const BlockBands& bands) const;
  /// Adds them to the transformed volume; the second function adds only the low band.
  void write(std::span<std::int32_t> bands, Extent extent) const { write(bands_in_volume(place_, bands, extent)); }
  void write_low(std::span<std::int32_t> bands, Extent extent) const;
  /// Adds the coefficients to a window of the samples that its level gives, except the low band.
  void write_split(const SplitWindow& window) const;
  /// Calls visit(at) for those of the cubes `first` to `first + steps - 1` that are not zero. `at` is the place of the
  /// cube in its band. The cubes after the last one are the first ones again.
  template <class Visit>
  void visit_known(std::size_t first, std::size_t steps, const Visit& visit) const {
    for (std::size_t i = 0; i < std::min(steps, cubes_.size()); ++i) {
      const std::size_t cube = (first + i) % cubes_.size();
      if (cubes_[cube].values >= 0) visit(band_place(shape_->cubes()[cube]));
    }
  }

 private:
  struct Cube {
    std::int16_t values = -1;  // index of the values in units of kCubeSize; -1 while all are zero
    std::uint8_t lowest = 0;   // last coded plane
  };
  template <class Side>
  void step(Side& side, std::uint8_t* sizes);
  void activate(std::size_t cube);
  [[nodiscard]] std::size_t cube_context(const BlockShape::Cube& cube) const;
  [[nodiscard]] Extent band_place(const BlockShape::Cube& cube) const;
  void fill_sizes(std::vector<std::uint8_t>& sizes) const;
  void write(std::size_t cube, const BlockBands& bands) const;

  BlockPlace place_;
  std::shared_ptr<const BlockShape> shape_;
  std::vector<Cube> cubes_;
  std::vector<std::uint8_t> active_;   // by BlockShape::Cube::flag: 1 if the cube is not zero
  std::vector<std::uint32_t> values_;  // magnitude, and the sign in the highest bit; encoder: of all cubes; decoder: of
                                       // those that are not zero
  std::vector<double> errors_;         // encoder: squared error of each cube after its last coded plane
  std::vector<std::uint32_t> tops_;    // encoder: bits that any magnitude of the cube has
  PlaneModels models_;
  int plane_ = -1;
  std::size_t cube_ = 0;
  bool fresh_ = true;  // no step was encoded
};

}  // namespace gs::qnv::values
