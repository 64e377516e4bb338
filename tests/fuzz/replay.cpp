// PROGRAM FOLDER [TARGET]: runs the targets of a room on their corpora, FOLDER/TARGET/*. Fails if a target has no
// corpus or can read none of its inputs, and if a corpus has no target.
#include "tests/fuzz/fuzz_target.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace {

namespace fs = std::filesystem;

bool replay(const gs::fuzz::FuzzTarget& target, const fs::path& folder) {
  std::size_t files = 0, taken = 0;
  (void)target.run({});
  std::error_code none;
  for (const auto& entry : fs::recursive_directory_iterator(folder, none)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    std::printf("%s: %s: ", target.name.c_str(), entry.path().filename().c_str());
    std::fflush(stdout);  // the target may crash, so print its name now
    const bool read = target.run(std::as_bytes(std::span(bytes)));
    std::printf(read ? "read\n" : "refused\n");
    ++files;
    if (read) ++taken;
  }
  if (taken > 0) return true;
  std::printf("%s: none of %zu inputs in %s is what it reads\n", target.name.c_str(), files, folder.c_str());
  return false;
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) return 2;
  const fs::path folder = arguments[1];
  const std::vector<gs::fuzz::FuzzTarget> targets = gs::fuzz::fuzz_targets();
  bool good = !targets.empty();
  for (const gs::fuzz::FuzzTarget& target : targets)
    if (count == 2 || target.name == arguments[2]) good = replay(target, folder / target.name) && good;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename().string();
    if (std::any_of(targets.begin(), targets.end(), [&](const auto& target) { return target.name == name; })) continue;
    std::printf("%s: a corpus without a target\n", name.c_str());
    good = false;
  }
  return good ? 0 : 1;
}
