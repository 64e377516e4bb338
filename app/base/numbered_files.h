#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// File name with one placeholder such as %d or %04d, for numbers from 0.
struct NumberedName {
  std::string before, after;
  std::size_t digits = 0;  // min number of digits
  [[nodiscard]] std::string at(std::size_t number) const;
};
/// Parses a name with exactly one placeholder in its last part; %% means %. Returns nullopt if there is none, or if
/// another character follows a %.
[[nodiscard]] std::optional<NumberedName> numbered_name(std::string_view name);

/// Returns the files of a series, such as the output of a simulation, ordered by number. "run.%04d.vti" matches all
/// files of the folder with a number of any length in that position. Returns nullopt if the path has no placeholder, or
/// if a file has this exact name. Returns at most kMaxFiles.
[[nodiscard]] std::optional<std::vector<std::string>> file_series(const std::string& path);
inline constexpr std::size_t kMaxFiles = 100'000;

/// Returns the index of the file that is shown at a time, at `rate` files per second. The last file stays. `count` is
/// greater than 0.
[[nodiscard]] std::size_t series_place(double seconds, double rate, std::size_t count);

}  // namespace gs::app
