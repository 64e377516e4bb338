#pragma once

#include <cstdint>
#include <optional>

namespace gs::app {

/// Draws a list of rates in bits/s, with `rate` selected; 0 means unlimited. Returns the user's choice; nullopt if the
/// user chose nothing in this frame.
[[nodiscard]] std::optional<std::uint64_t> rate_choice(const char* id, std::uint64_t rate, float width);

}  // namespace gs::app
