// Checks that the tests exist that docs/security.md names.
#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

namespace {

namespace fs = std::filesystem;

std::string text_of_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::set<std::string> names_of_tests() {
  std::set<std::string> names;
  const std::regex name("(?:TEST_CASE|SCENARIO)\\(\\s*((?:\"(?:[^\"\\\\]|\\\\.)*\"\\s*)+)");
  for (const auto& entry : fs::recursive_directory_iterator(GHOSTSPACE_TESTS)) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string text = text_of_file(entry.path());
    for (std::sregex_iterator match(text.begin(), text.end(), name), end; match != end; ++match)
      // A long name may be written as several strings.
      names.insert(std::regex_replace((*match)[1].str(), std::regex("^\"|\"\\s*$|\"\\s*\""), ""));
  }
  return names;
}

}  // namespace

TEST_CASE("finds the tests that docs/security.md names") {
  std::string text = text_of_file(GHOSTSPACE_TESTS "/../docs/security.md");
  REQUIRE_FALSE(text.empty());
  text = std::regex_replace(text, std::regex("\\s+"), " ");
  const std::set<std::string> names = names_of_tests();
  const std::regex cited("\\*([^*]+)\\*");
  std::size_t count = 0;
  for (std::sregex_iterator match(text.begin(), text.end(), cited), end; match != end; ++match) {
    const std::string name = (*match)[1].str();
    if (name == "italics") continue;
    INFO(name);
    CHECK(names.contains(name));
    ++count;
  }
  CHECK(count > 20);
  const std::regex file("\\((tests/[a-z_/]+\\.cpp)\\)");
  for (std::sregex_iterator match(text.begin(), text.end(), file), end; match != end; ++match) {
    INFO((*match)[1].str());
    CHECK(fs::exists(fs::path(GHOSTSPACE_TESTS "/..") / (*match)[1].str()));
  }
}
