#pragma once

#include <string>
#include <string_view>

namespace gs::render {

/// Decodes UTF-8. Replaces each maximal subpart of an invalid sequence by U+FFFD (Unicode 3.9, "substitution of maximal
/// subparts"). Never returns more characters than `text` has bytes.
[[nodiscard]] std::u32string characters_of(std::string_view text);

}  // namespace gs::render
