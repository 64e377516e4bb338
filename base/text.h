#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs {

/// Returns the bytes of a text.
[[nodiscard]] inline std::vector<std::byte> copied_bytes(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// Computes the FNV-1a hash of a text, which does not depend on the machine. Not for untrusted keys of a table.
[[nodiscard]] constexpr std::uint64_t stable_hash(std::string_view text, std::uint64_t seed = 0) {
  std::uint64_t value = 0xcbf29ce484222325 ^ seed;
  for (const char c : text) value = (value ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return value;
}

/// Returns bytes as text, without checks or copies.
[[nodiscard]] inline std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Returns the value of a name in a table, or nullopt.
template <class Value, std::size_t size>
[[nodiscard]] std::optional<Value> value_named(const std::pair<std::string_view, Value> (&table)[size],
                                               std::string_view name) {
  for (const auto& [row_name, value] : table)
    if (row_name == name) return value;
  return std::nullopt;
}

/// Returns text with ASCII letters in lower case; other bytes do not change.
[[nodiscard]] inline std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

/// Returns the part of a path after the last slash.
[[nodiscard]] inline std::string file_name(const std::string& path) { return path.substr(path.rfind('/') + 1); }

/// Returns text cut to about `length` bytes at a character boundary. Replaces control characters by blanks, because
/// names in worlds are untrusted.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t length);

/// Returns a size such as "1.5 MB".
[[nodiscard]] std::string readable_size(std::uint64_t bytes);
/// Returns progress such as "1.4 of 2.3 MB" or "45.2 kB of 2.3 MB".
[[nodiscard]] std::string readable_part(std::uint64_t bytes, std::uint64_t of);

}  // namespace gs
