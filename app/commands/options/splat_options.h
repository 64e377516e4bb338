#pragma once

#include "app/commands/options/options.h"

#include <span>

/// Options that edit Gaussian splats.
namespace gs::app {

/// Returns the rows of these options, which option_rows() includes.
[[nodiscard]] std::span<const OptionRow> splat_option_rows();

}  // namespace gs::app
