#pragma once

#include "app/formats/common/upright.h"
#include "qnv/base/cloud.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

namespace gs::app {

/// Appends a number so that it reads back bit for bit; what is none becomes 0.
inline void append_number(std::string& to, float value) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), std::isfinite(value) ? value : 0.0f);
  to.append(digits.data(), end.ptr);
}

/// Appends text in quotes (VRML97 5.12); line ends become blanks.
inline void append_quoted(std::string& to, std::string_view text) {
  to += '"';
  for (const char c : text) {
    if (c == '"' || c == '\\') to += '\\';
    to += static_cast<unsigned char>(c) < 32 ? ' ' : c;
  }
  to += '"';
}

/// A Viewpoint that looks at the whole box from the front of what stands so, on a line of its own.
[[nodiscard]] std::string front_viewpoint(const qnv::Box& box, const Upright& upright);

}  // namespace gs::app
