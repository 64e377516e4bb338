#pragma once

#include "app/base/read_file.h"
#include "app/formats/datasets/arrays/array_file.h"

#include <string>
#include <string_view>
#include <variant>

namespace gs::app {

/// Loads the module with libraries of scientific formats, unless it is loaded. It lies in lib/ghostspace beside the
/// folder of the program, or in that folder. Returns a message on failure. A process that confines itself must call
/// this before. Any thread.
[[nodiscard]] std::variant<const DatasetModule*, std::string> dataset_module();

/// Opens a file with a reader of the module. Returns a message on failure.
[[nodiscard]] ArrayFileResult open_with_module(std::string_view reader, const SharedBytes& content,
                                               std::size_t cache_bytes);

}  // namespace gs::app
