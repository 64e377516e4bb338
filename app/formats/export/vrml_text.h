#pragma once

#include "app/formats/common/upright.h"
#include "qnv/base/description.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

namespace gs::app {

/// Appends a number that round-trips bit for bit. Writes 0 for non-finite values.
inline void append_number(std::string& to, float value) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), std::isfinite(value) ? value : 0.0f);
  to.append(digits.data(), end.ptr);
}

/// Appends text in quotes (VRML97 5.12). Replaces control characters by blanks.
inline void append_quoted(std::string& to, std::string_view text) {
  to += '"';
  for (const char c : text) {
    if (c == '"' || c == '\\') to += '\\';
    to += static_cast<unsigned char>(c) < 32 ? ' ' : c;
  }
  to += '"';
}

/// Returns a line of text with a Viewpoint that shows the whole box from the front.
[[nodiscard]] std::string front_viewpoint(const Box& box, const Upright& upright);

}  // namespace gs::app
