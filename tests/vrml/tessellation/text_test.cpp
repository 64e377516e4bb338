#include "vrml/mesh/text_shaper.h"

#include "base/budget.h"
#include "tests/vrml/mesh_checks.h"

#include <initializer_list>
#include <string>

using namespace gs;

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

/// Font with a block for every byte: half an em wide and one line high, in vertical text one em high and wide. The box
/// of a mesh is therefore the box of its lines.
class Blocks : public TextShaper {
 public:
  LineEdges edges(const FontRequest&) override { return {0.75f, 0.25f}; }
  ShapedText shape(const FontRequest& font, std::string_view text, TextDirection direction, std::size_t) override {
    asked.push_back(font);
    const bool horizontal = direction == TextDirection::right || direction == TextDirection::left;
    const bool forth = direction == TextDirection::right || direction == TextDirection::up;
    const glm::vec2 lower = horizontal ? glm::vec2(0, -0.25f) : glm::vec2(-0.5f, 0);
    const glm::vec2 size = horizontal ? glm::vec2(0.5f, 1) : glm::vec2(1);
    auto block = std::make_shared<GlyphShape>();
    block->points = {lower, lower + glm::vec2(size.x, 0), lower + size, lower + glm::vec2(0, size.y)};
    block->triangles = {0, 1, 2, 0, 2, 3};
    ShapedText shaped;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const float advance = horizontal ? size.x : size.y;
      const float at = forth ? static_cast<float>(i) * advance : -static_cast<float>(i + 1) * advance;
      if (text[i] != ' ') shaped.glyphs.push_back({block, horizontal ? glm::vec2(at, 0) : glm::vec2(0, at)});
      shaped.extent += advance;
    }
    return shaped;
  }
  std::vector<FontRequest> asked;
};

struct TextScene : GeometryScene {
  explicit TextScene(std::initializer_list<const char*> strings) : GeometryScene("Text") {
    MFString all;
    for (const char* string : strings) all.push_back(SFString(string));
    set("string", std::move(all));
  }
  template <class T>
  TextScene& style(std::string_view field, T value) {
    if (!font_style) {
      font_style = make("FontStyle");
      scene.set<SFNode>(geometry, "fontStyle", font_style);
    }
    scene.set<T>(font_style, field, std::move(value));
    return *this;
  }
  TextScene& justify(const char* major, const char* minor) {
    return style("justify", minor ? MFString{SFString(major), SFString(minor)} : MFString{SFString(major)});
  }
  [[nodiscard]] Mesh drawn() {
    MeshOptions options;
    options.text_shaper = &blocks;
    return mesh(options);
  }
  Blocks blocks;
  NodeId font_style;
};

void check_box(const Mesh& mesh, const glm::vec2& lower, const glm::vec2& upper) {
  INFO("from " << mesh.bounds.lower.x << " " << mesh.bounds.lower.y << " to " << mesh.bounds.upper.x << " "
               << mesh.bounds.upper.y << ", expected from " << lower.x << " " << lower.y << " to " << upper.x << " "
               << upper.y);
  CHECK(glm::length(glm::vec2(mesh.bounds.lower) - lower) < 1e-4f);
  CHECK(glm::length(glm::vec2(mesh.bounds.upper) - upper) < 1e-4f);
}

}  // namespace

TEST_CASE("makes flat, two-sided, lit Text that faces +z") {  // 6.47.1
  TextScene text({"ab", "c"});
  const Mesh mesh = text.drawn();
  check_promises(mesh);
  CHECK(triangles_of(mesh) == 6);
  CHECK_FALSE(mesh.solid);
  CHECK(mesh.lit);
  CHECK(mesh.bounds.lower.z == 0);
  CHECK(mesh.bounds.upper.z == 0);
  for (const glm::vec3& normal : mesh.normals) CHECK(normal == glm::vec3(0, 0, 1));
  for (std::size_t t = 0; t < triangles_of(mesh); ++t) CHECK(area_vector(mesh, t).z > 0);
}

TEST_CASE("makes no mesh of Text without fonts, without strings or of blanks") {
  TextScene text({"abc"});
  CHECK(text.mesh().empty());
  CHECK(TextScene({}).drawn().empty());
  CHECK(TextScene({"", " ", ""}).drawn().empty());
}

TEST_CASE("aligns Text by justify (VRML97 6.20.3, Tables 6.2 to 6.5)") {
  // Lines of 4, 2 and 3 characters; font size 2, spacing 1.5: base lines are 3 apart.
  const double extents[] = {4, 2, 3};
  const char* names[] = {"FIRST", "BEGIN", "MIDDLE", "END"};
  for (const bool horizontal : {true, false})
    for (const bool left_to_right : {true, false})
      for (const bool top_to_bottom : {true, false})
        for (const std::string major : names)
          for (const std::string minor : names) {
            INFO("horizontal " << horizontal << " leftToRight " << left_to_right << " topToBottom " << top_to_bottom
                               << " justify " << major << " " << minor);
            TextScene text({"abcd", "ab", "abc"});
            text.justify(major.c_str(), minor.c_str()).style("size", 2.0f).style("spacing", 1.5f);
            text.style("horizontal", horizontal).style("leftToRight", left_to_right);
            text.style("topToBottom", top_to_bottom);
            // Boxes of the lines, each with its start and first base line at the origin.
            glm::dvec2 lower[3], upper[3];
            for (int i = 0; i < 3; ++i) {
              const double length = 2 * extents[i] * (horizontal ? 0.5 : 1);
              if (horizontal) {
                const double base = (top_to_bottom ? -3 : 3) * i;
                lower[i] = {left_to_right ? 0 : -length, base - 0.5};
                upper[i] = {left_to_right ? length : 0, base + 1.5};
              } else {
                const double center = (left_to_right ? 3 : -3) * i;
                lower[i] = {center - 1, top_to_bottom ? -length : 0};
                upper[i] = {center + 1, top_to_bottom ? 0 : length};
              }
            }
            const int along = horizontal ? 0 : 1, across = 1 - along;
            const bool along_up = horizontal ? left_to_right : !top_to_bottom;
            const bool across_up = horizontal ? !top_to_bottom : left_to_right;
            // Tables 6.2 and 6.3 align each line alone, with the named edge at the origin.
            for (int i = 0; i < 3; ++i) {
              const double begin = along_up ? lower[i][along] : upper[i][along];
              const double end = along_up ? upper[i][along] : lower[i][along];
              const double at = major == "MIDDLE" ? (begin + end) / 2 : major == "END" ? end : begin;
              lower[i][along] -= at;
              upper[i][along] -= at;
            }
            // Tables 6.4 and 6.5 align all lines together. FIRST of horizontal text is the first base line.
            const double begin = across_up ? lower[0][across] : upper[0][across];
            const double end = across_up ? upper[2][across] : lower[2][across];
            const double at = minor == "MIDDLE"                ? (begin + end) / 2
                              : minor == "END"                 ? end
                              : minor == "FIRST" && horizontal ? 0
                                                               : begin;
            const Mesh mesh = text.drawn();
            check_promises(mesh);
            REQUIRE(mesh.positions.size() == 4 * (4 + 2 + 3));
            std::size_t next = 0;
            for (int i = 0; i < 3; ++i) {
              Box line;
              for (int k = 0; k < 4 * static_cast<int>(extents[i]); ++k) line.add(mesh.positions[next++]);
              lower[i][across] -= at;
              upper[i][across] -= at;
              CHECK(glm::length(glm::dvec2(line.lower) - lower[i]) < 1e-4);
              CHECK(glm::length(glm::dvec2(line.upper) - upper[i]) < 1e-4);
            }
          }
}

TEST_CASE("uses the default alignment for empty and unknown values of justify") {  // 6.20.3
  const glm::vec2 lower(0, -0.25f), upper(1, 0.75f);
  check_box(TextScene({"ab"}).drawn(), lower, upper);  // no FontStyle
  check_box(TextScene({"ab"}).justify("", nullptr).drawn(), lower, upper);
  check_box(TextScene({"ab"}).justify("BEGIN", nullptr).drawn(), lower, upper);
  check_box(TextScene({"ab"}).justify("BEGIN", "FIRST").drawn(), lower, upper);
  check_box(TextScene({"ab"}).justify("FIRST", "").drawn(), lower, upper);
  check_box(TextScene({"ab"}).justify("Middle", "centre").drawn(), lower, upper);  // case-sensitive
  check_box(TextScene({"ab"}).style("justify", MFString{}).drawn(), lower, upper);
}

TEST_CASE("keeps the lines of empty strings") {
  check_box(TextScene({"", "a", "", "a"}).drawn(), {0, -3.25f}, {0.5f, -0.25f});
  check_box(TextScene({"a", "", ""}).justify("BEGIN", "END").drawn(), {0, 2}, {0.5f, 3});
}

TEST_CASE("stretches or compresses each string of Text to its length") {  // 6.47.1
  TextScene text({"ab", "ab", "ab", "ab"});
  text.set("length", MFFloat{3, 0.5f, 0});  // natural extents are 1; 0 and missing values allow any length
  const Mesh mesh = text.drawn();
  const float expected[] = {3, 0.5f, 1, 1};
  REQUIRE(mesh.positions.size() == 32);
  for (std::size_t i = 0; i < 4; ++i) {
    Box line;
    for (std::size_t k = 0; k < 8; ++k) line.add(mesh.positions[8 * i + k]);
    CHECK(line.lower.x == Approx(0).margin(1e-6));
    CHECK(line.upper.x == Approx(expected[i]));
    CHECK(line.size().y == Approx(1));  // only along the string
  }
  text.style("horizontal", false);  // measured vertically
  const Mesh vertical = text.drawn();
  for (std::size_t i = 0; i < 4; ++i) {
    Box line;
    for (std::size_t k = 0; k < 8; ++k) line.add(vertical.positions[8 * i + k]);
    CHECK(line.size().y == Approx(expected[i] == 1 ? 2 : expected[i]));
    CHECK(line.size().x == Approx(1));
  }
}

TEST_CASE("compresses all strings of Text by the longest one if it exceeds maxExtent") {  // 6.47.1
  TextScene text({"abcdefgh", "ab", ""});
  text.set("maxExtent", 2.0f);  // natural extents are 4 and 1
  Mesh mesh = text.drawn();
  check_box(mesh, {0, -1.25f}, {2, 0.75f});
  CHECK(mesh.positions[8 * 4 + 4 + 1].x == Approx(0.5));  // the second string's end
  text.set("maxExtent", 5.0f);                            // longer than all strings, so no compression
  check_box(text.drawn(), {0, -1.25f}, {4, 0.75f});
  // length precedes maxExtent.
  text.set("maxExtent", 2.0f).set("length", MFFloat{8, 0});
  mesh = text.drawn();
  check_box(mesh, {0, -1.25f}, {2, 0.75f});
  CHECK(mesh.positions[8 * 4 + 4 + 1].x == Approx(0.25));
  text.justify("END", "FIRST");
  check_box(text.drawn(), {-2, -1.25f}, {0, 0.75f});
}

TEST_CASE("starts texture coordinates of Text at the first string's origin, with 1 per em") {  // 6.47.3
  TextScene text({"ab", "c"});
  text.style("size", 4.0f).justify("MIDDLE", "BEGIN");
  const Mesh mesh = text.drawn();
  REQUIRE(mesh.texture_coordinates.size() == mesh.positions.size());
  // The first string runs from x = -2 to 2 on the base line y = -3.
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    CHECK(mesh.texture_coordinates[i].x == Approx((mesh.positions[i].x + 2) / 4).margin(1e-6));
    CHECK(mesh.texture_coordinates[i].y == Approx((mesh.positions[i].y + 3) / 4).margin(1e-6));
  }
  MeshOptions plain;
  plain.text_shaper = &text.blocks;
  plain.texture_coordinates = false;
  CHECK(text.mesh(plain).texture_coordinates.empty());
}

TEST_CASE("requests the fonts that the FontStyle names") {  // 6.20.2, 6.20.4
  TextScene text({"a"});
  (void)text.drawn();
  text.style("family", MFString{SFString("Humanist"), SFString("SANS")}).style("style", SFString("BOLDITALIC"));
  text.style("language", SFString("zh_TW"));
  (void)text.drawn();
  text.style("style", SFString("BOLD"));
  (void)text.drawn();
  text.style("style", SFString("bold"));  // case-sensitive
  (void)text.drawn();
  REQUIRE(text.blocks.asked.size() == 4);
  CHECK(text.blocks.asked[0].families.empty());
  CHECK_FALSE(text.blocks.asked[0].bold);
  CHECK(text.blocks.asked[1].families == std::vector<std::string>{"Humanist", "SANS"});
  CHECK(text.blocks.asked[1].bold);
  CHECK(text.blocks.asked[1].italic);
  CHECK(text.blocks.asked[1].language == "zh_TW");
  CHECK(text.blocks.asked[2].bold);
  CHECK_FALSE(text.blocks.asked[2].italic);
  CHECK_FALSE(text.blocks.asked[3].bold);
}

TEST_CASE("accepts a PROTO instance as FontStyle, and ignores a wrong node") {
  TextScene text({"ab"});
  text.style("size", 3.0f);
  text.scene.set<SFNode>(text.geometry, "fontStyle", text.instance_of(text.font_style));
  check_box(text.drawn(), {0, -0.75f}, {3, 2.25f});
  text.scene.set<SFNode>(text.geometry, "fontStyle", text.make("Box"));
  check_box(text.drawn(), {0, -0.25f}, {1, 0.75f});
}

TEST_CASE("tolerates zero, negative and NaN numbers in Text") {
  const float numbers[] = {0, -1, kNaN, std::numeric_limits<float>::infinity(), 3e38f, 1e-38f};
  for (const float size : numbers)
    for (const float other : numbers) {
      TextScene text({"ab", "c"});
      text.style("size", size).style("spacing", other).set("maxExtent", other).set("length", MFFloat{other, size});
      check_promises(text.drawn());
    }
  TextScene text({"ab"});
  text.style("size", -2.0f);
  check_box(text.drawn(), {0, -0.25f}, {1, 0.75f});  // like the default
}

TEST_CASE("draws Text of 100 strings of 100 characters (Table 7-1)") {
  TextScene text({});
  MFString strings;
  for (int i = 0; i < 100; ++i) strings.push_back(SFString(std::string(100, 'x')));
  text.set("string", strings);
  const Mesh mesh = text.drawn();
  check_promises(mesh);
  CHECK(triangles_of(mesh) == 2 * 100 * 100);
  check_box(mesh, {0, -99.25f}, {50, 0.75f});
}

TEST_CASE("leaves out Text that exceeds the memory limit") {
  Limits limits;
  limits.memory = std::size_t{1} << 20;
  SceneGraph scene("text.wrl", std::make_shared<Budget>(limits));
  const NodeId text = scene.create(*built_in_node_type("Text"));
  MFString strings;
  for (int i = 0; i < 100; ++i) strings.push_back(SFString(std::string(1000, 'a')));
  scene.set<MFString>(text, "string", strings);
  Blocks blocks;
  MeshOptions options;
  options.text_shaper = &blocks;
  const Mesh mesh = tessellate(scene, text, options);
  CHECK(mesh.limited);
  CHECK(mesh.positions.size() < 100 * 1000 * 4);
  CHECK(scene.budget()->used(Resource::meshes) == 0);
}
