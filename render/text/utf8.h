#pragma once

#include <string>
#include <string_view>

namespace gs::render {

/// The characters of UTF-8 text. What is no UTF-8 becomes U+FFFD, one for each longest beginning of a sequence that
/// could have become one (Unicode 3.9, "substitution of maximal subparts"): never fewer characters than a reader
/// would see, never more than there are bytes.
[[nodiscard]] std::u32string characters_of(std::string_view text);

}  // namespace gs::render
