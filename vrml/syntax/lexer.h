#pragma once

#include "base/diagnostic.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace gs::vrml {

enum class TokenKind : std::uint8_t {
  need_more,  // the token may continue after the available bytes
  end,        // end of the text
  word,       // run of characters without delimiters: a keyword, an Id, a number, `node.event`
  string,     // text without its quotes, escapes still encoded
  open_brace,
  close_brace,
  open_bracket,
  close_bracket,
  unterminated_string,  // string that the end of the text truncates
  bad,                  // one byte that VRML97 does not allow
};

struct Token {
  TokenKind kind = TokenKind::end;
  std::string_view text;  // points into the lexer's buffer
  SourceLocation location;
  bool has_escapes = false;  // string: contains a backslash
};

/// Splits VRML97 text (Annex A.2) into tokens. Commas are blanks; comments extend to the end of the line; CR, LF and
/// CRLF end lines. Works on a window of the text. If a token reaches the end of a window that is not the last, the
/// result is need_more: the caller returns to a saved position and retries with a longer window.
class Lexer {
 public:
  /// Position inside the present window, for go_back().
  struct Position {
    const char* next;
    std::uint32_t line;
    std::ptrdiff_t line_start;  // offset in the window; negative if the line began before it
  };

  /// Sets the window. The text continues at the byte where the previous window was left. `last` means that the text
  /// ends with this window.
  void set_window(const char* begin, const char* end, bool last);

  [[nodiscard]] Token next();
  /// Skips blanks and comments and returns the next byte, or NUL if none is available.
  [[nodiscard]] char peek();

  [[nodiscard]] Position position() const { return {next_, line_, line_start_}; }
  void go_back(const Position& position);
  /// Returns the source location of the next byte.
  [[nodiscard]] SourceLocation location() const { return location_of(next_); }

  /// Access for bulk readers: the unread part of the window, and a way to report the bytes read.
  [[nodiscard]] const char* unread() const { return next_; }
  [[nodiscard]] const char* window_end() const { return end_; }
  [[nodiscard]] bool is_last_window() const { return last_; }
  void advance(const char* next, std::size_t lines, const char* line_start);

 private:
  enum class Blank : std::uint8_t { passed, need_more, end };
  Blank skip_blanks();
  Token string_token();
  void new_line(const char* line_start);
  [[nodiscard]] SourceLocation location_of(const char* p) const;

  const char* begin_ = nullptr;
  const char* next_ = nullptr;
  const char* end_ = nullptr;
  bool last_ = true;
  std::uint32_t line_ = 1;
  std::ptrdiff_t line_start_ = 0;
};

/// Decodes an SFString from the text between its quotes. `\"` and `\\` are unescaped; other backslashes stay, since old
/// files contain Windows paths. Bytes that are not UTF-8 are read as Latin-1, which sets `was_latin1`.
[[nodiscard]] std::string decode_string(std::string_view raw, bool has_escapes, bool& was_latin1);

/// Reports whether `word` starts like a number: with a digit, a sign or a point.
[[nodiscard]] bool looks_like_number(std::string_view word);

/// Reports whether `word` is an Id of Annex A.2.
[[nodiscard]] bool is_id(std::string_view word);

/// Returns the index of a reserved word of 4.3.1, which cannot be a name; -1 for other words.
[[nodiscard]] int reserved_word(std::string_view word);

}  // namespace gs::vrml
