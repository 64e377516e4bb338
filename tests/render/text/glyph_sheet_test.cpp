// Tests of small text. Drawn from the glyph atlas, it must look like its outlines.
#include "render/text/glyph_sheet.h"

#include "render/collection/render_scene.h"
#include "render/text/system_fonts.h"
#include "tests/render/drawing.h"
#include "vrml/syntax/parser.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <vector>

namespace gs::glyph_sheet_test {
namespace {

using namespace render;
using namespace render::testing;

/// Returns the share of a rectangle that the atlas marks as inside (half or more).
double inside(const Image& image, const vrml::GlyphShape& shape) {
  const auto pixel_at = [&](const glm::vec2& place) {
    return glm::vec2(place.x, 1 - place.y) * static_cast<float>(GlyphSheet::kSide);
  };
  const glm::vec2 from = pixel_at(shape.coordinates[3]), to = pixel_at(shape.coordinates[1]);  // rows from the top
  std::size_t count = 0;
  for (auto y = static_cast<std::size_t>(from.y); y < static_cast<std::size_t>(to.y); ++y)
    for (auto x = static_cast<std::size_t>(from.x); x < static_cast<std::size_t>(to.x); ++x)
      count += image.pixels[y * GlyphSheet::kSide + x] >= 128 ? 1 : 0;
  return static_cast<double>(count) / (double{GlyphSheet::kPixelsPerEm} * GlyphSheet::kPixelsPerEm);
}

struct World {
  explicit World(const std::string& text) : scene("test.wrl") {
    Diagnostics diagnostics;
    vrml::parse("#VRML V2.0 utf8\n" + text, scene, diagnostics);
    REQUIRE(diagnostics.errors() == 0);
  }
  /// Draws text seen from +Z, from the glyph atlas or as outlines.
  RenderList seen_from(double distance, bool pictures) {
    if (!pictures) return collect(scene, images, meshes, {0, 0, distance});
    RenderScene list(scene, images, geometries, meshes);
    list.gather({}, {0, 0, distance});
    return list.list();
  }
  vrml::SceneGraph scene;
  const Images images;
  const Geometries geometries;
  MeshCache meshes;
};

double mean_green(const Image& image) {
  double sum = 0;
  for (std::size_t i = 1; i < image.pixels.size(); i += 3) sum += image.pixels[i];
  return sum / static_cast<double>(image.pixels.size() / 3);
}

}  // namespace

TEST_CASE("draws the inside of contours into the glyph atlas, at the returned rectangle") {
  GlyphSheet sheet;
  // A square of half an em with a hole of a quarter em of the other orientation (non-zero winding).
  const Contours ring = {{{0, 0}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}},
                         {{0.125, 0.125}, {0.125, 0.375}, {0.375, 0.375}, {0.375, 0.125}}};
  const auto shape = sheet.add(ring);
  REQUIRE(shape);
  REQUIRE(shape->points.size() == 4);
  CHECK(shape->triangles.size() == 6);
  // The rectangle has one more pixel on each side.
  constexpr float kPixel = 1.0f / GlyphSheet::kPixelsPerEm;
  CHECK(shape->points[0] == glm::vec2(-kPixel));
  CHECK(shape->points[2] == glm::vec2(0.5f + kPixel));
  CHECK(inside(*sheet.image(), *shape) == Approx(0.25 - 0.0625));
  // Two contours have one orientation, so the inner contour is not a hole.
  const Contours twice = {ring[0], {{0.125, 0.125}, {0.375, 0.125}, {0.375, 0.375}, {0.125, 0.375}}};
  const auto full = sheet.add(twice);
  REQUIRE(full);
  CHECK(inside(*sheet.image(), *full) == Approx(0.25));
  CHECK(inside(*sheet.image(), *shape) == Approx(0.25 - 0.0625));  // unchanged
  // The glyph covers half of its pixels.
  const auto thin = sheet.add({{{0, 0}, {0.5 * double{kPixel}, 0}, {0.5 * double{kPixel}, 1}, {0, 1}}});
  REQUIRE(thin);
  const glm::vec2 place = (thin->coordinates[0] + thin->coordinates[2]) * 0.5f;
  const auto x = static_cast<std::size_t>(place.x * GlyphSheet::kSide),
             y = static_cast<std::size_t>((1 - place.y) * GlyphSheet::kSide);
  CHECK(int{sheet.image()->pixels[y * GlyphSheet::kSide + x]} == 128);
}

TEST_CASE("limits the glyph sheet, and stores each glyph once") {
  GlyphSheet sheet;
  CHECK(sheet.add({})->triangles.empty());
  CHECK(sheet.add({{{0, 0}, {1, 0}, {0.5, 0}}})->triangles.empty());  // no area
  CHECK_FALSE(sheet.add({{{0, 0}, {6, 0}, {0, 1}}}));                 // too wide
  CHECK_FALSE(sheet.add({{{0, 0}, {HUGE_VAL, 0}, {0, 1}}}));
  const Contours square = {{{0, 0}, {0.9, 0}, {0.9, 0.9}, {0, 0.9}}};
  std::size_t added = 0;
  std::vector<vrml::GlyphShape> shapes;
  for (; added < 5000; ++added) {
    auto shape = sheet.add(square);
    if (!shape) break;
    shapes.push_back(std::move(*shape));
  }
  CHECK(added > 500);
  CHECK(added < 1100);
  const auto image = sheet.image();
  CHECK(image == sheet.image());
  CHECK(image->pixels.size() == std::size_t{GlyphSheet::kSide} * GlyphSheet::kSide);
  for (std::size_t i = 0; i < shapes.size(); i += 50) CHECK(inside(*image, shapes[i]) == Approx(0.81).epsilon(0.05));
}

TEST_CASE("fills a grey area to its density, and completely at 1") {
  GlyphSheet sheet;
  const auto image = sheet.image();
  const auto pixel_at = [&](const glm::vec2& place) {
    return glm::vec2(place.x, 1 - place.y) * static_cast<float>(GlyphSheet::kSide);
  };
  for (const double density : {0.0, 0.1, 0.25, 0.5, 0.7, 1.0, 1.5}) {
    INFO(density);
    const GlyphSheet::Grey grey = GlyphSheet::grey(density, {30, 1});
    const glm::vec2 from = pixel_at({grey.lower.x, grey.upper.y}), to = pixel_at({grey.upper.x, grey.lower.y});
    CHECK((to.x - from.x) * (to.y - from.y) == Approx(30 * 8 * 8));
    double full = 0;
    for (auto y = static_cast<std::size_t>(from.y); y < static_cast<std::size_t>(to.y); ++y)
      for (auto x = static_cast<std::size_t>(from.x); x < static_cast<std::size_t>(to.x); ++x) {
        const int value = image->pixels[y * GlyphSheet::kSide + x];
        CHECK((value == 0 || value == 255));
        full += value > 0 ? 1 : 0;
      }
    const double expected = std::clamp(density, 1.0 / 16, 1.0);
    CHECK(std::abs(full / (30 * 8 * 8) - expected) < 0.05);
  }
  const glm::vec2 solid = pixel_at(GlyphSheet::solid());
  for (int dy = -1; dy <= 0; ++dy)
    for (int dx = -1; dx <= 0; ++dx)
      CHECK(int{image->pixels[static_cast<std::size_t>(solid.y + static_cast<float>(dy)) * GlyphSheet::kSide +
                              static_cast<std::size_t>(solid.x + static_cast<float>(dx))]} == 255);
}

TEST_CASE("draws small text with two triangles per glyph, as bright as its outlines") {
  Drawing drawing;
  drawing.options.width = drawing.options.height = 128;
  std::string lines;
  for (int i = 0; i < 8; ++i) lines += "\"Harbour mast 42\" \"Quai gate bridge\" ";
  World world("Shape { appearance Appearance { material Material { diffuseColor 1 1 1 } } geometry Text { string [ " +
              lines + "] fontStyle FontStyle { family \"SANS\" spacing 1.1 justify [ \"MIDDLE\" \"MIDDLE\" ] } } }");
  const RenderList outlines = world.seen_from(1, false);
  CHECK_FALSE(outlines.items[0].mesh->pictured);
  for (const double distance : {65.0, 100.0, 200.0}) {  // 14, 9 and 5 pixels per em, at kUsualPixelsPerRadian
    INFO(distance);
    const RenderList cut = world.seen_from(distance, true);
    REQUIRE(cut.items.size() == 1);
    CHECK(cut.items[0].mesh->pictured);
    CHECK(cut.items[0].mesh->indices.size() / 3 == 8 * 2 * (13 + 14));
    Camera camera = camera_at({0, 0, static_cast<float>(distance)});
    camera.field_of_view = 128.0f / kUsualPixelsPerRadian;
    for (const int samples : {1, 2, 3, 4}) {  // 4 are pixels in software, 3 are not
      INFO(samples << " samples");
      drawing.options.samples = samples;
      const double as_cut = mean_green(drawing.draw(cut, camera)),
                   as_outlines = mean_green(drawing.draw(outlines, camera));
      CHECK(as_outlines > 1);
      CHECK(as_cut == Approx(as_outlines).epsilon(0.1));
    }
  }
}

TEST_CASE("keeps transparent, textured or singly listed text unchanged") {
  const std::string text = "geometry Text { string \"Gate\" }";
  World textured("Shape { appearance Appearance { texture PixelTexture { image 1 1 3 0xFF0000 } } " + text + " }");
  CHECK_FALSE(textured.seen_from(100, true).items[0].mesh->pictured);
  Drawing drawing;
  drawing.options.width = drawing.options.height = 64;
  World half("Shape { appearance Appearance { material Material { diffuseColor 1 1 1 transparency 0.5 } } " + text +
             " }");
  World whole("Shape { appearance Appearance { material Material { diffuseColor 1 1 1 } } " + text + " }");
  Camera camera = camera_at({1, 0, 100});
  camera.field_of_view = 64.0f / kUsualPixelsPerRadian;
  const RenderList seen_half = half.seen_from(100, true), seen_whole = whole.seen_from(100, true);
  CHECK(seen_half.items[0].mesh->pictured);
  const double of_half = mean_green(drawing.draw(seen_half, camera)),
               of_whole = mean_green(drawing.draw(seen_whole, camera));
  CHECK(of_whole > 1);
  CHECK(of_half == Approx(of_whole / 2).epsilon(0.05));
}

TEST_CASE("draws unreadably small text as one bar per word, as bright as its letters") {
  World world(
      "Shape { appearance Appearance { material Material { diffuseColor 1 1 1 } } geometry Text { string "
      "\"ten thousand labels\" } }");
  Drawing drawing;
  drawing.options.width = drawing.options.height = 64;
  const RenderList list = world.seen_from(300, true);
  CHECK(list.items[0].mesh->indices.size() / 3 == 2 * 3);
  // The viewer is nearer, and at the distance from which letters are drawn.
  World letters(
      "Shape { appearance Appearance { material Material { diffuseColor 1 1 1 } } geometry Text { string "
      "\"ten thousand labels\" } }");
  const RenderList as_letters = letters.seen_from(20, false);
  Camera camera = camera_at({5, 0, 300});
  camera.field_of_view = 64.0f / kUsualPixelsPerRadian;
  for (const int samples : {1, 4}) {
    drawing.options.samples = samples;
    const double of_words = mean_green(drawing.draw(list, camera)),
                 of_letters = mean_green(drawing.draw(as_letters, camera));
    CHECK(of_letters > 0.5);
    CHECK(of_words == Approx(of_letters).epsilon(0.2));
  }
}

}  // namespace gs::glyph_sheet_test
