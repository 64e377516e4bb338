#pragma once

#include "vrml/mesh/text_shaper.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace gs::render {

/// Font file known to Fontconfig.
struct FontFile {
  std::string path;
  int index = 0;  // index of the face in the file, and of the instance of a variable font
  bool bold = false, slanted = false;
  friend bool operator<(const FontFile& a, const FontFile& b) {
    return a.path != b.path ? a.path < b.path : a.index < b.index;
  }
};

/// Fonts of the system, through Fontconfig. Used by one thread at a time.
class FontCatalogue {
 public:
  FontCatalogue();
  ~FontCatalogue();
  FontCatalogue(const FontCatalogue&) = delete;
  FontCatalogue& operator=(const FontCatalogue&) = delete;

  /// Returns fonts for the request, best first; later fonts supply missing characters. The first available family
  /// counts (VRML97 6.20.2): SERIF, SANS and TYPEWRITER always exist; others exist if the system has them or an alias.
  /// Only fonts with outlines; empty if the system has none.
  [[nodiscard]] std::vector<FontFile> find(const vrml::FontRequest& request) const;

 private:
  struct Configuration;
  std::unique_ptr<Configuration> configuration_;
};

/// Converts the language of a FontStyle, `language_TERRITORY` (VRML97 6.20.4), to BCP 47: "zh-TW".
[[nodiscard]] std::string language_tag(const std::string& language);

}  // namespace gs::render
