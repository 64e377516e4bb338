#pragma once

#include "render/image/image.h"
#include "render/text/glyph_outline.h"
#include "vrml/mesh/text_shaper.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

namespace gs::render {

/// Glyphs beside each other in one picture, of which small text takes rectangles: two triangles a glyph. Seen at half
/// of the picture, with a linear filter and no smaller copies, edges are as sharp as those of outlines. One thread at a
/// time.
class GlyphSheet {
 public:
  static constexpr std::uint32_t kSide = 1024, kPixelsPerEm = 32;

  /// A rectangle around what the contours enclose by the rule of non-zero winding (ems), which stands in the picture
  /// from now on; one without triangles where that is nothing. None where there is no room for it.
  [[nodiscard]] std::optional<vrml::GlyphShape> add(const Contours& contours);
  /// A place where the picture is 255 all around.
  [[nodiscard]] static glm::vec2 solid() {
    const Grey all = grey(1, glm::vec2(0.25f));
    return (all.lower + all.upper) * 0.5f;
  }
  /// A rectangle of the picture for one of `size` ems, of which a part of `density` (0 to 1) is 255: pixels here and
  /// there, as in the letters of a word that nobody can read.
  struct Grey {
    glm::vec2 lower, upper;
  };
  [[nodiscard]] static Grey grey(double density, const glm::vec2& size);
  /// What it holds now, of one component.
  [[nodiscard]] std::shared_ptr<const Image> image();

 private:
  [[nodiscard]] std::uint8_t* place(std::uint32_t width, std::uint32_t height);

  Image image_;
  std::shared_ptr<const Image> shown_;     // as it was when it was last asked for; null: it has changed
  std::uint32_t x_ = 0, y_ = 0, row_ = 0;  // where the next glyph goes; height of its row
};

}  // namespace gs::render
