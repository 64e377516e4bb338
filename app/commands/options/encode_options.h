#pragma once

#include "app/commands/options/options.h"

#include <span>

/// Options for encoding and exporting, and for volumes without a header.
namespace gs::app {

/// Returns these rows of option_rows().
[[nodiscard]] std::span<const OptionRow> encode_option_rows();

}  // namespace gs::app
