#pragma once

#include "qnv/codecs/values/block_places.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace gs::qnv::values {

/// Cubes of a block, and the layout of its buffers. Blocks of equal size share one.
class BlockShape {
 public:
  struct Cube {
    std::uint8_t band = 0;
    std::array<std::uint8_t, 3> at{}, size{};  // position in cubes; size in coefficients
    std::uint32_t first = 0;                   // place of its first coefficient in PlaneSizes
    std::uint32_t flag = 0;                    // place in the flags of active cubes
    std::int32_t before = -1;                  // the flag of the same cube in the band before; -1 if there is none
  };
  struct Band {
    std::uint32_t row = 0, slice = 0;            // distances in PlaneSizes
    std::uint32_t flag_row = 0, flag_slice = 0;  // and in the flags
    std::array<std::uint8_t, 3> cubes{};
    std::uint16_t first_cube = 0;
    std::uint8_t highs = 0;
  };

  explicit BlockShape(const BlockPlace& place);
  /// Returns the shape of a block. Any thread may call it.
  [[nodiscard]] static std::shared_ptr<const BlockShape> of(const BlockPlace& place);

  [[nodiscard]] const std::vector<Cube>& cubes() const { return cubes_; }
  [[nodiscard]] const std::vector<Band>& bands() const { return bands_; }
  /// Bytes of a buffer with the size of each coefficient, with borders of zeros around each part of a band.
  [[nodiscard]] std::size_t size_bytes() const { return size_bytes_; }
  /// Bytes of a buffer with a flag per cube, with borders of zeros.
  [[nodiscard]] std::size_t flag_bytes() const { return flag_bytes_; }

 private:
  [[nodiscard]] bool suits(const BlockPlace& place) const;

  std::array<BandPart, 8> parts_{};
  std::vector<Cube> cubes_;
  std::vector<Band> bands_;
  std::size_t size_bytes_ = 0, flag_bytes_ = 0;
};

}  // namespace gs::qnv::values
