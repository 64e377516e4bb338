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

/// Maximum distances between glyph outlines and the curves of the font, in ems, from fine to coarse. The index is
/// MeshOptions::text_level.
inline constexpr std::array<float, 6> kTextTolerances = {1.0f / 2000, 1.0f / 250, 1.0f / 40,
                                                         1.0f / 14,   1.0f / 40,  1.0f / 8};
/// Coarsest level, for text that is too small to read: draws one bar per word, as dark as its glyphs.
inline constexpr std::size_t kTextBars = kTextTolerances.size() - 1;
/// Second coarsest level, for small text: draws one rectangle per glyph, with a texture from a glyph atlas.
inline constexpr std::size_t kTextPictures = kTextTolerances.size() - 2;

/// Triangulated outline of a glyph, counter-clockwise, in ems. y points up; the origin is on the base line.
struct GlyphShape {
  std::vector<glm::vec2> points;
  std::vector<std::uint32_t> triangles;  // three indices of `points` per triangle
  std::vector<glm::vec2> coordinates;  // at level kTextPictures: atlas coordinates per point; otherwise empty
};

/// Glyph at its position in a line. `shape` is null for an invisible glyph.
struct PlacedGlyph {
  std::shared_ptr<const GlyphShape> shape;
  glm::vec2 at{0};  // position of the glyph's origin, in ems
};

/// Direction in which the characters of a line follow each other (VRML97 6.20.3). Horizontal text is on the X axis;
/// vertical text is centred on the Y axis.
enum class TextDirection : std::uint8_t { right, left, down, up };

/// One line of text that starts at the origin.
struct ShapedText {
  std::vector<PlacedGlyph> glyphs;
  double extent = 0;  // total advance in the direction of the text, in ems; >= 0
};

/// Font that a FontStyle requests (VRML97 6.20.2, 6.20.4). Its texts are untrusted.
struct FontRequest {
  std::vector<std::string> families;  // in order of preference; empty means "SERIF"
  bool bold = false, italic = false;
  std::string language;  // "zh_TW"; empty means the locale's language
};

/// Extents of a line above and below its base line, in ems. Their sum is 1, so that lines with spacing 1 touch.
struct LineEdges {
  float above = 0.8f, below = 0.2f;
};

/// Access to fonts. Another room implements it.
class TextShaper {
 public:
  virtual ~TextShaper() = default;
  [[nodiscard]] virtual LineEdges edges(const FontRequest& font) = 0;
  /// Shapes a line of text. `text` is UTF-8; invalid bytes become U+FFFD. `level` is an index in kTextTolerances.
  [[nodiscard]] virtual ShapedText shape(const FontRequest& font, std::string_view text, TextDirection direction,
                                         std::size_t level) = 0;
};

}  // namespace gs::vrml
