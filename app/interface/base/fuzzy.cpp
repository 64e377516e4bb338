#include "app/interface/base/fuzzy.h"

#include "base/text.h"

#include <algorithm>
#include <string>

namespace gs::app {
namespace {

constexpr int kWhole = 100, kAtWord = 50, kAtStart = 25;

bool is_part_of_word(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || (c & 0x80) != 0; }

std::optional<int> score_of_word(const std::string& text, const std::string& word) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    if (at == 0 || !is_part_of_word(text[at - 1])) return kWhole + kAtWord + (at == 0 ? kAtStart : 0);
  if (text.find(word) != std::string::npos) return kWhole;
  // Match letter by letter. Matches at the start of a word score more; gaps between matches score less.
  int score = 0;
  std::size_t at = 0;
  for (const char c : word) {
    const std::size_t found = text.find(c, at);
    if (found == std::string::npos) return std::nullopt;
    score += found == 0 || !is_part_of_word(text[found - 1]) ? 8 : found == at ? 4 : 0;
    at = found + 1;
  }
  return std::min(score, kWhole - 1);
}

}  // namespace

std::optional<int> fuzzy_score(std::string_view given, std::string_view typed) {
  const std::string text = lower_case(given), wanted = lower_case(typed);
  int score = 0;
  for (std::size_t at = 0; at < wanted.size();) {
    const std::size_t end = std::min(wanted.find(' ', at), wanted.size());
    if (end > at) {
      const auto one = score_of_word(text, wanted.substr(at, end - at));
      if (!one) return std::nullopt;
      score += *one;
    }
    at = end + 1;
  }
  return score;
}

}  // namespace gs::app
