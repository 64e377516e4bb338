#include "vrml/json/list_reader.h"

#include <cstdint>

// Strings of JSON (RFC 8259, 7).
namespace gs::vrml::json {
namespace {

// Reads four hexadecimal digits. Returns false if there are none.
bool read_unit(std::string_view text, std::uint32_t& unit) {
  if (text.size() < 4) return false;
  unit = 0;
  for (const char c : text.substr(0, 4)) {
    const int digit = c >= '0' && c <= '9'   ? c - '0'
                      : c >= 'a' && c <= 'f' ? c - 'a' + 10
                      : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                             : -1;
    if (digit < 0) return false;
    unit = unit * 16 + static_cast<std::uint32_t>(digit);
  }
  return true;
}

void append_character(std::string& out, std::uint32_t character) {
  if (character == 0 || (character >= 0xd800 && character < 0xe000)) character = 0xfffd;
  const auto add = [&](std::uint32_t byte) { out += static_cast<char>(byte); };
  if (character < 0x80) return add(character);
  if (character < 0x800) {
    add(0xc0 | character >> 6);
  } else {
    if (character < 0x10000) {
      add(0xe0 | character >> 12);
    } else {
      add(0xf0 | character >> 18);
      add(0x80 | (character >> 12 & 0x3f));
    }
    add(0x80 | (character >> 6 & 0x3f));
  }
  add(0x80 | (character & 0x3f));
}

// Decodes `\uXXXX` at the start of `text`, with the second half of a pair. Returns the count of bytes.
std::size_t append_unit(std::string_view text, std::string& out) {
  std::uint32_t unit = 0, low = 0;
  if (!read_unit(text.substr(2), unit)) {
    out += text.substr(0, 2);
    return 2;
  }
  const bool is_pair = unit >= 0xd800 && unit < 0xdc00 && text.size() >= 12 && text[6] == '\\' && text[7] == 'u' &&
                       read_unit(text.substr(8), low) && low >= 0xdc00 && low < 0xe000;
  append_character(out, is_pair ? 0x10000 + ((unit - 0xd800) << 10) + (low - 0xdc00) : unit);
  return is_pair ? 12 : 6;
}

}  // namespace

bool is_ascii(std::string_view text) {
  unsigned char bits = 0;
  for (const char c : text) bits |= static_cast<unsigned char>(c);
  return bits < 0x80;
}

std::string decode_string(std::string_view raw, bool has_escapes, bool& was_latin1) {
  std::string text = vrml::decode_string(raw, false, was_latin1);
  if (!has_escapes) return text;
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] != '\\' || i + 1 == text.size()) {
      out += text[i++];
      continue;
    }
    const char c = text[i + 1];
    if (c == 'u') {
      i += append_unit(std::string_view(text).substr(i), out);
      continue;
    }
    constexpr std::string_view kEscapes = "\"\\/bfnrt", kMeanings = "\"\\/\b\f\n\r\t";
    const std::size_t found = kEscapes.find(c);
    if (found == std::string_view::npos) out += '\\';
    out += found == std::string_view::npos ? c : kMeanings[found];
    i += 2;
  }
  return out;
}

}  // namespace gs::vrml::json
