#pragma once

#include <cstdint>
#include <optional>

namespace gs::app {

/// A list of rates, of which `rate` is chosen: bits a second; 0: any. The one that the user has chosen instead.
[[nodiscard]] std::optional<std::uint64_t> rate_choice(const char* id, std::uint64_t rate, float width);

}  // namespace gs::app
