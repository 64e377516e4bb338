#include "app/script/habits/program_tokens.h"
#include "app/script/program_text.h"
#include "app/script/script_runner.h"
#include "net/base/url.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace gs::app::script {

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
  constexpr std::string_view kPlaces[] = {"http", "https", "file", "ftp", "data", "memory", "cells", "ssh", "urn"};
  const std::string_view scheme = url.substr(0, url.find_first_of(":/.?#\n\\ "));
  if (scheme.size() > 1 && scheme.size() < url.size() && url[scheme.size()] == ':' &&
      std::none_of(std::begin(kPlaces), std::end(kPlaces),
                   [&](std::string_view place) { return net::has_scheme(url, place); }))
    return {ProgramPlace::Kind::unknown, scheme};
  return {ProgramPlace::Kind::file, {}};
}

}  // namespace gs::app
