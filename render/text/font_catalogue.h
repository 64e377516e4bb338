#pragma once

#include "vrml/mesh/text_shaper.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace gs::render {

/// A font file that Fontconfig knows.
struct FontFile {
  std::string path;
  int index = 0;  // of the face in the file, and of the instance of a variable font
  bool bold = false, slanted = false;
  friend bool operator<(const FontFile& a, const FontFile& b) {
    return a.path != b.path ? a.path < b.path : a.index < b.index;
  }
};

/// The fonts of the system, through Fontconfig. One thread at a time.
class FontCatalogue {
 public:
  FontCatalogue();
  ~FontCatalogue();
  FontCatalogue(const FontCatalogue&) = delete;
  FontCatalogue& operator=(const FontCatalogue&) = delete;

  /// Fonts for the request, best first; those behind the first one fill in characters that it lacks. The first
  /// family that there is counts (VRML97 6.20.2): SERIF, SANS and TYPEWRITER always are, others where the system has
  /// them or names a font that stands for them. Only fonts with outlines; empty where the system has none.
  [[nodiscard]] std::vector<FontFile> find(const vrml::FontRequest& request) const;

 private:
  struct Configuration;
  std::unique_ptr<Configuration> configuration_;
};

/// The language of a FontStyle, `language_TERRITORY` (VRML97 6.20.4), as BCP 47 writes it: "zh-TW".
[[nodiscard]] std::string language_tag(const std::string& language);

}  // namespace gs::render
