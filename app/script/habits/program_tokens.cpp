#include "app/script/habits/program_tokens.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace gs::app::script {
namespace {

bool begins_word(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_' || c == '$' || (c & 0x80); }
bool in_word(char c) { return begins_word(c) || std::isdigit(static_cast<unsigned char>(c)); }

}  // namespace

std::vector<Token> tokens_of(std::string_view text, bool whole_strings) {
  std::vector<Token> tokens;
  bool new_line = true;
  // Reports whether a slash here begins a regular expression. Otherwise it divides.
  const auto slash_begins = [&] {
    if (tokens.empty()) return true;
    const Token& last = tokens.back();
    const std::string_view of = text.substr(last.begin, last.end - last.begin);
    if (last.kind == TokenKind::mark) return of != ")" && of != "]" && of != "}";
    return last.kind == TokenKind::word && (of == "return" || of == "typeof" || of == "case" || of == "in");
  };
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '\n' || c == '\r') {
      new_line = true;
      ++i;
      continue;
    }
    if (std::isspace(static_cast<unsigned char>(c))) {
      ++i;
      continue;
    }
    if (text.substr(i, 2) == "//" || text.substr(i, 4) == "<!--") {
      i = std::min(text.size(), text.find_first_of("\r\n", i));
      continue;
    }
    if (text.substr(i, 2) == "/*") {
      const std::size_t end = text.find("*/", i + 2);
      if (end == std::string_view::npos) tokens.push_back({TokenKind::comment, i, text.size(), new_line, true});
      i = end == std::string_view::npos ? text.size() : end + 2;
      continue;
    }
    Token token{TokenKind::mark, i, i + 1, new_line, false};
    new_line = false;
    if (begins_word(c)) {
      token.kind = TokenKind::word;
      while (token.end < text.size() && in_word(text[token.end])) ++token.end;
    } else if (std::isdigit(static_cast<unsigned char>(c))) {
      token.kind = TokenKind::number;
      while (token.end < text.size() && (in_word(text[token.end]) || text[token.end] == '.')) ++token.end;
    } else if (c == '"' || c == '\'') {
      token.kind = TokenKind::text;
      token.open = true;
      while (token.end < text.size()) {
        const char at = text[token.end];
        if (at == '\\') {
          token.end = std::min(text.size(), token.end + 2);
          continue;
        }
        if ((at == '\n' || at == '\r') && !whole_strings) break;
        ++token.end;
        if (at == c) {
          token.open = false;
          break;
        }
      }
    } else if (c == '/' && slash_begins()) {
      token.kind = TokenKind::expression;
      bool in_class = false;
      while (token.end < text.size() && text[token.end] != '\n' && text[token.end] != '\r') {
        const char at = text[token.end++];
        if (at == '\\' && token.end < text.size()) ++token.end;
        in_class = at == '[' || (in_class && at != ']');
        if (at == '/' && !in_class) break;
      }
    } else {
      constexpr std::array<std::string_view, 14> kLong = {
          "===", "!==", ">>>", "==", "!=", "<=", ">=", "+=", "-=", "*=", "/=", "&&", "||", "++"};
      for (const std::string_view mark : kLong)
        if (text.substr(i, mark.size()) == mark) {
          token.end = i + mark.size();
          break;
        }
    }
    i = token.end;
    tokens.push_back(token);
  }
  return tokens;
}

std::size_t closing(std::string_view text, const std::vector<Token>& tokens, std::size_t open) {
  std::size_t depth = 0;
  for (std::size_t i = open; i < tokens.size(); ++i) {
    if (tokens[i].kind != TokenKind::mark) continue;
    const char c = text[tokens[i].begin];
    if (c == '(' || c == '[' || c == '{') ++depth;
    if ((c == ')' || c == ']' || c == '}') && depth > 0 && --depth == 0) return i;
  }
  return tokens.size();
}

std::string changed(std::string_view text, std::vector<Change> changes) {
  std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) { return a.at < b.at; });
  std::string result;
  std::size_t done = 0;
  for (const Change& change : changes) {
    if (change.at < done) continue;
    result += text.substr(done, change.at - done);
    result += change.text;
    done = change.at + change.length;
  }
  return result + std::string(text.substr(done));
}

}  // namespace gs::app::script
