#pragma once

#include "base/noncopyable.h"
#include "render/text/glyph_outline.h"
#include "render/text/glyph_sheet.h"
#include "vrml/mesh/text_shaper.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>

namespace gs::render {

/// Style of a run, that is, of characters with one font, script and direction.
struct RunStyle {
  vrml::TextDirection direction = vrml::TextDirection::right;
  std::uint32_t script = 0;  // ISO 15924 tag as in HarfBuzz
  std::string language;  // BCP 47; empty means the language of the locale
};

/// Font of one file. HarfBuzz shapes text, FreeType supplies outlines. One thread at a time.
class FontFace : NonCopyable {
 public:
  /// Style properties that the font lacks. They are imitated with its outlines.
  struct Synthetic {
    bool slanted = false, bold = false;
  };
  /// Opens a font. Returns null if the file is not a font with outlines. `sheet` is the atlas for glyphs of
  /// vrml::kTextPictures and must outlive the face. If `sheet` is null, these glyphs are triangles.
  static std::unique_ptr<FontFace> open(const std::string& path, int index, Synthetic synthetic,
                                        GlyphSheet* sheet = nullptr);
  ~FontFace();

  [[nodiscard]] bool has(char32_t character) const;
  [[nodiscard]] vrml::LineEdges edges() const;
  /// Adds the glyphs of the run `text[first, end)` in visual order: left to right or top to bottom. They begin at `pen`
  /// on the axis of the line, in ems. Returns the extent of the run in ems, at least 0.
  double shape(std::span<const char32_t> text, std::size_t first, std::size_t end, const RunStyle& style, double pen,
               std::size_t level, std::vector<vrml::PlacedGlyph>& glyphs);
  /// Returns the bytes of cached outlines.
  [[nodiscard]] std::size_t kept() const { return kept_; }
  void forget_outlines();

 private:
  struct Handles;
  FontFace(std::unique_ptr<Handles> handles, Synthetic synthetic, GlyphSheet* sheet);
  std::shared_ptr<const vrml::GlyphShape> glyph(std::uint32_t index, std::size_t level);
  vrml::GlyphShape picture_of(std::uint32_t index);
  [[nodiscard]] Contours contours(std::uint32_t glyph, double tolerance);

  std::unique_ptr<Handles> handles_;
  GlyphSheet* sheet_;
  Synthetic synthetic_;
  double units_per_em_ = 1;
  std::array<std::unordered_map<std::uint32_t, std::shared_ptr<const vrml::GlyphShape>>, vrml::kTextTolerances.size()>
      outlines_;
  std::size_t kept_ = 0;
  vrml::PolygonTriangulator triangulator_;
};

}  // namespace gs::render
