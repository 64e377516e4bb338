#include "vrml/syntax/tokens/lexer.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>

namespace gs::vrml {
namespace {

enum LexicalClass : std::uint8_t { word_byte, blank, delimiter, unused };

constexpr std::array<std::uint8_t, 256> kLexicalClass = [] {
  std::array<std::uint8_t, 256> table{};
  for (int c = 0; c < 0x20; ++c) table[c] = unused;
  table[0x7f] = unused;
  for (const char c : {' ', ',', '\t', '\n', '\r', '\f', '\v'}) table[static_cast<unsigned char>(c)] = blank;
  for (const char c : {'"', '#', '[', ']', '{', '}'}) table[static_cast<unsigned char>(c)] = delimiter;
  table['\''] = table['\\'] = unused;
  return table;
}();

std::uint8_t lexical_class(char c) { return kLexicalClass[static_cast<unsigned char>(c)]; }

// Returns the length of the UTF-8 sequence at `p`. Returns 0 if it is invalid; overlong forms and surrogates are
// invalid, too.
std::size_t utf8_length(const unsigned char* p, const unsigned char* end) {
  const auto follows = [&](std::size_t i, unsigned low = 0x80, unsigned high = 0xbf) {
    return p + i < end && p[i] >= low && p[i] <= high;
  };
  if (*p < 0x80) return 1;
  if (*p >= 0xc2 && *p <= 0xdf) return follows(1) ? 2 : 0;
  if (*p >= 0xe0 && *p <= 0xef)
    return follows(1, *p == 0xe0 ? 0xa0 : 0x80, *p == 0xed ? 0x9f : 0xbf) && follows(2) ? 3 : 0;
  if (*p >= 0xf0 && *p <= 0xf4)
    return follows(1, *p == 0xf0 ? 0x90 : 0x80, *p == 0xf4 ? 0x8f : 0xbf) && follows(2) && follows(3) ? 4 : 0;
  return 0;
}

// Moves `p` past spaces. Most blanks are indentations.
void pass_spaces(const char*& p, const char* end) {
  constexpr std::uint64_t kSpaces = 0x2020202020202020;
  for (std::uint64_t word = 0; end - p >= 8; p += 8) {
    std::memcpy(&word, p, 8);
    if (word != kSpaces) break;
  }
  while (p != end && *p == ' ') ++p;
}

bool is_utf8(std::string_view text) {
  const auto* p = reinterpret_cast<const unsigned char*>(text.data());
  const auto* end = p + text.size();
  while (p < end) {
    const std::size_t length = utf8_length(p, end);
    if (length == 0) return false;
    p += length;
  }
  return true;
}

}  // namespace

void Lexer::set_window(const char* begin, const char* end, bool last) {
  if (begin_) line_start_ -= next_ - begin_;
  begin_ = next_ = begin;
  end_ = end;
  last_ = last;
}

void Lexer::go_back(const Position& position) {
  next_ = position.next;
  line_ = position.line;
  line_start_ = position.line_start;
}

void Lexer::advance(const char* next, std::size_t lines, const char* line_start) {
  next_ = next;
  line_ += static_cast<std::uint32_t>(lines);
  if (line_start) line_start_ = line_start - begin_;
}

SourceLocation Lexer::location_of(const char* p) const {
  return {line_, static_cast<std::uint32_t>(p - begin_ - line_start_ + 1)};
}

void Lexer::new_line(const char* line_start) {
  ++line_;
  line_start_ = line_start - begin_;
}

Lexer::Blank Lexer::skip_blanks() {
  while (next_ != end_) {
    const char c = *next_;
    if (c == '\n') {
      new_line(++next_);
      pass_spaces(next_, end_);
    } else if (c == '\r') {
      if (next_ + 1 == end_ && !last_) return Blank::need_more;
      ++next_;
      if (next_ == end_ || *next_ != '\n') new_line(next_);
    } else if (c == '#') {
      const char* p = next_;
      while (p != end_ && *p != '\n' && *p != '\r') ++p;
      if (p == end_ && !last_) return Blank::need_more;
      next_ = p;
    } else if (lexical_class(c) == blank) {
      ++next_;
      pass_spaces(next_, end_);
    } else if (c == '/' && block_comments_) {
      if (next_ + 1 == end_ && !last_) return Blank::need_more;
      if (!begins_block_comment(next_)) return Blank::passed;
      if (!skip_block_comment()) return Blank::need_more;
    } else {
      return Blank::passed;
    }
  }
  return last_ ? Blank::end : Blank::need_more;
}

// Skips a comment that begins with /*. Returns false if its end is not in the window yet. A comment without an end
// extends to the end of the text.
bool Lexer::skip_block_comment() {
  const std::string_view rest(next_ + 2, static_cast<std::size_t>(end_ - next_ - 2));
  const std::size_t length = rest.find("*/");
  if (length == std::string_view::npos && !last_) return false;
  const char* const comment_end = length == std::string_view::npos ? end_ : rest.data() + length + 2;
  for (const char* p = next_; p != comment_end; ++p)
    if (*p == '\n' || (*p == '\r' && (p + 1 == end_ || p[1] != '\n'))) new_line(p + 1);
  next_ = comment_end;
  return true;
}

Token Lexer::string_token() {
  Token token{TokenKind::string, {}, location(), false};
  const char* const first = next_ + 1;
  const char* p = first;
  for (;;) {
    if (p == end_) break;
    const char c = *p;
    if (c == '"') {
      token.text = {first, static_cast<std::size_t>(p - first)};
      next_ = p + 1;
      return token;
    }
    if (c == '\\') {
      token.has_escapes = true;
      if (++p == end_) break;
    }
    if (*p == '\n' || (*p == '\r' && (p + 1 == end_ || p[1] != '\n'))) new_line(p + 1);
    ++p;
  }
  token.text = {first, static_cast<std::size_t>(end_ - first)};
  token.kind = last_ ? TokenKind::unterminated_string : TokenKind::need_more;
  if (last_) next_ = end_;
  return token;
}

char Lexer::peek() { return skip_blanks() == Blank::passed ? *next_ : '\0'; }

Token Lexer::next() {
  switch (skip_blanks()) {
    case Blank::need_more:
      return {TokenKind::need_more, {}, location()};
    case Blank::end:
      return {TokenKind::end, {}, location()};
    case Blank::passed:
      break;
  }
  const auto single = [&](TokenKind kind) {
    Token token{kind, {next_, 1}, location()};
    ++next_;
    return token;
  };
  switch (*next_) {
    case '{':
      return single(TokenKind::open_brace);
    case '}':
      return single(TokenKind::close_brace);
    case '[':
      return single(TokenKind::open_bracket);
    case ']':
      return single(TokenKind::close_bracket);
    case '"':
      return string_token();
    default:
      break;
  }
  if (lexical_class(*next_) == unused) return single(TokenKind::bad);
  const char* p = next_;
  for (; p != end_; ++p) {
    if (lexical_class(*p) == word_byte && !begins_block_comment(p)) continue;
    // In NaN and infinity as some programs print them (1.#QNAN, -1.#IND), the `#` does not start a comment.
    if (*p != '#' || p == next_ || p[-1] != '.') break;
    if (p + 1 == end_) {
      if (!last_) p = end_;
      break;
    }
    if (p[1] != 'Q' && p[1] != 'I' && p[1] != 'S') break;
  }
  if (p == end_ && !last_) return {TokenKind::need_more, {}, location()};
  Token token{TokenKind::word, {next_, static_cast<std::size_t>(p - next_)}, location()};
  next_ = p;
  return token;
}

std::string decode_string(std::string_view raw, bool has_escapes, bool& was_latin1) {
  std::string text;
  if (has_escapes) {
    text.reserve(raw.size());
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (raw[i] == '\\' && i + 1 < raw.size() && (raw[i + 1] == '"' || raw[i + 1] == '\\')) ++i;
      text += raw[i];
    }
  } else {
    text = raw;
  }
  if (is_utf8(text)) return text;
  was_latin1 = true;
  std::string converted;
  converted.reserve(text.size() * 2);
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      converted += c;
    } else {
      converted += static_cast<char>(0xc0 | byte >> 6);
      converted += static_cast<char>(0x80 | (byte & 0x3f));
    }
  }
  return converted;
}

bool looks_like_number(std::string_view word) {
  const char c = word.empty() ? ' ' : word.front();
  return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.';
}

bool is_id(std::string_view word) {
  if (word.empty() || looks_like_number(word) || word.front() == ':') return false;
  for (const char c : word)
    if (lexical_class(c) != word_byte || c == '.') return false;
  return true;
}

int reserved_word(std::string_view word, Language language) {
  // Words of both languages, of VRML97 only, and of X3D only.
  constexpr std::string_view kWords[] = {
      "DEF",        "EXTERNPROTO", "FALSE",   "IS",       "NULL",         "PROTO",     "ROUTE",      "TO",
      "TRUE",       "USE",         "eventIn", "eventOut", "exposedField", "field",     "AS",         "COMPONENT",
      "EXPORT",     "IMPORT",      "META",    "PROFILE",  "UNIT",         "inputOnly", "outputOnly", "initializeOnly",
      "inputOutput"};
  constexpr std::ptrdiff_t kShared = 10, kVrml97 = 14;
  const std::ptrdiff_t found = std::find(std::begin(kWords), std::end(kWords), word) - std::begin(kWords);
  if (found == static_cast<std::ptrdiff_t>(std::size(kWords))) return -1;
  const bool reserved = found < kShared || (found < kVrml97) == (language == Language::vrml97);
  return reserved ? static_cast<int>(found) : -1;
}

}  // namespace gs::vrml
