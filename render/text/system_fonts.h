#pragma once

#include "render/text/font_catalogue.h"
#include "render/text/font_face.h"
#include "render/text/glyph_sheet.h"
#include "vrml/mesh/text_shaper.h"

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace gs::render {

/// Text shaper with the fonts of the system. Makes outlines once per font, glyph and level, and shares them. The cache
/// is bounded. Thread-safe.
class SystemFonts : public vrml::TextShaper {
 public:
  [[nodiscard]] vrml::LineEdges edges(const vrml::FontRequest& font) override;
  [[nodiscard]] vrml::ShapedText shape(const vrml::FontRequest& font, std::string_view text,
                                       vrml::TextDirection direction, std::size_t level) override;
  /// Returns the glyph atlas for Texts at the level kTextPictures. It holds the glyphs of all texts shaped so far, with
  /// one component: 255 inside glyphs.
  [[nodiscard]] std::shared_ptr<const Image> glyph_picture();

 private:
  struct Choice {
    std::vector<FontFile> files;   // best first
    std::vector<FontFace*> faces;  // face of each file; null if it is not open yet or unusable
    std::vector<bool> tried;
    bool bold = false, italic = false;
  };
  using FaceKey = std::tuple<FontFile, bool, bool>;  // file; imitates italics; imitates bold

  Choice& choice(const vrml::FontRequest& font);
  FontFace* face(Choice& choice, std::size_t place);
  FontFace* face_for(Choice& choice, char32_t character, FontFace* last);
  void bound_outlines();

  std::mutex mutex_;
  std::unique_ptr<FontCatalogue> catalogue_;  // made at first use
  std::map<std::string, Choice> choices_;
  std::set<std::string> languages_;  // languages that were requested so far
  GlyphSheet sheet_;                 // must outlive faces_
  std::map<FaceKey, std::unique_ptr<FontFace>> faces_;
};

/// Returns the shaper that all worlds of the process share.
[[nodiscard]] SystemFonts& system_fonts();

}  // namespace gs::render
