#pragma once

#include "base/budget.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>

namespace gs::app {

struct SplatModel;

/// File of Gaussian splats that is read in ranges, so that it may exceed memory. The bytes of the file must outlive it.
struct SplatRows {
  std::size_t count = 0;        // number of complete splats in the file
  std::uint64_t announced = 0;  // number of splats that the file claims to have
  std::size_t start = 0;        // offset of the rows that readers of a range reach last
  std::size_t row_bytes = 0;    // size of such a row
  /// Reads `count` splats from index `first` on into an empty model. Returns a message if the budget is exceeded. The
  /// range must be in the file. Any thread.
  std::function<std::optional<std::string>(std::size_t first, std::size_t count, const WorldBudget& budget,
                                           SplatModel& model)>
      read;
};
/// Opened file, or an error message.
using OpenedSplatRows = std::variant<SplatRows, std::string>;

}  // namespace gs::app
