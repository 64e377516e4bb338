#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace gs::app {

/// Bytes as text; nothing is checked, nothing copied.
[[nodiscard]] inline std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// ASCII letters in lower case; other bytes as they are.
[[nodiscard]] inline std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

/// The last part of a path.
[[nodiscard]] inline std::string file_name(const std::string& path) { return path.substr(path.rfind('/') + 1); }

/// `text` cut to about `length` bytes at a character's edge, control characters made blanks: worlds name things as they
/// like.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t length);

/// "1.5 MB".
[[nodiscard]] std::string readable_size(std::uint64_t bytes);
/// "1.4 of 2.3 MB", "45.2 kB of 2.3 MB".
[[nodiscard]] std::string readable_part(std::uint64_t bytes, std::uint64_t of);

}  // namespace gs::app
