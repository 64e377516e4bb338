#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/x3d/language.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace gs::vrml {

enum class TokenKind : std::uint8_t {
  need_more,  // the token may continue after the available bytes
  end,        // end of the text
  word,       // run of characters without delimiters: keyword, Id, number or `node.event`
  string,     // text without its quotes; its escapes are not decoded yet
  open_brace,
  close_brace,
  open_bracket,
  close_bracket,
  unterminated_string,  // string without a closing quote before the end of the text
  bad,                  // a byte that VRML97 does not allow
};

struct Token {
  TokenKind kind = TokenKind::end;
  std::string_view text;  // points into the window
  SourceLocation location;
  bool has_escapes = false;  // for strings: contains a backslash
};

/// Lexer that splits VRML97 text (Annex A.2) into tokens. Commas are blanks; a comment extends to the end of the line;
/// CR, LF and CRLF end a line. X3D texts may also contain comments between /* and */ (ISO/IEC 19776-2). Works on a
/// window of the text. If a token reaches the end of a window that is not the last one, the result is need_more. The
/// caller then returns to a stored position and tries again with a longer window.
class Lexer {
 public:
  /// Position in the current window, for go_back().
  struct Position {
    const char* next;
    std::uint32_t line;
    std::ptrdiff_t line_start;  // offset in the window; negative if the line begins before the window
  };

  /// Sets the window. Its first byte must be the next byte that the lexer has not read. `last` means that the text ends
  /// with this window.
  void set_window(const char* begin, const char* end, bool last);
  /// Makes /* and */ delimiters of comments.
  void allow_block_comments() { block_comments_ = true; }

  [[nodiscard]] Token next();
  /// Skips blanks and comments, and returns the next byte. Returns NUL if no byte is available.
  [[nodiscard]] char peek();

  [[nodiscard]] Position position() const { return {next_, line_, line_start_}; }
  void go_back(const Position& position);
  /// Returns the source location of the next byte.
  [[nodiscard]] SourceLocation location() const { return location_of(next_); }

  /// Returns the start of the unread bytes of the window, for bulk readers. They end at window_end(). The reader passes
  /// its end position to advance().
  [[nodiscard]] const char* unread() const { return next_; }
  [[nodiscard]] const char* window_end() const { return end_; }
  [[nodiscard]] bool is_last_window() const { return last_; }
  void advance(const char* next, std::size_t lines, const char* line_start);

 private:
  enum class Blank : std::uint8_t { passed, need_more, end };
  Blank skip_blanks();
  bool skip_block_comment();
  [[nodiscard]] bool begins_block_comment(const char* p) const {
    return block_comments_ && *p == '/' && p + 1 != end_ && p[1] == '*';
  }
  Token string_token();
  void new_line(const char* line_start);
  [[nodiscard]] SourceLocation location_of(const char* p) const;

  const char* begin_ = nullptr;
  const char* next_ = nullptr;
  const char* end_ = nullptr;
  bool last_ = true;
  bool block_comments_ = false;
  std::uint32_t line_ = 1;
  std::ptrdiff_t line_start_ = 0;
};

/// Decodes an SFString from the text between its quotes. Replaces `\"` and `\\`; other backslashes do not change,
/// because old files contain Windows paths. Reads bytes that are not UTF-8 as Latin-1, and then sets `was_latin1`.
[[nodiscard]] std::string decode_string(std::string_view raw, bool has_escapes, bool& was_latin1);

/// Reports whether `word` starts like a number: with a digit, a sign or a decimal point.
[[nodiscard]] bool looks_like_number(std::string_view word);

/// Reports whether `word` is an Id in the sense of Annex A.2.
[[nodiscard]] bool is_id(std::string_view word);

/// Returns the index of a reserved word, which cannot be a name (VRML97 4.3.1, ISO/IEC 19776-2 4.1.2). Returns -1 for
/// other words.
[[nodiscard]] int reserved_word(std::string_view word, Language language);

}  // namespace gs::vrml
