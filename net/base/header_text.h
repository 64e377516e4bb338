#pragma once

#include <string_view>

namespace gs::net {

/// Removes the blanks around the value of an HTTP header, or around an element of a list in it (RFC 9110 5.6.3).
[[nodiscard]] inline std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

}  // namespace gs::net
