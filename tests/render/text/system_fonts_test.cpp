#include "render/text/system_fonts.h"

#include "render/text/font_catalogue.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace gs::render::system_fonts_test {
namespace {

using vrml::FontRequest;
using vrml::PlacedGlyph;
using vrml::ShapedText;
using vrml::TextDirection;

FontRequest family(const char* name) {
  FontRequest request;
  request.families = {name};
  return request;
}

/// Returns the font file that supplies most of a text. Returns an empty result if the system has no fonts.
FontFile main_font(const FontRequest& request) {
  static const FontCatalogue catalogue;
  const std::vector<FontFile> found = catalogue.find(request);
  return found.empty() ? FontFile{} : found.front();
}

const FontRequest kFamilies[] = {family("SERIF"), family("SANS"), family("TYPEWRITER")};

/// Font file read with FreeType alone.
struct FreeTypeFont {
  explicit FreeTypeFont(const FontFile& file) {
    REQUIRE_FALSE(file.path.empty());
    REQUIRE(FT_Init_FreeType(&library) == 0);
    REQUIRE(FT_New_Face(library, file.path.c_str(), file.index, &face) == 0);
  }
  ~FreeTypeFont() {
    FT_Done_Face(face);
    FT_Done_FreeType(library);
  }
  /// Returns the advance in ems.
  [[nodiscard]] double advance(char32_t c) const {
    REQUIRE(FT_Load_Char(face, c, FT_LOAD_NO_SCALE) == 0);
    return static_cast<double>(face->glyph->metrics.horiAdvance) / face->units_per_EM;
  }
  /// Returns the area that FreeType's rasteriser covers, in square ems.
  [[nodiscard]] double area(char32_t c) const {
    constexpr int kPixels = 400;
    REQUIRE(FT_Set_Pixel_Sizes(face, kPixels, kPixels) == 0);
    REQUIRE(FT_Load_Char(face, c, FT_LOAD_RENDER | FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP) == 0);
    const FT_Bitmap& bitmap = face->glyph->bitmap;
    double sum = 0;
    for (unsigned y = 0; y < bitmap.rows; ++y)
      for (unsigned x = 0; x < bitmap.width; ++x) sum += bitmap.buffer[y * static_cast<unsigned>(bitmap.pitch) + x];
    return sum / 255 / kPixels / kPixels;
  }
  FT_Library library = nullptr;
  FT_Face face = nullptr;
};

std::string utf8(char32_t c) {
  std::string bytes;
  if (c < 0x80) {
    bytes += static_cast<char>(c);
  } else if (c < 0x800) {
    bytes += static_cast<char>(0xC0 | c >> 6);
    bytes += static_cast<char>(0x80 | (c & 0x3F));
  }
  return bytes;
}

double area_of(const ShapedText& text) {
  double sum = 0;
  for (const PlacedGlyph& glyph : text.glyphs)
    for (std::size_t i = 0; i < glyph.shape->triangles.size(); i += 3) {
      const glm::dvec2 a(glyph.shape->points[glyph.shape->triangles[i]]);
      const glm::dvec2 b = glm::dvec2(glyph.shape->points[glyph.shape->triangles[i + 1]]) - a,
                       c = glm::dvec2(glyph.shape->points[glyph.shape->triangles[i + 2]]) - a;
      sum += std::abs(b.x * c.y - b.y * c.x) / 2;
    }
  return sum;
}

std::size_t triangles_of(const ShapedText& text) {
  std::size_t count = 0;
  for (const PlacedGlyph& glyph : text.glyphs) count += glyph.shape->triangles.size() / 3;
  return count;
}

/// Returns the position of the first glyph of a character in a line.
float place_of(SystemFonts& fonts, const ShapedText& line, const char* character) {
  const ShapedText alone = fonts.shape(kFamilies[1], character, TextDirection::right, 1);
  REQUIRE(alone.glyphs.size() == 1);
  for (const PlacedGlyph& glyph : line.glyphs)
    if (glyph.shape == alone.glyphs[0].shape) return glyph.at.x;
  FAIL("no such glyph");
  return 0;
}

constexpr const char* kAlef = "\xD7\x90";
constexpr const char* kBet = "\xD7\x91";
constexpr const char* kGimel = "\xD7\x92";
const std::string kHebrew = std::string(kAlef) + kBet + kGimel;

}  // namespace

TEST_CASE("advances characters by their natural widths (VRML97 6.20.3)") {
  SystemFonts fonts;
  for (const FontRequest& request : kFamilies) {
    const FreeTypeFont reference(main_font(request));
    for (char32_t c = 0x20; c < 0x7F; ++c) {
      INFO(request.families[0] << " character " << static_cast<unsigned>(c));
      CHECK(fonts.shape(request, utf8(c), TextDirection::right, 1).extent == Approx(reference.advance(c)));
    }
    double sum = 0;
    for (const char32_t c : U"Hill mound") sum += c ? reference.advance(c) : 0;  // contains no kerned pairs
    CHECK(fonts.shape(request, "Hill mound", TextDirection::right, 1).extent == Approx(sum));
  }
}

TEST_CASE("covers the area that FreeType's rasteriser covers") {
  SystemFonts fonts;
  for (const FontRequest& request : kFamilies) {
    const FreeTypeFont reference(main_font(request));
    for (char32_t c = 0x21; c < 0x100; ++c) {
      if ((c >= 0x7F && c <= 0xA0) || c == 0xAD) continue;  // a soft hyphen is visible at line ends only
      INFO(request.families[0] << " character " << static_cast<unsigned>(c));
      const double expected = reference.area(c);
      CHECK(std::abs(area_of(fonts.shape(request, utf8(c), TextDirection::right, 0)) - expected) <
            0.008 * expected + 0.0003);
      CHECK(std::abs(area_of(fonts.shape(request, utf8(c), TextDirection::right, 1)) - expected) <
            0.03 * expected + 0.001);
    }
  }
}

TEST_CASE("has glyphs for all of ISO 8859-1 (VRML97 7.3.3)") {
  SystemFonts fonts;
  for (const FontRequest& request : kFamilies) {
    const FontFile file = main_font(request);
    const auto face = FontFace::open(file.path, file.index, {});
    REQUIRE(face);
    for (char32_t c = 0x20; c < 0x100; ++c)
      if (c < 0x7F || c > 0x9F) CHECK(face->has(c));
  }
}

TEST_CASE("makes coarser levels of fewer triangles and equal extent") {
  SystemFonts fonts;
  const std::string text = "GhostSpace & 0689";
  const ShapedText fine = fonts.shape(kFamilies[0], text, TextDirection::right, 0),
                   middle = fonts.shape(kFamilies[0], text, TextDirection::right, 1),
                   coarse = fonts.shape(kFamilies[0], text, TextDirection::right, 2);
  CHECK(triangles_of(middle) < 0.6 * static_cast<double>(triangles_of(fine)));
  CHECK(triangles_of(coarse) < 0.6 * static_cast<double>(triangles_of(middle)));
  CHECK(fine.extent == coarse.extent);
  const ShapedText least = fonts.shape(kFamilies[0], text, TextDirection::right, 3),
                   bars = fonts.shape(kFamilies[0], text, TextDirection::right, vrml::kTextBars);
  CHECK(triangles_of(least) < triangles_of(coarse));
  CHECK(bars.glyphs.size() == 3);  // words
  CHECK(triangles_of(bars) == 2 * bars.glyphs.size());
  CHECK(area_of(bars) > area_of(least));  // the glyph atlas fills a part of the bars
  CHECK(area_of(bars) < 2 * area_of(least));
  const ShapedText rectangles = fonts.shape(kFamilies[0], text, TextDirection::right, vrml::kTextPictures);
  CHECK(triangles_of(rectangles) == 2 * (text.size() - 2));
  CHECK(rectangles.extent == fine.extent);
  CHECK(area_of(coarse) == Approx(area_of(fine)).epsilon(0.15));
}

TEST_CASE("makes each glyph once and shares it") {
  SystemFonts fonts;
  const ShapedText text = fonts.shape(kFamilies[1], "noon", TextDirection::right, 1);
  REQUIRE(text.glyphs.size() == 4);
  CHECK(text.glyphs[0].shape == text.glyphs[3].shape);
  CHECK(text.glyphs[1].shape == text.glyphs[2].shape);
  CHECK(text.glyphs[0].shape != text.glyphs[1].shape);
  CHECK(fonts.shape(kFamilies[1], "n", TextDirection::right, 1).glyphs[0].shape == text.glyphs[0].shape);
}

TEST_CASE("chooses the first available family of VRML97 6.20.2") {
  SystemFonts fonts;
  const std::string serif = main_font(family("SERIF")).path, sans = main_font(family("SANS")).path,
                    typewriter = main_font(family("TYPEWRITER")).path;
  CHECK(std::set<std::string>{serif, sans, typewriter}.size() == 3);
  CHECK(main_font({}).path == serif);
  CHECK(main_font(family("")).path == serif);
  CHECK(main_font(family("No Such Family 77")).path == serif);
  CHECK(main_font(family("sans")).path != typewriter);  // names are case-sensitive, and no family has this name
  FontRequest several;
  several.families = {"No Such Family 77", "TYPEWRITER", "SANS"};
  CHECK(main_font(several).path == typewriter);
  CHECK(main_font(family("DejaVu Sans")).path.find("DejaVuSans") != std::string::npos);
  // All characters of a monospaced font have equal widths.
  const double width = fonts.shape(family("TYPEWRITER"), "i", TextDirection::right, 1).extent;
  for (const char* c : {"W", ".", "m", "1"})
    CHECK(fonts.shape(family("TYPEWRITER"), c, TextDirection::right, 1).extent == Approx(width));
  CHECK(fonts.shape(family("SERIF"), "W", TextDirection::right, 1).extent >
        2 * fonts.shape(family("SERIF"), "i", TextDirection::right, 1).extent);
}

TEST_CASE("draws bold and italic styles, also of fonts without them") {  // 6.20.2
  SystemFonts fonts;
  // Returns the slant of the upper half of the letter I, and the area of the letter.
  const auto measure = [&](const char* name, bool bold, bool italic) {
    FontRequest request = family(name);
    request.bold = bold;
    request.italic = italic;
    const ShapedText text = fonts.shape(request, "I", TextDirection::right, 0);
    REQUIRE(text.glyphs.size() == 1);
    double upper = -1e9, lower = -1e9, top = 0;
    for (const glm::vec2& p : text.glyphs[0].shape->points) top = std::max(top, double{p.y});
    for (const glm::vec2& p : text.glyphs[0].shape->points)
      (p.y > 0.9 * top ? upper : lower) = std::max(p.y > 0.9 * top ? upper : lower, double{p.x});
    double bottom = -1e9;
    for (const glm::vec2& p : text.glyphs[0].shape->points)
      if (p.y < 0.1 * top) bottom = std::max(bottom, double{p.x});
    return std::pair{upper - bottom, area_of(text)};
  };
  for (const char* name : {"SERIF", "SANS", "TYPEWRITER"}) {
    INFO(name);
    const auto plain = measure(name, false, false), bold = measure(name, true, false),
               italic = measure(name, false, true), both = measure(name, true, true);
    CHECK(std::abs(plain.first) < 0.02);
    CHECK(std::abs(bold.first) < 0.02);
    CHECK(italic.first > 0.05);
    CHECK(both.first > 0.05);
    CHECK(bold.second > 1.15 * plain.second);
    CHECK(both.second > 1.15 * italic.second);
  }
}

TEST_CASE("emboldens and slants a font that has plain letters only") {
  SystemFonts fonts;
  const FontFile file = main_font(family("SANS"));
  std::vector<PlacedGlyph> plain, made;
  const char32_t text[] = {U'I'};
  (void)FontFace::open(file.path, file.index, {})->shape(text, 0, 1, {}, 0, 0, plain);
  (void)FontFace::open(file.path, file.index, {true, true})->shape(text, 0, 1, {}, 0, 0, made);
  const auto box = [](const PlacedGlyph& glyph) {
    glm::vec2 lower(1e9f), upper(-1e9f);
    for (const glm::vec2& p : glyph.shape->points) lower = glm::min(lower, p), upper = glm::max(upper, p);
    return std::pair{lower, upper};
  };
  REQUIRE(plain.size() == 1);
  REQUIRE(made.size() == 1);
  CHECK(box(made[0]).second.x - box(made[0]).first.x > box(plain[0]).second.x - box(plain[0]).first.x + 0.1f);
}

TEST_CASE("runs Hebrew from right to left and its numbers from left to right, in lines of either direction") {
  SystemFonts fonts;
  for (const TextDirection direction : {TextDirection::right, TextDirection::left}) {
    const ShapedText line = fonts.shape(kFamilies[1], kHebrew, direction, 1);
    REQUIRE(line.glyphs.size() == 3);
    CHECK(place_of(fonts, line, kAlef) > place_of(fonts, line, kBet));
    CHECK(place_of(fonts, line, kBet) > place_of(fonts, line, kGimel));
    const ShapedText number = fonts.shape(kFamilies[1], kHebrew + " 12", direction, 1);
    CHECK(place_of(fonts, number, "1") < place_of(fonts, number, "2"));
  }
  // The text is embedded in a left-to-right line and in a right-to-left line.
  const ShapedText right = fonts.shape(kFamilies[1], "a" + kHebrew + "z", TextDirection::right, 1);
  CHECK(place_of(fonts, right, "a") < place_of(fonts, right, kGimel));
  CHECK(place_of(fonts, right, kAlef) < place_of(fonts, right, "z"));
  const ShapedText left = fonts.shape(kFamilies[1], kHebrew + " az", TextDirection::left, 1);
  CHECK(place_of(fonts, left, "a") < place_of(fonts, left, "z"));
  CHECK(place_of(fonts, left, "z") < place_of(fonts, left, kGimel));
}

TEST_CASE("advances to the left if leftToRight is FALSE (VRML97 6.20.3)") {
  SystemFonts fonts;
  const ShapedText right = fonts.shape(kFamilies[1], "abc", TextDirection::right, 1),
                   left = fonts.shape(kFamilies[1], "abc", TextDirection::left, 1);
  CHECK(left.extent == Approx(right.extent));
  CHECK(place_of(fonts, right, "a") == Approx(0).margin(1e-6));
  CHECK(place_of(fonts, left, "a") < 0);
  CHECK(place_of(fonts, left, "b") < place_of(fonts, left, "a"));
  CHECK(place_of(fonts, left, "c") < place_of(fonts, left, "b"));
  CHECK(place_of(fonts, left, "c") == Approx(-left.extent));
}

TEST_CASE("stacks characters of vertical text, centred (VRML97 6.20.3)") {
  SystemFonts fonts;
  for (const bool down : {true, false}) {
    const ShapedText line = fonts.shape(kFamilies[1], "HIH", down ? TextDirection::down : TextDirection::up, 1);
    REQUIRE(line.glyphs.size() == 3);
    CHECK(line.extent > 2.5);
    for (std::size_t i = 0; i < 3; ++i) {
      // Characters follow from top to bottom. Their boxes are centred, within their part of the line.
      float left = 1e9f, right = -1e9f, top = -1e9f, bottom = 1e9f;
      for (const glm::vec2& p : line.glyphs[i].shape->points) {
        left = std::min(left, p.x + line.glyphs[i].at.x);
        right = std::max(right, p.x + line.glyphs[i].at.x);
        top = std::max(top, p.y + line.glyphs[i].at.y);
        bottom = std::min(bottom, p.y + line.glyphs[i].at.y);
      }
      const double first = (down ? 0 : line.extent) - line.extent * static_cast<double>(i) / 3;
      CHECK(top < first + 0.01);
      CHECK(bottom > first - line.extent / 3 - 0.01);
      CHECK(left + right == Approx(0).margin(0.1));
    }
  }
}

TEST_CASE("takes missing characters from another font") {
  SystemFonts fonts;
  // Some monospaced fonts have Hebrew, others do not.
  const ShapedText text = fonts.shape(family("TYPEWRITER"), kAlef, TextDirection::right, 1);
  REQUIRE(text.glyphs.size() == 1);
  // private-use character
  const ShapedText missing = fonts.shape(family("TYPEWRITER"), "\xF3\xB0\x80\x80", TextDirection::right, 1);
  CHECK((missing.glyphs.empty() || missing.glyphs[0].shape != text.glyphs[0].shape));
}

TEST_CASE("advances at blanks, but not at controls") {
  SystemFonts fonts;
  const double blank = fonts.shape(kFamilies[1], " ", TextDirection::right, 1).extent;
  CHECK(blank > 0);
  CHECK(fonts.shape(kFamilies[1], "\t", TextDirection::right, 1).extent == Approx(blank));
  CHECK(fonts.shape(kFamilies[1], "\n", TextDirection::right, 1).extent == Approx(blank));
  CHECK(fonts.shape(kFamilies[1], "\x01\x7F\xC2\x9B", TextDirection::right, 1).extent == 0);
  CHECK(fonts.shape(kFamilies[1], "", TextDirection::right, 1).extent == 0);
}

TEST_CASE("shapes any bytes in any direction") {
  SystemFonts fonts;
  std::mt19937 random(11);
  for (int round = 0; round < 60; ++round) {
    std::string bytes(random() % 200, '\0');
    for (char& byte : bytes) byte = static_cast<char>(round % 2 == 0 ? random() : 0xD0 + random() % 12);
    FontRequest request = kFamilies[round % 3];
    request.language = round % 5 == 0 ? bytes.substr(0, 8) : "";
    const auto direction = static_cast<TextDirection>(round % 4);
    const ShapedText text = fonts.shape(request, bytes, direction, static_cast<std::size_t>(round) % 3);
    CHECK(text.extent >= 0);
    CHECK(std::isfinite(text.extent));
    for (const PlacedGlyph& glyph : text.glyphs) CHECK((glyph.shape && std::isfinite(glyph.at.x + glyph.at.y)));
  }
  // One letter has thousands of marks, and a run is longer than the shaper's maximum.
  std::string marks = "a";
  for (int i = 0; i < 20'000; ++i) marks += "\xCC\x81";
  CHECK(std::isfinite(fonts.shape(kFamilies[0], marks, TextDirection::right, 2).extent));
  const ShapedText runs = fonts.shape(kFamilies[2], std::string(10'000, 'x'), TextDirection::left, 2);
  CHECK(runs.glyphs.size() == 10'000);
  CHECK(runs.extent == Approx(10'000 * fonts.shape(kFamilies[2], "x", TextDirection::left, 2).extent));
}

TEST_CASE("accepts any number of fonts and languages") {
  SystemFonts fonts;
  const double plain = fonts.shape({}, "nn", TextDirection::right, 1).extent;
  for (int i = 0; i < 700; ++i) {
    FontRequest request;
    request.families = {"No Such Family " + std::to_string(i % 40)};
    request.language = "q" + std::to_string(i);
    const ShapedText text = fonts.shape(request, "nn", TextDirection::right, 1);
    CHECK(text.glyphs.size() == 2);
    if (i >= 600) CHECK(text.extent == Approx(plain));  // beyond the limit, the plain font
  }
}

TEST_CASE("shapes text in the language of its FontStyle") {  // 6.20.4
  CHECK(language_tag("zh_TW") == "zh-TW");
  CHECK(language_tag("en") == "en");
  CHECK(language_tag("").empty());
  CHECK(language_tag("../x").empty());
}

}  // namespace gs::render::system_fonts_test
