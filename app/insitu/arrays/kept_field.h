#pragma once

#include "app/insitu/arrays/grid_parts.h"
#include "app/insitu/arrays/ranks.h"
#include "app/insitu/arrays/step_plan.h"
#include "app/insitu/bricks/pyramid.h"
#include "app/insitu/bricks/quantise.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace gs::app::insitu {

/// Bound of the errors of values.
struct ErrorBound {
  double error = 0;           // in the unit of the values; 0 means that `relative_error` applies
  double relative_error = 0;  // share of the range of the values

  [[nodiscard]] double of(const FiniteRange& range) const {
    if (error > 0) return error;
    return range.empty() ? 0 : relative_error * (static_cast<double>(range.high) - static_cast<double>(range.low));
  }
};

/// Copy of the values of one field that a rank passed in a step, for later requests of viewers. Values have 16 bits if
/// the error bound allows it, else they are floats.
class KeptField {
 public:
  /// Copies the field of a plan from the blocks. `expected` is the range of the previous step. Reads the blocks once if
  /// that range suffices, else up to three times. Reuses the memory of this object.
  void keep(std::span<const BlockView> blocks, const StepPlan& plan, const ErrorBound& bound,
            const FiniteRange& expected);
  /// Returns the range of the values of this rank.
  [[nodiscard]] const FiniteRange& range() const { return range_; }
  /// Returns the maximum difference between kept and passed values.
  [[nodiscard]] float error() const;
  [[nodiscard]] std::uint64_t bytes() const;
  [[nodiscard]] const Pyramid& pyramid() const { return pyramid_; }
  [[nodiscard]] std::uint64_t serial() const { return serial_; }

  /// Copies layers of a chunk to `values`, from the layer `first` on; x varies fastest. Stores NaN for values of other
  /// ranks.
  void read(const Chunk& chunk, std::uint32_t first, std::span<float> values) const;
  /// Appends this rank's values of a chunk to a message.
  void pack(const Chunk& chunk, std::uint32_t number, std::vector<std::byte>& message) const;

 private:
  struct Part {
    GridBox box;
    std::vector<std::int16_t> codes;  // if `exact_` is false
    std::vector<float> values;        // if `exact_` is true
  };
  struct Piece;
  [[nodiscard]] bool copy(std::span<const GridPart> parts, const CodeScale& scale);
  template <class Work>
  void each_piece(const Chunk& chunk, const Work& work) const;

  std::vector<Part> parts_;
  Pyramid pyramid_;
  CodeScale scale_;
  FiniteRange range_;
  bool exact_ = false;
  std::uint64_t serial_ = 0;
};

/// Collects chunks of the kept fields of all ranks on rank 0. Collective; all ranks pass equal lists. Entry i of
/// `kept` belongs to chunk i, or is null: such a chunk has no values. If a rank lacks memory, no chunk has values.
/// `deliver` must not throw for a chunk without values. Returns false if the communication failed.
[[nodiscard]] bool gather_chunks(Ranks& ranks, std::span<const KeptField* const> kept, std::span<const Chunk> chunks,
                                 const std::function<void(std::size_t number, std::vector<float> values)>& deliver);

}  // namespace gs::app::insitu
