#pragma once

#include <optional>
#include <string_view>

namespace gs::app {

/// Scores how well `text` matches the query `typed`; higher is better. Each word of the query must occur in `text`, as
/// a substring or as letters in the same order; case is ignored. Returns nullopt if a word does not occur. An empty
/// query matches every text equally.
[[nodiscard]] std::optional<int> fuzzy_score(std::string_view text, std::string_view typed);

}  // namespace gs::app
