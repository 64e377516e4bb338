#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// File name with one placeholder for a number, such as %d or %04d. Numbers start at 0.
struct NumberedName {
  std::string before, after;
  std::size_t digits = 0;  // min number of digits of the number
  [[nodiscard]] std::string at(std::size_t number) const;
};
/// Parses a name with exactly one placeholder in its last path component; %% means %. Returns nullopt if there is no
/// placeholder, or if another character follows a %.
[[nodiscard]] std::optional<NumberedName> numbered_name(std::string_view name);

/// Returns the number in a file name of this form, with any number of digits. Returns nullopt for other names.
[[nodiscard]] std::optional<std::uint64_t> number_in(const NumberedName& name, std::string_view file);

/// Returns the files of a series in the order of their numbers, for example the output of a simulation. The path
/// "run.%04d.vti" matches all files of its folder with a number in that position; the number may have any length.
/// Returns nullopt if the path has no placeholder, or if a file with exactly this path exists. Returns at most
/// kMaxFiles.
[[nodiscard]] std::optional<std::vector<std::string>> file_series(const std::string& path);
inline constexpr std::size_t kMaxFiles = 100'000;

/// Returns the index of the file to show at a time, with `rate` files per second. After the end, the last file stays.
/// `count` must be positive.
[[nodiscard]] std::size_t series_place(double seconds, double rate, std::size_t count);

}  // namespace gs::app
