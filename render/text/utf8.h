#pragma once

#include <string>
#include <string_view>

namespace gs::render {

/// Decodes UTF-8. Each maximal subpart of an invalid sequence becomes one U+FFFD (Unicode 3.9, "substitution of maximal
/// subparts"). Never returns more characters than there are bytes.
[[nodiscard]] std::u32string characters_of(std::string_view text);

}  // namespace gs::render
