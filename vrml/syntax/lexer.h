#pragma once

#include "vrml/scene/diagnostic.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace gs::vrml {

enum class TokenKind : std::uint8_t {
  need_more,  // the token may go on behind the bytes that are here
  end,        // of the text
  word,       // a run of characters that are no delimiters: a keyword, an Id, a number, `node.event`
  string,     // text without its quotes, escapes still in it
  open_brace,
  close_brace,
  open_bracket,
  close_bracket,
  unterminated_string,  // one that the end of the text cuts short
  bad,                  // one byte that VRML97 has no use for
};

struct Token {
  TokenKind kind = TokenKind::end;
  std::string_view text;  // points into the lexer's buffer
  SourceLocation location;
  bool has_escapes = false;  // string: holds a backslash
};

/// Cuts VRML97 text (Annex A.2) into tokens. Commas are blanks, comments run to the end of the line;
/// CR, LF and CRLF end lines. Works on a window of the text: where the window ends inside a token and
/// the text does not, it answers need_more, and the caller goes back to a position it kept, gets a
/// longer window and tries again.
class Lexer {
 public:
  /// A place to go back to, inside the present window.
  struct Position {
    const char* next;
    std::uint32_t line;
    std::ptrdiff_t line_start;  // offset in the window; negative when the line began before it
  };

  /// Sets the window. The text goes on at the place where the last window was left. `last`: the text
  /// ends with this window.
  void set_window(const char* begin, const char* end, bool last);

  [[nodiscard]] Token next();
  /// Passes blanks and comments; the byte behind them, or NUL where there is none (yet).
  [[nodiscard]] char peek();

  [[nodiscard]] Position position() const { return {next_, line_, line_start_}; }
  void go_back(const Position& position);
  /// The place of the next byte.
  [[nodiscard]] SourceLocation location() const { return location_of(next_); }

  /// For bulk readers: the unread part of the window, and how to say what was read of it.
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

/// An SFString from the text between its quotes: `\"` and `\\` are unescaped, other backslashes stay
/// (old files hold Windows paths). Bytes that are no UTF-8 are taken for Latin-1; `was_latin1` then
/// becomes true.
[[nodiscard]] std::string decode_string(std::string_view raw, bool has_escapes, bool& was_latin1);

/// True where `word` can only be meant as a number: starts with a digit, a sign or a point.
[[nodiscard]] bool looks_like_number(std::string_view word);

/// True for an Id of Annex A.2: its first character and the rest are legal.
[[nodiscard]] bool is_id(std::string_view word);

/// Which of the reserved words of 4.3.1 it is, which are no names: from 0; -1 for none.
[[nodiscard]] int reserved_word(std::string_view word);

}  // namespace gs::vrml
