#pragma once

#include "tests/app/formats_helpers.h"

#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Facts that other programs found in shared data files.
namespace gs::test {

/// Returns the folder of shared data `name` with a slash at its end. Warns and returns an empty text if it is missing.
inline std::string shared_data(const std::string& name) {
  const auto folder = shared_folder() / "data" / name;
  if (!shared_folder().empty() && std::filesystem::is_directory(folder)) return folder.string() + '/';
  WARN("skipped: no shared data/" + name + " (set GHOSTSPACE_SHARED)");
  return {};
}

/// Row of the table of a README: a file, and what another program found in it.
struct SharedFact {
  std::string file, text;
};

/// Reads the rows "| file | bytes | what | facts |".
inline std::vector<SharedFact> shared_facts(const std::string& readme) {
  std::vector<SharedFact> facts;
  std::ifstream in(readme);
  for (std::string line; std::getline(in, line) && !line.starts_with("## ");) {
    std::vector<std::string> cells;
    std::size_t at = 1;
    for (std::size_t end = line.find(" |", at); end != std::string::npos; end = line.find(" |", at)) {
      cells.push_back(line.substr(std::min(at + 1, end), end - std::min(at + 1, end)));
      at = end + 2;
    }
    if (cells.size() == 4 && cells[0] != "file") facts.push_back({cells[0], cells[3]});
  }
  return facts;
}

/// Returns the number after the first `key`, such as 1794 in "min 0 max 1794" for " max ".
inline std::optional<double> number_in(std::string_view text, std::string_view key) {
  const std::size_t at = text.find(key);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string rest(text.substr(at + key.size(), 40));
  char* end = nullptr;
  const double value = std::strtod(rest.c_str(), &end);
  return end == rest.c_str() ? std::nullopt : std::optional(value);
}

}  // namespace gs::test
