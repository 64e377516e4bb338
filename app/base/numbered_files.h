#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// A file name with one %d or %04d in it, for numbers from 0 on.
struct NumberedName {
  std::string before, after;
  std::size_t digits = 0;  // at least
  [[nodiscard]] std::string at(std::size_t number) const;
};
/// Of a name whose last part has exactly one such place; %% stands for %. Nothing where it has none, or something else
/// behind a %.
[[nodiscard]] std::optional<NumberedName> numbered_name(std::string_view name);

/// The files of a series, such as a simulation writes, in the order of their numbers: "run.%04d.vti" are all files of
/// the folder that have a number in that place, whatever their digits. Nothing where the path is no such name, or a
/// file is called so; at most kMostFiles.
[[nodiscard]] std::optional<std::vector<std::string>> file_series(const std::string& path);
inline constexpr std::size_t kMostFiles = 100'000;

/// Which of `count` files shows at a time, `rate` of them a second; the last one stays. `count` > 0.
[[nodiscard]] std::size_t series_place(double seconds, double rate, std::size_t count);

}  // namespace gs::app
