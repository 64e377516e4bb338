#pragma once

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

/// A run of characters of one font and script, in one direction.
struct RunStyle {
  vrml::TextDirection direction = vrml::TextDirection::right;
  std::uint32_t script = 0;  // an ISO 15924 tag, as HarfBuzz has it
  std::string language;      // BCP 47; empty: the local one
};

/// One font file: glyphs by HarfBuzz, outlines by FreeType. One thread at a time.
class FontFace {
 public:
  /// What of a style the font has not, and is made of its outlines.
  struct Synthetic {
    bool slanted = false, bold = false;
  };
  /// Null where the file is no font with outlines. `sheet`: for glyphs of vrml::kTextPictures, outlives it; null:
  /// those are triangles, too.
  static std::unique_ptr<FontFace> open(const std::string& path, int index, Synthetic synthetic,
                                        GlyphSheet* sheet = nullptr);
  ~FontFace();
  FontFace(const FontFace&) = delete;
  FontFace& operator=(const FontFace&) = delete;

  [[nodiscard]] bool has(char32_t character) const;
  [[nodiscard]] vrml::LineEdges edges() const;
  /// Adds the glyphs of the run, which is `text` from `first` to `end`, in the order from left to right, or from top to
  /// bottom. They begin at `pen` on the line's axis, in ems. Returns the extent in ems, not negative.
  double shape(std::span<const char32_t> text, std::size_t first, std::size_t end, const RunStyle& style, double pen,
               std::size_t level, std::vector<vrml::PlacedGlyph>& glyphs);
  /// Bytes of the outlines that it keeps.
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
