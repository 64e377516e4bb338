#pragma once

#include "app/commands/options/options.h"

#include <span>

/// Options of what is encoded and exported, and of volumes without a header.
namespace gs::app {

/// A part of option_rows().
[[nodiscard]] std::span<const OptionRow> encode_option_rows();

}  // namespace gs::app
