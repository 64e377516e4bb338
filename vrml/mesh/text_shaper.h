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

/// Maximum distance of glyph outlines from the font's curves, in ems, from fine to coarse; indexed by
/// MeshOptions::text_level.
inline constexpr std::array<float, 6> kTextTolerances = {1.0f / 2000, 1.0f / 250, 1.0f / 40,
                                                         1.0f / 14,   1.0f / 40,  1.0f / 8};
/// Coarsest level, for unreadably small text: one bar per word, as dark as its glyphs.
inline constexpr std::size_t kTextBars = kTextTolerances.size() - 1;
/// Second coarsest level, for small text: one rectangle per glyph, textured from a glyph atlas.
inline constexpr std::size_t kTextPictures = kTextTolerances.size() - 2;

/// Triangulated glyph outline, counter-clockwise, in ems, y up, relative to the glyph's origin on the base line.
struct GlyphShape {
  std::vector<glm::vec2> points;
  std::vector<std::uint32_t> triangles;  // three indices into points per triangle
  std::vector<glm::vec2> coordinates;    // at kTextPictures: atlas coordinates per point; else empty
};

/// One glyph of a line; `shape` is null for invisible glyphs.
struct PlacedGlyph {
  std::shared_ptr<const GlyphShape> shape;
  glm::vec2 at{0};  // position of the glyph's origin in ems
};

/// Direction of the characters from the start of their line (VRML97 6.20.3). Horizontal text stands on the X axis;
/// vertical text is centred on the Y axis.
enum class TextDirection : std::uint8_t { right, left, down, up };

/// One line of text that starts at the origin.
struct ShapedText {
  std::vector<PlacedGlyph> glyphs;
  double extent = 0;  // >= 0: total advance in ems along the direction
};

/// Font that a FontStyle requests (VRML97 6.20.2, 6.20.4). Untrusted text.
struct FontRequest {
  std::vector<std::string> families;  // in order of preference; empty means "SERIF"
  bool bold = false, italic = false;
  std::string language;  // "zh_TW"; empty means the locale's language
};

/// Extent of a line above and below its base line, in ems. The sum is 1, so that lines of spacing 1 touch.
struct LineEdges {
  float above = 0.8f, below = 0.2f;
};

/// Font access, implemented outside this room.
class TextShaper {
 public:
  virtual ~TextShaper() = default;
  [[nodiscard]] virtual LineEdges edges(const FontRequest& font) = 0;
  /// Shapes a line. `text` is UTF-8; invalid bytes show as U+FFFD. `level` is an index in kTextTolerances.
  [[nodiscard]] virtual ShapedText shape(const FontRequest& font, std::string_view text, TextDirection direction,
                                         std::size_t level) = 0;
};

}  // namespace gs::vrml
