#include "vrml/syntax/parser.h"

#include "vrml/syntax/printer.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

using namespace gs;
using namespace gs::vrml;
namespace fs = std::filesystem;

namespace {

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<fs::path> corpus(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(GHOSTSPACE_TESTS) / "vrml" / folder))
    if (entry.path().extension() == ".wrl" || entry.path().extension() == ".x3dv") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  REQUIRE(!files.empty());
  return files;
}

// Returns the whole result of a parse: outcome, messages and scene.
std::string result_of(const std::string& name, ParseOutcome outcome, const SceneGraph& scene,
                      const Diagnostics& diagnostics) {
  std::string result =
      name + " " + std::to_string(static_cast<int>(outcome)) + " nodes " + std::to_string(scene.nodes().count()) + "\n";
  for (const Diagnostic& diagnostic : diagnostics.entries()) result += diagnostic.text() + "\n";
  return result + print(scene);
}

std::string parse_whole(const std::string& name, const std::string& text, Diagnostics& diagnostics) {
  SceneGraph scene(name);
  const ParseOutcome outcome = parse(text, scene, diagnostics);
  return result_of(name, outcome, scene, diagnostics);
}

std::string parse_pieces(const std::string& name, const std::vector<std::string>& pieces) {
  SceneGraph scene(name);
  Diagnostics diagnostics;
  Parser parser(scene, diagnostics);
  for (const std::string& piece : pieces) {
    // A copy on the heap, so that a sanitizer detects reads beyond the end.
    const std::vector<char> exact(piece.begin(), piece.end());
    parser.push(std::string_view(exact.data(), exact.size()));
  }
  const ParseOutcome outcome = parser.finish();
  return result_of(name, outcome, scene, diagnostics);
}

struct Parsed {
  SceneGraph scene{"text.wrl"};
  Diagnostics diagnostics;
  ParseOutcome outcome;

  explicit Parsed(const std::string& body, Limits limits = {}) : scene("text.wrl", limits) {
    outcome = parse("#VRML V2.0 utf8\n" + body, scene, diagnostics);
  }
  [[nodiscard]] NodeId root(std::size_t i = 0) const { return scene.roots()[i]; }
};

}  // namespace

TEST_CASE("good files parse without errors, lenient ones with the expected warnings") {
  for (const fs::path& path : corpus("good")) {
    INFO(path.filename().string());
    SceneGraph scene(path.filename().string());
    Diagnostics diagnostics;
    CHECK(parse(read_file(path), scene, diagnostics) == ParseOutcome::complete);
    CHECK(diagnostics.errors() == 0);
    std::string said;
    for (const Diagnostic& diagnostic : diagnostics.entries()) said += diagnostic.text() + "\n";
    fs::path expected = path;
    expected.replace_extension(".expected");
    CHECK(said == (fs::exists(expected) ? read_file(expected) : std::string()));
  }
}

TEST_CASE("bad files give exactly the expected diagnostics") {
  for (const fs::path& path : corpus("bad")) {
    INFO(path.filename().string());
    SceneGraph scene(path.filename().string());
    Diagnostics diagnostics;
    (void)parse(read_file(path), scene, diagnostics);
    CHECK(diagnostics.errors() > 0);
    std::string said;
    for (const Diagnostic& diagnostic : diagnostics.entries()) said += diagnostic.text() + "\n";
    fs::path expected = path;
    expected.replace_extension(".expected");
    REQUIRE(fs::exists(expected));
    CHECK(said == read_file(expected));
  }
}

TEST_CASE("prints equal text after a second parse") {
  for (const fs::path& path : corpus("good")) {
    if (path.extension() == ".x3dv") continue;  // the printer writes VRML97
    INFO(path.filename().string());
    SceneGraph scene, again;
    Diagnostics diagnostics, second;
    (void)parse(read_file(path), scene, diagnostics);
    const std::string printed = print(scene);
    CHECK(parse(printed, again, second) == ParseOutcome::complete);
    CHECK(second.errors() == 0);
    CHECK(print(again) == printed);
  }
}

TEST_CASE("parses a text in two pieces like one, wherever it is cut") {
  for (const char* folder : {"good", "bad"})
    for (const fs::path& path : corpus(folder)) {
      const std::string text = read_file(path), name = path.filename().string();
      if (text.size() > 4000) continue;
      Diagnostics diagnostics;
      const std::string whole = parse_whole(name, text, diagnostics);
      for (std::size_t cut = 0; cut <= text.size(); ++cut)
        if (parse_pieces(name, {text.substr(0, cut), text.substr(cut)}) != whole) {
          INFO(name << " cut at " << cut);
          CHECK(parse_pieces(name, {text.substr(0, cut), text.substr(cut)}) == whole);
        }
    }
}

TEST_CASE("parses a text in single bytes or pieces of any size like one") {
  for (const char* folder : {"good", "bad"})
    for (const fs::path& path : corpus(folder)) {
      const std::string text = read_file(path), name = path.filename().string();
      Diagnostics diagnostics;
      const std::string whole = parse_whole(name, text, diagnostics);
      for (const std::size_t size : {1u, 2u, 3u, 7u, 64u, 1000u}) {
        std::vector<std::string> pieces;
        for (std::size_t i = 0; i < text.size(); i += size) pieces.push_back(text.substr(i, size));
        INFO(name << " in pieces of " << size);
        CHECK((parse_pieces(name, pieces) == whole));
      }
    }
}

TEST_CASE("parses every prefix of a text, and shows only nodes that the whole text shows") {
  for (const fs::path& path : corpus("good")) {
    const std::string text = read_file(path);
    std::size_t nodes = 0;
    for (std::size_t size = 0; size <= text.size(); ++size) {
      SceneGraph scene("prefix");
      Diagnostics diagnostics;
      const std::vector<char> exact(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(size));
      (void)parse(std::string_view(exact.data(), exact.size()), scene, diagnostics);
      if (path.stem() != "headerless" && diagnostics.errors() == 0) {
        CHECK(scene.nodes().count() >= nodes);
        nodes = scene.nodes().count();
      }
      (void)print(scene);
    }
  }
}

TEST_CASE("adds nodes of a list to the scene before the list ends") {
  SceneGraph scene("progressive");
  Diagnostics diagnostics;
  Parser parser(scene, diagnostics);
  parser.push("#VRML V2.0 utf8\nGroup { children [ Shape { geometry IndexedFaceSet { coord Coordinate { point [ " +
              std::string(2000, ' '));
  REQUIRE(scene.roots().size() == 1);
  const NodeId shape = scene.get<MFNode>(scene.roots()[0], "children")[0];
  const NodeId faces = scene.get<SFNode>(shape, "geometry");
  const NodeId points = scene.get<SFNode>(faces, "coord");
  parser.push("1 2 3, 4 5 6, 7 8");
  CHECK(scene.get<MFVec3f>(points, "point") == MFVec3f{{1, 2, 3}, {4, 5, 6}});
  parser.push(" 9 ] } coordIndex [ 0 1 2 -1 ");
  CHECK(scene.get<MFVec3f>(points, "point").size() == 3);
  CHECK(scene.get<MFInt32>(faces, "coordIndex") == MFInt32{0, 1, 2, -1});
  parser.push("] } } ] }");
  CHECK(parser.finish() == ParseOutcome::complete);
  CHECK(diagnostics.errors() == 0);
}

TEST_CASE("parses long number lists equally in pieces") {
  std::string text = "#VRML V2.0 utf8\nIndexedFaceSet { coord Coordinate { point [\n";
  for (int i = 0; i < 30000; ++i)
    text += std::to_string(i * 0.37 - 500) + " " + std::to_string(i) + (i % 3 ? " -0.5, " : " 1e-3,\n# note\n");
  text += "] } coordIndex [";
  for (int i = 0; i < 50000; ++i) text += std::to_string(i % 30000) + (i % 4 == 3 ? ", -1,\n" : ", ");
  text += "] }\n";
  Diagnostics diagnostics;
  const std::string whole = parse_whole("lists", text, diagnostics);
  CHECK(diagnostics.errors() == 0);
  for (const std::size_t size : {13u, 4096u, 65536u}) {
    std::vector<std::string> pieces;
    for (std::size_t i = 0; i < text.size(); i += size) pieces.push_back(text.substr(i, size));
    CHECK((parse_pieces("lists", pieces) == whole));
  }
}

TEST_CASE("uses only the memory of its elements for a list of numbers") {
  std::string text = "#VRML V2.0 utf8\nCoordinate { point [";
  for (int i = 0; i < 100000; ++i) text += " 1 2 3,";
  SceneGraph scene;
  Diagnostics diagnostics;
  (void)parse(text + "] }", scene, diagnostics);
  const auto& points = scene.get<MFVec3f>(scene.roots()[0], "point");
  CHECK(points.size() == 100000);
  CHECK(points.capacity() == points.size());
}

TEST_CASE("shares one node between DEF and USE, and uses the last DEF of a name") {
  const Parsed p("DEF X Shape { } DEF X Group { } USE X Transform { children [ USE X USE X ] }");
  CHECK(p.root(2) == p.root(1));
  CHECK(p.scene.get<MFNode>(p.root(3), "children") == MFNode{p.root(1), p.root(1)});
  CHECK(p.scene.node(p.root(0)).name == "X");
}

TEST_CASE("parses field values exactly") {
  const Parsed p(R"(PROTO P [ field SFBool b TRUE field SFInt32 i -0x10 field SFTime t 1e9 field SFString s "a\"b\\c\d"
                    field SFImage m 1 2 3 0x102030 255 field SFRotation r 1 2 3 4 field MFString ms "one" ] { Group { } } P { })");
  REQUIRE(p.diagnostics.errors() == 0);
  CHECK(p.scene.get<SFBool>(p.root(), "b"));
  CHECK(p.scene.get<SFInt32>(p.root(), "i") == -16);
  CHECK(p.scene.get<SFTime>(p.root(), "t") == 1e9);
  CHECK(p.scene.get<SFString>(p.root(), "s") == "a\"b\\c\\d");
  CHECK(p.scene.get<SFImage>(p.root(), "m").words == Array<std::uint32_t>{1, 2, 3, 0x102030, 255});
  CHECK(p.scene.get<SFRotation>(p.root(), "r") == Rotation{1, 2, 3, 4});
  CHECK(p.scene.get<MFString>(p.root(), "ms") == MFString{"one"});
}

TEST_CASE("counts lines at LF, CRLF and CR, and columns in bytes") {
  for (const char* end : {"\n", "\r\n", "\r"}) {
    const std::string text =
        std::string("#VRML V2.0 utf8") + end + end + "# note" + end + "  Shape { nothing 1 }" + end;
    SceneGraph scene("f");
    Diagnostics diagnostics;
    (void)parse(text, scene, diagnostics);
    REQUIRE(diagnostics.entries().size() == 1);
    CHECK(diagnostics.entries()[0].location == SourceLocation{4, 11});
    CHECK(scene.node(scene.roots()[0]).location == SourceLocation{4, 3});
  }
}

TEST_CASE("limits the number of nodes, including those of PROTO instances") {
  Limits limits;
  limits.nodes = 10;
  const Parsed few(
      "Shape { } Shape { } Shape { } Shape { } Shape { } Shape { } Shape { } Shape { } Shape { } Shape { } Shape { } "
      "Shape { }",
      limits);
  CHECK(few.scene.nodes().count() == 10);
  CHECK(few.diagnostics.errors() == 1);

  std::string laughs = "PROTO P0 [ ] { Group { children [ Shape { } ] } }\n";
  for (int i = 1; i < 40; ++i) {
    const std::string inner = "P" + std::to_string(i - 1) + " { } ";
    laughs += "PROTO P" + std::to_string(i) + " [ ] { Group { children [ " + inner + inner + inner + inner + "] } }\n";
  }
  Limits small;
  small.expanded_nodes = 10000;
  const Parsed bomb(laughs + "P39 { }", small);
  CHECK(bomb.scene.nodes().count() < 12000);
  CHECK(bomb.diagnostics.errors() == 1);
}

TEST_CASE("counts diagnostics beyond the number that is kept") {
  std::string text = "#VRML V2.0 utf8\n";
  for (int i = 0; i < 50; ++i) text += "Nonsense" + std::to_string(i) + " { }\n";
  SceneGraph scene;
  Diagnostics diagnostics(10);
  (void)parse(text, scene, diagnostics);
  CHECK(diagnostics.errors() == 50);
  CHECK(diagnostics.entries().size() == 10);
  CHECK(diagnostics.dropped() == 40);
}

TEST_CASE("lists the nodes that are still open") {
  SceneGraph scene("open.wrl");
  Diagnostics diagnostics;
  Parser parser(scene, diagnostics);
  const auto open_types = [&] {
    std::string types;
    for (const NodeId id : parser.open_nodes()) types += scene.node(id).type->name + " ";
    return types;
  };
  CHECK(open_types().empty());
  // Longer than the text that must be present before parsing starts.
  parser.push("#VRML V2.0 utf8\n" + std::string(2000, ' '));
  parser.push("Transform { children Shape { geometry IndexedFaceSet { coord Coordinate { point [ 1 2 3, ");
  CHECK(open_types() == "Transform Shape IndexedFaceSet Coordinate ");
  parser.push("4 5 6 ] } coordIndex [ 0 1");
  CHECK(open_types() == "Transform Shape IndexedFaceSet ");
  parser.push(" 2 ] } } } Group { } ");
  CHECK(open_types().empty());
  parser.finish();
  CHECK(diagnostics.errors() == 0);
}

TEST_CASE("accepts a number without a blank before a token that cannot continue it (Annex A)") {
  const auto same = [](const std::string& glued, const std::string& apart) {
    const auto read = [](const std::string& body) {
      SceneGraph scene("text.wrl");
      Diagnostics diagnostics;
      (void)parse("#VRML V2.0 utf8\n" + body, scene, diagnostics);
      INFO(body);
      for (const Diagnostic& diagnostic : diagnostics.entries()) UNSCOPED_INFO(diagnostic.text());
      CHECK(diagnostics.entries().empty());
      return print(scene);
    };
    CHECK(read(glued) == read(apart));
  };
  same("LOD { range 80level [ Group { } ] }", "LOD { range 80 level [ Group { } ] }");
  same("Transform { translation 1 2 3children [ ] }", "Transform { translation 1 2 3 children [ ] }");
  same("Coordinate { point [ 0 0 0-1 0 10-1, -.5.75+1 0 0 ] }",
       "Coordinate { point [ 0 0 0 -1 0 10 -1, -.5 .75 +1 0 0 ] }");
  same("IndexedFaceSet { coordIndex [ 0 1 2-1 0x0F-1 ] }", "IndexedFaceSet { coordIndex [ 0 1 2 -1 15 -1 ] }");
  same("Material { shininess .27diffuseColor 1 0 0transparency 1e-1 }",
       "Material { shininess .27 diffuseColor 1 0 0 transparency 0.1 }");
  same("Transform { translation 1-2-3 rotation 0 1 0 1.5scale 1 1 1}",
       "Transform { translation 1 -2 -3 rotation 0 1 0 1.5 scale 1 1 1 }");
  same("TimeSensor { cycleInterval 2loop TRUE }", "TimeSensor { cycleInterval 2 loop TRUE }");
  same("PixelTexture { image 1 1 1 0xFFrepeatS FALSE }", "PixelTexture { image 1 1 1 0xFF repeatS FALSE }");
  // No name contains a point.
  same("Viewpoint { fieldOfView.785description \"a\" position.5.25-1 }",
       "Viewpoint { fieldOfView .785 description \"a\" position .5 .25 -1 }");
  same("PROTO P [ field SFFloat x 1 ] { Material { shininess IS x } } P { x.5 }",
       "PROTO P [ field SFFloat x 1 ] { Material { shininess IS x } } P { x .5 }");
}
