#include "app/interface/base/notices.h"

#include <algorithm>
#include <utility>

namespace gs::app {

void Notices::show(std::string text, bool is_problem, double now, std::string_view about) {
  std::erase_if(lines_, [&](const Line& line) { return line.text == text || (!about.empty() && line.about == about); });
  if (text.empty()) return;
  if (lines_.size() >= kMax) lines_.erase(lines_.begin());
  lines_.push_back({std::move(text), is_problem, now + (is_problem ? kProblemSeconds : kSeconds), std::string(about)});
}

void Notices::expire(double now) {
  std::erase_if(lines_, [now](const Line& line) { return now >= line.until; });
}

void Notices::close(std::size_t index) {
  if (index < lines_.size()) lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(index));
}

bool Notices::close_one() {
  if (lines_.empty()) return false;
  lines_.pop_back();
  return true;
}

std::optional<double> Notices::next() const {
  std::optional<double> first;
  for (const Line& line : lines_) first = std::min(first.value_or(line.until), line.until);
  return first;
}

}  // namespace gs::app
