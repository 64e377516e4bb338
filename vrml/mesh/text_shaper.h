#pragma once

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// How far the outlines of glyphs may lie from the font's curves, in ems, from fine to coarse: MeshOptions::text_level
/// is a place in it.
inline constexpr std::array<float, 6> kTextTolerances = {1.0f / 2000, 1.0f / 250, 1.0f / 40,
                                                         1.0f / 14,   1.0f / 40,  1.0f / 8};
/// The coarsest level: a bar for each word, as dark as its glyphs. For text that is too small to be read.
inline constexpr std::size_t kTextBars = kTextTolerances.size() - 1;
/// The level before it: a rectangle for each glyph, which a picture of all glyphs is cut out of. For small text.
inline constexpr std::size_t kTextPictures = kTextTolerances.size() - 2;

/// A glyph's outline cut into triangles, counter-clockwise. Ems, y up, from the glyph's origin on the base line.
struct GlyphShape {
  std::vector<glm::vec2> points;
  std::vector<std::uint32_t> triangles;  // three indices into points each
  std::vector<glm::vec2> coordinates;    // of kTextPictures: of each point, in the picture of glyphs; else empty
};

/// One glyph of a line; its shape is null where there is nothing to see.
struct PlacedGlyph {
  std::shared_ptr<const GlyphShape> shape;
  glm::vec2 at{0};  // ems, of the glyph's origin
};

/// Where characters go from the start of their line (VRML97 6.20.3). Those of horizontal text stand on the X axis,
/// those of vertical text are centred about the Y axis.
enum class TextDirection : std::uint8_t { right, left, down, up };

/// One line that starts at the origin.
struct ShapedText {
  std::vector<PlacedGlyph> glyphs;
  double extent = 0;  // >= 0: ems that the characters advance by, in their direction
};

/// What a FontStyle asks for (VRML97 6.20.2, 6.20.4). Text of strangers.
struct FontRequest {
  std::vector<std::string> families;  // in the order of preference; empty: "SERIF"
  bool bold = false, italic = false;
  std::string language;  // "zh_TW"; empty: the local one
};

/// Edges of a line about its base line, in ems: `above` plus `below` are 1, so that lines of spacing 1 touch.
struct LineEdges {
  float above = 0.8f, below = 0.2f;
};

/// Fonts, which this room knows nothing of.
class TextShaper {
 public:
  virtual ~TextShaper() = default;
  [[nodiscard]] virtual LineEdges edges(const FontRequest& font) = 0;
  /// `text` is UTF-8; what is not shows as U+FFFD. `level`: of kTextTolerances.
  [[nodiscard]] virtual ShapedText shape(const FontRequest& font, std::string_view text, TextDirection direction,
                                         std::size_t level) = 0;
};

}  // namespace gs::vrml
