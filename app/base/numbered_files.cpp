#include "app/base/numbered_files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <system_error>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMaxDigits = 9;

}  // namespace

std::string NumberedName::at(std::size_t number) const {
  std::string text = std::to_string(number);
  if (text.size() < digits) text.insert(0, digits - text.size(), '0');
  return before + text + after;
}

std::optional<NumberedName> numbered_name(std::string_view name) {
  NumberedName result;
  std::string* part = &result.before;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (name[i] != '%') {
      part->push_back(name[i]);
      continue;
    }
    if (i + 1 < name.size() && name[i + 1] == '%') {
      part->push_back(name[++i]);
      continue;
    }
    if (part == &result.after) return std::nullopt;
    std::size_t end = i + 1;
    while (end < name.size() && name[end] >= '0' && name[end] <= '9') ++end;
    if (end >= name.size() || name[end] != 'd' || end - i > 4) return std::nullopt;
    for (std::size_t k = i + 1; k < end; ++k)
      result.digits = result.digits * 10 + static_cast<std::size_t>(name[k] - '0');
    if (result.digits > kMaxDigits) return std::nullopt;
    part = &result.after;
    i = end;
  }
  if (part == &result.before || result.after.find('/') != std::string::npos) return std::nullopt;
  return result;
}

std::optional<std::uint64_t> number_in(const NumberedName& name, std::string_view file) {
  if (file.size() <= name.before.size() + name.after.size() || !file.starts_with(name.before) ||
      !file.ends_with(name.after))
    return std::nullopt;
  const char *first = file.data() + name.before.size(), *last = file.data() + file.size() - name.after.size();
  std::uint64_t number = 0;
  const auto read = std::from_chars(first, last, number);
  return read.ec == std::errc() && read.ptr == last ? std::optional(number) : std::nullopt;
}

std::optional<std::vector<std::string>> file_series(const std::string& path) {
  namespace fs = std::filesystem;
  const auto name = numbered_name(path);
  std::error_code error;
  if (!name || path.find("://") != std::string::npos || fs::exists(path, error)) return std::nullopt;
  const std::size_t slash = name->before.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : name->before.substr(0, slash + 1);
  const NumberedName in_folder{name->before.substr(folder.size()), name->after, name->digits};
  std::vector<std::pair<std::uint64_t, std::string>> found;
  fs::directory_iterator entry(folder.empty() ? "." : folder, error);
  for (; !error && entry != fs::directory_iterator() && found.size() < kMaxFiles; entry.increment(error)) {
    const std::string file = entry->path().filename().string();
    if (const auto number = number_in(in_folder, file)) found.emplace_back(*number, folder + file);
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> files;
  files.reserve(found.size());
  for (auto& [number, file] : found) files.push_back(std::move(file));
  return files;
}

std::size_t series_place(double seconds, double rate, std::size_t count) {
  // Rounding must not select the previous file: at a multiple of 1 / rate, a new file begins.
  const double place = std::floor(seconds * rate + 1e-6);
  return place > 0 ? std::min(static_cast<std::size_t>(std::min(place, 1e9)), count - 1) : 0;
}

}  // namespace gs::app
