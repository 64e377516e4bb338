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

/// Text with the fonts of the system. Outlines are made once for each font, glyph and level, and shared; how much is
/// kept is bounded. Any thread.
class SystemFonts : public vrml::TextShaper {
 public:
  [[nodiscard]] vrml::LineEdges edges(const vrml::FontRequest& font) override;
  [[nodiscard]] vrml::ShapedText shape(const vrml::FontRequest& font, std::string_view text,
                                       vrml::TextDirection direction, std::size_t level) override;
  /// What vrml::kTextPictures of the texts shaped so far is cut out of: one component, 255 where the glyphs are.
  [[nodiscard]] std::shared_ptr<const Image> glyph_picture();
  /// The file of the font that has most of the text; empty where the system has none.
  [[nodiscard]] FontFile main_font(const vrml::FontRequest& font);

 private:
  struct Choice {
    std::vector<FontFile> files;   // best first
    std::vector<FontFace*> faces;  // of the files; null where they are not open yet, or cannot be opened
    std::vector<bool> tried;
    bool bold = false, italic = false;
  };
  using FaceKey = std::tuple<FontFile, bool, bool>;  // slanted, made bold

  Choice& choice(const vrml::FontRequest& font);
  FontFace* face(Choice& choice, std::size_t place);
  FontFace* face_for(Choice& choice, char32_t character, FontFace* last);
  void bound_outlines();

  std::mutex mutex_;
  std::unique_ptr<FontCatalogue> catalogue_;  // made when it is first asked for
  std::map<std::string, Choice> choices_;
  std::set<std::string> languages_;  // that were asked for
  GlyphSheet sheet_;                 // outlives faces_
  std::map<FaceKey, std::unique_ptr<FontFace>> faces_;
};

/// Those that all worlds of the process share.
[[nodiscard]] SystemFonts& system_fonts();

}  // namespace gs::render
