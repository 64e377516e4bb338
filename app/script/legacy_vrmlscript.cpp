#include "app/script/program_text.h"
#include "app/script/script_runner.h"
#include "net/base/url.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace gs::app::script {
namespace {

enum class TokenKind : std::uint8_t { word, number, text, expression, mark, comment };

struct Token {
  TokenKind kind = TokenKind::mark;
  std::size_t begin = 0, end = 0;
  bool on_new_line = false;
  bool open = false;  // a string without a closing quote, or a comment without an end; other comments are no tokens
};

bool begins_word(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_' || c == '$' || (c & 0x80); }
bool in_word(char c) { return begins_word(c) || std::isdigit(static_cast<unsigned char>(c)); }

/// Splits a program into the tokens that the rewriting needs. If `whole_strings`, a string may contain line ends.
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

struct Change {
  std::size_t at, length;
  std::string text;
};

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

}  // namespace

// In Annex C, `a = eventOut` and `c = list[1]` copy the value (C.6.2), while `list[1].x = 1` changes it in place.
// ECMAScript never copies. Where the right side is only such a name or element, the assignment is rewritten to call
// $copy().
std::string modern_text(std::string_view text, const std::vector<std::string>& values) {
  if (values.empty()) return std::string(text);
  const std::unordered_set<std::string_view> names(values.begin(), values.end());
  const std::vector<Token> tokens = tokens_of(text, false);
  const auto of = [&](std::size_t i) {
    return i < tokens.size() ? text.substr(tokens[i].begin, tokens[i].end - tokens[i].begin) : std::string_view{};
  };
  std::vector<Change> changes;
  for (std::size_t i = 1; i < tokens.size(); ++i) {
    if (tokens[i].kind != TokenKind::word || of(i - 1) != "=" || !names.contains(of(i))) continue;
    std::size_t last = i;
    if (of(i + 1) == "[") {
      std::size_t depth = 0;
      for (last = i + 1; last < tokens.size(); ++last) {
        if (of(last) == "[") ++depth;
        if (of(last) == "]" && --depth == 0) break;
      }
    }
    if (last >= tokens.size()) continue;
    const bool ends = last + 1 == tokens.size() || of(last + 1) == ";" || of(last + 1) == "," || of(last + 1) == "}" ||
                      (tokens[last + 1].on_new_line && tokens[last + 1].kind == TokenKind::word);
    if (!ends) continue;
    changes.push_back({tokens[i].begin, 0, "$copy("});
    changes.push_back({tokens[last].end, 0, ")"});
  }
  return changed(text, std::move(changes));
}

namespace {

// Returns the index of the token that closes the bracket at index `open`. Returns the number of tokens if no token
// does.
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

// Rewrites `for each (v in list)` of JavaScript 1.6, which loops over values, to `for (v of $values(list))`.
void mend_for_each(std::string_view text, const std::vector<Token>& tokens, std::size_t each,
                   std::vector<Change>& changes) {
  const std::size_t close = closing(text, tokens, each + 1);
  for (std::size_t i = each + 2; i < close && close < tokens.size(); ++i) {
    if (text.substr(tokens[i].begin, tokens[i].end - tokens[i].begin) != "in") continue;
    changes.push_back({tokens[each].begin, 4, ""});
    changes.push_back({tokens[i].begin, 2, "of $values("});
    changes.push_back({tokens[close].begin, 0, ")"});
    return;
  }
}

// Rewrites `function (x) x * 2` of JavaScript 1.8 to have braces and `return`. `word` is the index of the token
// "function".
void mend_closure(std::string_view text, const std::vector<Token>& tokens, std::size_t word,
                  std::vector<Change>& changes) {
  std::size_t open = word + 1;
  if (open < tokens.size() && tokens[open].kind == TokenKind::word) ++open;
  if (open >= tokens.size() || text[tokens[open].begin] != '(') return;
  const std::size_t first = closing(text, tokens, open) + 1;
  if (first >= tokens.size() || text[tokens[first].begin] == '{') return;
  std::size_t last = first;
  for (; last < tokens.size(); ++last) {
    const char c = text[tokens[last].begin];
    if (tokens[last].kind != TokenKind::mark) continue;
    if (c == ',' || c == ';' || c == ')' || c == ']' || c == '}') break;
    if (c == '(' || c == '[' || c == '{') last = closing(text, tokens, last);
  }
  changes.push_back({tokens[first].begin, 0, "{ return "});
  changes.push_back({last < tokens.size() ? tokens[last].begin : text.size(), 0, " }"});
}

}  // namespace

std::string mended_text(std::string_view text) {
  static const std::unordered_set<std::string_view> kLaterWords = {
      "class", "enum", "extends", "super", "export", "import", "await", "yield", "let", "static", "interface"};
  const std::vector<Token> tokens = tokens_of(text, true);
  std::vector<Change> changes;
  int depth = 0;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const Token& token = tokens[i];
    const std::string_view of = text.substr(token.begin, token.end - token.begin);
    if (token.kind == TokenKind::text) {
      for (std::size_t at = token.begin; at < token.end; ++at) {
        if (text[at] == '\\') {
          ++at;
          continue;
        }
        if (text[at] == '\n' || (text[at] == '\r' && !(at + 1 < token.end && text[at + 1] == '\n')))
          changes.push_back({at, 0, "\\n\\"});
        if (text[at] == '\r' && at + 1 < token.end && text[at + 1] == '\n') changes.push_back({at, 1, ""});
      }
      if (token.open) changes.push_back({token.end, 0, std::string(1, text[token.begin])});
    } else if (token.kind == TokenKind::comment) {
      changes.push_back({token.end, 0, "*/"});
    } else if (of == "each" && i > 0 && i + 1 < tokens.size() && text[tokens[i + 1].begin] == '(' &&
               text.substr(tokens[i - 1].begin, tokens[i - 1].end - tokens[i - 1].begin) == "for") {
      mend_for_each(text, tokens, i, changes);
    } else if (of == "function") {
      mend_closure(text, tokens, i, changes);
    } else if (token.kind == TokenKind::word && kLaterWords.contains(of)) {
      const bool member = i > 0 && text[tokens[i - 1].begin] == '.';
      if (!member) changes.push_back({token.begin, of.size(), std::string(of) + "_"});
    } else if (of == "#" && token.on_new_line) {
      changes.push_back({token.begin, 1, "//"});
    } else if (of == "{") {
      ++depth;
    } else if (of == "}") {
      // Replace a brace that closes nothing by a blank.
      if (depth == 0)
        changes.push_back({token.begin, 1, " "});
      else
        --depth;
    }
  }
  std::string result = changed(text, std::move(changes));
  result.append(static_cast<std::size_t>(std::min(depth, 64)), '}');
  return result;
}

}  // namespace gs::app::script

namespace gs::app {

ProgramPlace program_place(std::string_view url) {
  while (!url.empty() && std::isspace(static_cast<unsigned char>(url.front()))) url.remove_prefix(1);
  constexpr std::string_view kSchemes[] = {"javascript", "vrmlscript", "ecmascript"};
  for (const std::string_view scheme : kSchemes)
    if (net::has_scheme(url, scheme)) return {ProgramPlace::Kind::held, url.substr(scheme.size() + 1)};
  const auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
  const std::string_view name = url.substr(0, url.find_first_of("?#"));
  const auto ends_with = [&](std::string_view what) {
    return name.size() >= what.size() &&
           std::equal(what.begin(), what.end(), name.end() - static_cast<std::ptrdiff_t>(what.size()),
                      [&](char a, char b) { return same(b, a); });
  };
  if (ends_with(".class") || ends_with(".jar") || net::has_scheme(url, "java")) return {ProgramPlace::Kind::java, {}};
  if (url.empty()) return {};
  // A scheme that is not in this list is the name of an unknown language.
  constexpr std::string_view kPlaces[] = {"http", "https", "file", "ftp", "data", "memory", "cells", "urn"};
  const std::string_view scheme = url.substr(0, url.find_first_of(":/.?#\n\\ "));
  if (scheme.size() > 1 && scheme.size() < url.size() && url[scheme.size()] == ':' &&
      std::none_of(std::begin(kPlaces), std::end(kPlaces),
                   [&](std::string_view place) { return net::has_scheme(url, place); }))
    return {ProgramPlace::Kind::unknown, scheme};
  return {ProgramPlace::Kind::file, {}};
}

}  // namespace gs::app
