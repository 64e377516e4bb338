#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Tokens of programs, for rewriting.
namespace gs::app::script {

enum class TokenKind : std::uint8_t { word, number, text, expression, mark, comment };

/// Word, number, string, regular expression or mark of a program.
struct Token {
  TokenKind kind = TokenKind::mark;
  std::size_t begin = 0, end = 0;
  bool on_new_line = false;
  bool open = false;  // a string without a closing quote, or a comment without an end; other comments are no tokens
};

/// Splits a program into the tokens that the rewriting needs. If `whole_strings`, a string may contain line ends.
[[nodiscard]] std::vector<Token> tokens_of(std::string_view text, bool whole_strings);

/// Returns the index of the token that closes the bracket at index `open`. Returns the number of tokens if no token
/// does.
[[nodiscard]] std::size_t closing(std::string_view text, const std::vector<Token>& tokens, std::size_t open);

/// Replacement of a part of a text.
struct Change {
  std::size_t at, length;
  std::string text;
};

/// Returns the text after the changes. Ignores changes that overlap an earlier one.
[[nodiscard]] std::string changed(std::string_view text, std::vector<Change> changes);

}  // namespace gs::app::script
