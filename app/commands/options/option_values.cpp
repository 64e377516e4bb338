#include "app/commands/options/option_values.h"

#include <algorithm>
#include <cmath>

namespace gs::app {

bool read_list(std::string_view text, char separator, std::span<double> numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t end = i + 1 < numbers.size() ? text.find(separator) : text.size();
    if (end == std::string_view::npos || !read(text.substr(0, end), numbers[i]) || !std::isfinite(numbers[i]))
      return false;
    text.remove_prefix(std::min(text.size(), end + 1));
  }
  return true;
}

bool read_scaled(std::string_view text, std::uint64_t step, std::uint64_t most, std::uint64_t& number) {
  static constexpr std::string_view kUnits = "kmg";
  if (text.empty()) return false;
  const char last = text.back();
  const std::size_t unit = kUnits.find(last >= 'A' && last <= 'Z' ? static_cast<char>(last + 32) : last);
  if (unit != std::string_view::npos) text.remove_suffix(1);
  if (!read(text, number)) return false;
  for (std::size_t i = 0; unit != std::string_view::npos && i <= unit; ++i) {
    if (number > most / step) return false;
    number *= step;
  }
  return number <= most;
}

bool read_share(std::string_view text, double& share) {
  const bool percent = text.ends_with('%');
  if (percent) text.remove_suffix(1);
  if (!read(text, share)) return false;
  if (percent) share /= 100;
  return share >= 0 && share <= 1;
}

bool each_of(std::string_view list, const std::function<bool(const std::string&)>& take) {
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    if (!take(std::string(list.substr(begin, end - begin)))) return false;
    begin = end + 1;
  }
  return true;
}

}  // namespace gs::app
