#include "app/script/habits/contact_habits.h"

#include "app/script/habits/program_tokens.h"
#include "base/text.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

namespace gs::app::script {
namespace {

/// Program and its tokens.
struct Tokens {
  std::string_view text;
  std::vector<Token> list;

  explicit Tokens(std::string_view program) : text(program), list(tokens_of(program, false)) {}
  [[nodiscard]] std::string_view of(std::size_t i) const {
    return i < list.size() ? text.substr(list[i].begin, list[i].end - list[i].begin) : std::string_view{};
  }
  [[nodiscard]] std::string_view before(std::size_t i) const { return i > 0 ? of(i - 1) : std::string_view{}; }
  [[nodiscard]] bool is_word(std::size_t i) const { return i < list.size() && list[i].kind == TokenKind::word; }
};

// Returns the names of `exposed` that the program declares as functions.
std::unordered_set<std::string_view> handlers_of(const Tokens& tokens, const std::vector<std::string>& exposed) {
  std::unordered_set<std::string_view> found;
  if (exposed.empty()) return found;
  const std::unordered_set<std::string_view> names(exposed.begin(), exposed.end());
  for (std::size_t i = 1; i < tokens.list.size(); ++i)
    if (tokens.is_word(i) && tokens.of(i - 1) == "function" && names.contains(tokens.of(i))) found.insert(tokens.of(i));
  return found;
}

std::vector<std::uint64_t> hashes_of(const std::unordered_set<std::string_view>& names) {
  std::vector<std::uint64_t> hashes;
  for (const std::string_view name : names)
    if (hashes.size() < UndeclaredNames::kMaxNames) hashes.push_back(stable_hash(name));
  std::sort(hashes.begin(), hashes.end());
  return hashes;
}

// Returns the index of the last token of a function. `word` is the index of the token "function".
std::size_t end_of_function(const Tokens& tokens, std::size_t word) {
  std::size_t open = word + 1;
  if (tokens.is_word(open)) ++open;
  if (tokens.of(open) != "(") return word;
  const std::size_t body = closing(tokens.text, tokens.list, open) + 1;
  return tokens.of(body) == "{" ? closing(tokens.text, tokens.list, body) : word;
}

// Returns the names that `var` and `function` declare outside of functions. May also return arguments of calls in a
// declaration.
std::unordered_set<std::string_view> declared_names(const Tokens& tokens) {
  std::unordered_set<std::string_view> names;
  bool declares = false;
  for (std::size_t i = 0; i < tokens.list.size(); ++i) {
    const std::string_view word = tokens.of(i);
    if (word == "function") {
      if (tokens.is_word(i + 1)) names.insert(tokens.of(i + 1));
      i = std::max(i, std::min(end_of_function(tokens, i), tokens.list.size()));
      continue;
    }
    if (word == "var" || word == "let" || word == "const" || word == "class") {
      declares = true;
    } else if (word == ";" || (tokens.list[i].on_new_line && tokens.is_word(i) && tokens.before(i) != ",")) {
      declares = false;
    } else if (declares && tokens.is_word(i)) {
      names.insert(word);
    }
  }
  return names;
}

}  // namespace

std::string contact_text(std::string text, const std::vector<std::string>& exposed,
                         const std::function<bool(std::string_view)>& is_method) {
  constexpr std::string_view kBrowser = "Browser";
  if (exposed.empty() && text.find(kBrowser) == std::string::npos) return text;
  const Tokens tokens(text);
  const std::unordered_set<std::string_view> handlers = handlers_of(tokens, exposed);
  std::vector<Change> changes;
  for (std::size_t i = 0; i < tokens.list.size(); ++i) {
    if (!tokens.is_word(i) || tokens.before(i) == ".") continue;
    const std::string_view word = tokens.of(i);
    const bool handler = handlers.contains(word) && (tokens.before(i) == "function" || tokens.of(i + 1) == "(");
    if (handler) changes.push_back({tokens.list[i].begin, 0, std::string(kHandlerPrefix)});
    if (word != kBrowser || tokens.of(i + 1) != "." || !tokens.is_word(i + 2) || tokens.of(i + 3) != "(") continue;
    const std::string method(tokens.of(i + 2));
    if (!is_method(method)) changes.push_back({tokens.list[i].begin, word.size(), "$browser(\"" + method + "\")"});
  }
  return changes.empty() ? text : changed(text, std::move(changes));
}

UndeclaredNames::UndeclaredNames(std::string_view program) {
  const Tokens tokens(program);
  const std::unordered_set<std::string_view> declared = declared_names(tokens);
  std::unordered_set<std::string_view> read, tested;
  for (std::size_t i = 0; i < tokens.list.size() && read.size() < kMaxNames; ++i) {
    if (!tokens.is_word(i) || tokens.before(i) == ".") continue;
    const std::string_view next = tokens.of(i + 1), before = tokens.before(i);
    if (next == "(" || before == "function") continue;
    if (next == ":" && (before == "{" || before == ",")) continue;  // a key of an object
    if (before == "typeof") tested.insert(tokens.of(i));
    if (!declared.contains(tokens.of(i))) read.insert(tokens.of(i));
  }
  names_ = hashes_of(read);
  tested_ = hashes_of(tested);
}

bool UndeclaredNames::contains(std::string_view name) const {
  return std::binary_search(names_.begin(), names_.end(), stable_hash(name));
}

bool UndeclaredNames::is_tested(std::string_view name) const {
  return std::binary_search(tested_.begin(), tested_.end(), stable_hash(name));
}

}  // namespace gs::app::script
