#include "vrml/printing/value_text.h"

namespace gs::vrml {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

bool is_continuation(std::string_view text, std::size_t at) {
  return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80;
}

// Returns the length of the UTF-8 sequence at the start of a text; 0 if it is broken. The first byte is not ASCII.
std::size_t sequence_length(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if (!is_continuation(text, i)) return 0;
  const auto second = static_cast<unsigned char>(text[1]);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool too_high = (first == 0xED && second >= 0xA0) || (first == 0xF4 && second >= 0x90);
  return overlong || too_high ? 0 : length;
}

bool is_non_character(std::string_view sequence) {  // U+FFFE, U+FFFF (XML 1.0 2.2)
  return sequence == "\xEF\xBF\xBE" || sequence == "\xEF\xBF\xBF";
}

bool is_xml_control(char c) { return static_cast<unsigned char>(c) < 32 && c != '\t' && c != '\n' && c != '\r'; }

std::string_view xml_escape(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '\'':
      return "&apos;";
    case '\n':
      return "&#10;";
    case '\r':
      return "&#13;";
    case '\t':
      return "&#9;";
    default:
      return {};
  }
}

void append_json_escape(std::string& out, char c) {
  constexpr std::string_view kLetters = "btnvfr";  // U+0008 to U+000D; JSON has no \v
  out += '\\';
  if (c == '"' || c == '\\') {
    out += c;
  } else if (c >= '\b' && c <= '\r' && c != '\v') {
    out += kLetters[static_cast<std::size_t>(c - '\b')];
  } else {
    constexpr std::string_view kDigits = "0123456789abcdef";
    out += "u00";
    out += kDigits[static_cast<unsigned char>(c) >> 4];
    out += kDigits[static_cast<unsigned char>(c) & 15];
  }
}

// Calls `ascii` for each ASCII character and `sequence` for each sequence of other bytes, which is empty if broken.
template <class Ascii, class Sequence>
void visit_characters(std::string_view text, const Ascii& ascii, const Sequence& sequence) {
  for (std::size_t i = 0; i < text.size();) {
    if (static_cast<unsigned char>(text[i]) < 0x80) {
      ascii(text[i++]);
      continue;
    }
    const std::size_t length = sequence_length(text.substr(i));
    sequence(text.substr(i, length));
    i += length == 0 ? 1 : length;
  }
}

}  // namespace

void append_quoted(std::string& out, std::string_view text) {
  out += '"';
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  out += '"';
}

void append_unquoted(std::string& out, std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char next = i + 1 < text.size() ? text[i + 1] : '\0';
    if (text[i] == '\\' && (next == '"' || next == '\\')) out += '\\';
    out += text[i];
  }
}

void append_xml(std::string& out, std::string_view text) {
  visit_characters(
      text,
      [&](char c) {
        if (const std::string_view escape = xml_escape(c); !escape.empty())
          out += escape;
        else if (!is_xml_control(c))
          out += c;
      },
      [&](std::string_view sequence) {
        if (!is_non_character(sequence)) out += sequence.empty() ? kReplacement : sequence;
      });
}

bool is_xml_text(std::string_view text) {
  bool good = true;
  visit_characters(
      text, [&](char c) { good = good && !is_xml_control(c); },
      [&](std::string_view sequence) { good = good && !sequence.empty() && !is_non_character(sequence); });
  return good;
}

void append_json(std::string& out, std::string_view text) {
  out += '"';
  visit_characters(
      text,
      [&](char c) {
        if (static_cast<unsigned char>(c) < 32 || c == '"' || c == '\\')
          append_json_escape(out, c);
        else
          out += c;
      },
      [&](std::string_view sequence) { out += sequence.empty() ? kReplacement : sequence; });
  out += '"';
}

}  // namespace gs::vrml
