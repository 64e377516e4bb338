#include "vrml/xml/text_decoder.h"

#include "base/text.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace gs::vrml::xml {
namespace {

// Maximum length of an XML declaration.
constexpr std::size_t kMaxDeclaration = 1024;

// Characters of the bytes 0x80 to 0x9f in windows-1252.
constexpr std::array<std::uint16_t, 32> kWindows1252 = {0x20ac, 0x81,   0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021,
                                                        0x02c6, 0x2030, 0x0160, 0x2039, 0x0152, 0x8d,   0x017d, 0x8f,
                                                        0x90,   0x2018, 0x2019, 0x201c, 0x201d, 0x2022, 0x2013, 0x2014,
                                                        0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0x9d,   0x017e, 0x0178};

unsigned byte_at(std::string_view text, std::size_t i) { return static_cast<unsigned char>(text[i]); }

bool is_ascii(std::string_view text) {
  while (text.size() >= 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, text.data(), 8);
    if (word & 0x8080808080808080) return false;
    text.remove_prefix(8);
  }
  return std::none_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; });
}

// Returns the length of the character at the start of `text`, or 0 if it is not valid UTF-8.
std::size_t character_length(std::string_view text) {
  const unsigned first = byte_at(text, 0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte_at(text, i) & 0xc0) != 0x80) return 0;
  const unsigned second = byte_at(text, 1);
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) || (first == 0xf0 && second < 0x90) ||
      (first == 0xf4 && second > 0x8f))
    return 0;
  return length;
}

}  // namespace

bool is_utf8(std::string_view text) {
  if (is_ascii(text)) return true;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

void append_utf8(std::string& out, std::uint32_t character) {
  if (character > 0x10ffff || (character >= 0xd800 && character < 0xe000)) character = 0xfffd;
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

void append_latin1(std::string& out, std::string_view text) {
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    append_utf8(out, byte >= 0x80 && byte < 0xa0 ? kWindows1252[byte - 0x80] : byte);
  }
}

// Reads the encoding of an XML declaration.
void TextDecoder::read_declaration(std::string_view declaration) {
  const std::size_t at = declaration.find("encoding");
  const std::size_t quote = at == std::string_view::npos ? at : declaration.find_first_of("\"'", at);
  if (quote == std::string_view::npos) return;
  const std::size_t end = declaration.find(declaration[quote], quote + 1);
  if (end == std::string_view::npos) return;
  const std::string name = lower_case(declaration.substr(quote + 1, end - quote - 1));
  static constexpr std::pair<std::string_view, Encoding> kNames[] = {
      {"utf-8", Encoding::utf8},          {"utf8", Encoding::utf8},     {"us-ascii", Encoding::utf8},
      {"ascii", Encoding::utf8},          {"utf-16", Encoding::utf8},   {"iso-8859-1", Encoding::latin1},
      {"iso8859-1", Encoding::latin1},    {"latin1", Encoding::latin1}, {"latin-1", Encoding::latin1},
      {"windows-1252", Encoding::latin1}, {"cp1252", Encoding::latin1}, {"iso-8859-15", Encoding::latin1}};
  const auto found = value_named(kNames, name);
  encoding_ = found.value_or(Encoding::utf8);
  if (!found) unknown_ = name.substr(0, 40);
}

// Detects the encoding, and removes the byte order mark from `bytes`. Returns false if more bytes are needed.
bool TextDecoder::detect(std::string_view& bytes, bool last) {
  if (bytes.size() < 4 && !last) return false;
  const std::string_view start = bytes.substr(0, kMaxDeclaration);
  std::size_t mark = 0;
  if (start.starts_with("\xef\xbb\xbf")) {
    mark = 3;
  } else if (start.starts_with("\xff\xfe") || start.starts_with(std::string_view("<\0", 2))) {
    encoding_ = Encoding::utf16le;
    mark = start.starts_with("\xff\xfe") ? 2 : 0;
  } else if (start.starts_with("\xfe\xff") || start.starts_with(std::string_view("\0<", 2))) {
    encoding_ = Encoding::utf16be;
    mark = start.starts_with("\xfe\xff") ? 2 : 0;
  } else {
    const bool may_continue = start.size() < kMaxDeclaration && !last;
    const std::size_t first = std::min(start.find_first_not_of(" \t\r\n"), start.size());
    const std::string_view head = start.substr(first, 5);
    const bool declares = std::string_view("<?xml").starts_with(head);
    const std::size_t end = start.find("?>", first);
    if (declares && end == std::string_view::npos && may_continue) return false;
    if (declares) read_declaration(start.substr(first, end == std::string_view::npos ? end : end - first));
  }
  bytes.remove_prefix(mark);
  return true;
}

// Appends UTF-16 as UTF-8. Keeps the bytes of an incomplete character.
void TextDecoder::append_utf16(std::string_view bytes, bool last) {
  std::string joined;
  if (!odd_.empty()) {
    joined = std::exchange(odd_, {});
    joined += bytes;
    bytes = joined;
  }
  const unsigned high = encoding_ == Encoding::utf16le ? 1 : 0;
  const auto unit_at = [&](std::size_t i) { return byte_at(bytes, i + high) << 8 | byte_at(bytes, i + 1 - high); };
  std::size_t i = 0;
  for (; i + 2 <= bytes.size(); i += 2) {
    const unsigned unit = unit_at(i);
    if (unit >= 0xd800 && unit < 0xdc00) {
      if (i + 4 > bytes.size() && !last) break;
      const unsigned low = i + 4 <= bytes.size() ? unit_at(i + 2) : 0;
      if (low >= 0xdc00 && low < 0xe000) {
        append_utf8(out_, 0x10000 + ((unit - 0xd800) << 10) + (low - 0xdc00));
        i += 2;
        continue;
      }
    }
    append_utf8(out_, unit);
  }
  if (!last) odd_ = bytes.substr(i);
}

std::string_view TextDecoder::decode(std::string_view bytes, bool last) {
  out_.clear();
  if (!detected_) {
    if (!start_.empty()) {
      start_ += bytes;
      bytes = start_;
    }
    detected_ = detect(bytes, last);
    if (!detected_) {
      if (start_.empty()) start_ = bytes;
      return {};
    }
  }
  switch (encoding_) {
    case Encoding::utf8:
      return bytes;
    case Encoding::latin1:
      if (is_ascii(bytes)) return bytes;
      append_latin1(out_, bytes);
      break;
    default:
      append_utf16(bytes, last);
      break;
  }
  return out_;
}

}  // namespace gs::vrml::xml
