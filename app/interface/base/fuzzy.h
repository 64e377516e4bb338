#pragma once

#include <optional>
#include <string_view>

namespace gs::app {

/// Scores how well `text` matches a query; higher is better. Each typed word must occur in `text`, as a substring or as
/// letters in the same order; case is ignored. Returns nullopt if it does not match. An empty query matches everything
/// equally.
[[nodiscard]] std::optional<int> fuzzy_score(std::string_view text, std::string_view typed);

}  // namespace gs::app
