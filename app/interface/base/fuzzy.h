#pragma once

#include <optional>
#include <string_view>

namespace gs::app {

/// How well `text` fits what was typed: each word of it must stand somewhere in `text`, whole or as letters in the same
/// order, in letters of any case. Higher is better; nothing: it does not fit. Nothing typed fits everything alike.
[[nodiscard]] std::optional<int> fuzzy_score(std::string_view text, std::string_view typed);

}  // namespace gs::app
