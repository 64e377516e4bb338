// Scenes that are written, read and written again.
#include "tests/vrml/encodings.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace gs::vrml::round_trip_test {
namespace {

namespace fs = std::filesystem;

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<fs::path> worlds() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(GHOSTSPACE_TESTS) / "vrml" / "good"))
    if (entry.path().extension() == ".wrl") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  REQUIRE(!files.empty());
  return files;
}

// Returns the text of a scene in another grammar. Reports errors of the text.
std::string printed_again(const std::string& text, Grammar grammar) {
  SceneGraph scene("again");
  Diagnostics diagnostics;
  CHECK(parse(text, scene, diagnostics) == ParseOutcome::complete);
  for (const Diagnostic& diagnostic : diagnostics.entries())
    if (diagnostic.severity == Severity::error) UNSCOPED_INFO(diagnostic.text());
  CHECK(diagnostics.errors() == 0);
  return printed_scene(scene, {grammar});
}

}  // namespace

TEST_CASE("writes the same text again after reading it, in each encoding") {
  for (const fs::path& path : worlds()) {
    const std::string text = read_file(path);
    for (const Grammar grammar : {Grammar::vrml97, Grammar::x3d_xml, Grammar::x3d_classic, Grammar::x3d_json}) {
      INFO(path.filename().string() << " as " << testing::name_of(grammar));
      const std::string first = testing::encoded(text, grammar);
      CHECK(printed_again(first, grammar) == first);
    }
  }
}

TEST_CASE("writes the same VRML97 text after a round trip through each encoding of X3D") {
  for (const fs::path& path : worlds()) {
    const std::string text = read_file(path);
    // X3D has LayerSet, of which VRML97 only has a stand-in.
    if (path.stem() == "lenient_other_browsers") continue;
    // X3D has one scheme for programs.
    std::string plain = testing::encoded(text, Grammar::vrml97);
    for (std::size_t at; (at = plain.find("vrmlscript:")) != std::string::npos;) plain.replace(at, 4, "java");
    for (const Grammar grammar : testing::kX3DGrammars) {
      INFO(path.filename().string() << " as " << testing::name_of(grammar));
      CHECK(printed_again(testing::encoded(text, grammar), Grammar::vrml97) == plain);
    }
  }
}

TEST_CASE("keeps empty values of instances, backslashes and quotes in each encoding") {
  const std::string text =
      "#VRML V2.0 utf8\nPROTO P [ field MFNode some Group { } field SFNode one Group { } field SFString s \"a\" ] { "
      "Group "
      "{ } }\nP { some [ ] one NULL s \"\\\"b\\\\\\\"c\\\\n\\\\\" }\nWorldInfo { title \"\\\\\\\\ \" info [ \"\\\"\" "
      "\"\\\\\" ] }\n";
  const std::string plain = testing::encoded(text, Grammar::vrml97);
  for (const Grammar grammar : testing::kX3DGrammars) {
    INFO(testing::name_of(grammar));
    CHECK(printed_again(testing::encoded(text, grammar), Grammar::vrml97) == plain);
  }
}

}  // namespace gs::vrml::round_trip_test
