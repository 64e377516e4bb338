#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// The bytes of a file that another one names, or nothing when it cannot be had. The name is as written
/// in that file: the callee resolves it, and decides what may be read.
using ReadFile = std::function<std::optional<std::vector<std::byte>>(const std::string& name)>;

}  // namespace gs::app
