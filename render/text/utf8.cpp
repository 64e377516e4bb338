#include "render/text/utf8.h"

#include <cstddef>
#include <cstdint>

namespace gs::render {
namespace {

constexpr char32_t kReplacement = 0xFFFD;

/// Properties of a first byte: number of following bytes, and range of the second byte (Unicode table 3-7).
struct Lead {
  int follow = -1;  // -1 means that no character begins with this byte
  std::uint8_t lowest = 0x80, highest = 0xBF;
};

Lead lead(std::uint8_t byte) {
  if (byte < 0x80) return {0};
  if (byte < 0xC2) return {};
  if (byte < 0xE0) return {1};
  if (byte < 0xF0)
    return {2, static_cast<std::uint8_t>(byte == 0xE0 ? 0xA0 : 0x80),
            static_cast<std::uint8_t>(byte == 0xED ? 0x9F : 0xBF)};
  if (byte < 0xF5)
    return {3, static_cast<std::uint8_t>(byte == 0xF0 ? 0x90 : 0x80),
            static_cast<std::uint8_t>(byte == 0xF4 ? 0x8F : 0xBF)};
  return {};
}

}  // namespace

std::u32string characters_of(std::string_view text) {
  std::u32string characters;
  characters.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<std::uint8_t>(text[i++]);
    const Lead kind = lead(first);
    char32_t value = kind.follow == 0   ? first
                     : kind.follow == 1 ? first & 0x1F
                     : kind.follow == 2 ? first & 0x0F
                                        : first & 0x07;
    int left = kind.follow;
    for (; left > 0 && i < text.size(); --left) {
      const auto byte = static_cast<std::uint8_t>(text[i]);
      const bool second = left == kind.follow;
      if (byte < (second ? kind.lowest : 0x80) || byte > (second ? kind.highest : 0xBF)) break;
      value = value << 6 | (byte & 0x3F);
      ++i;
    }
    characters.push_back(left == 0 ? value : kReplacement);
  }
  return characters;
}

}  // namespace gs::render
