#pragma once

#include "qnv/codecs/values/block.h"
#include "qnv/codecs/values/block_places.h"

#include <cstdint>
#include <vector>

namespace gs::qnv::values {

/// Coefficients of one block outside of a volume. Each thread reuses one.
class BandBuffer {
 public:
  /// Returns the coefficients, with the parts of the last block.
  [[nodiscard]] const BlockBands& bands() const { return bands_; }
  /// Sets all coefficients to 0.
  void clear(const BlockPlace& place);
  /// Sets the coefficients to `a - b`, which wraps.
  void subtract(const BlockPlace& place, const BlockBands& a, const BlockBands& b);
  /// Adds the coefficients to `to`, or replaces those there.
  void add_to(const BlockPlace& place, const BlockBands& to) const;
  void copy_to(const BlockPlace& place, const BlockBands& to) const;

 private:
  void prepare();
  std::vector<std::int32_t> values_;
  BlockBands bands_;
};

/// Copies the coefficients of a block.
void copy_bands(const BlockPlace& place, const BlockBands& from, const BlockBands& to);

}  // namespace gs::qnv::values
