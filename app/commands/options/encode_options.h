#pragma once

#include "app/commands/options/options.h"

#include <span>

/// Options for encoding and export, and for volumes without a header.
namespace gs::app {

/// Returns the rows of these options, which option_rows() includes.
[[nodiscard]] std::span<const OptionRow> encode_option_rows();

}  // namespace gs::app
