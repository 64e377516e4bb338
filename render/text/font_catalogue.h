#pragma once

#include "base/noncopyable.h"
#include "vrml/mesh/text_shaper.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace gs::render {

/// Font file that Fontconfig has found.
struct FontFile {
  std::string path;
  int index = 0;  // index of the face in the file, combined with that of a variable font's instance, as in Fontconfig
  bool bold = false, slanted = false;
  friend bool operator<(const FontFile& a, const FontFile& b) {
    return a.path != b.path ? a.path < b.path : a.index < b.index;
  }
};

/// Fonts of the system, from Fontconfig. One thread at a time.
class FontCatalogue : NonCopyable {
 public:
  FontCatalogue();
  ~FontCatalogue();

  /// Returns fonts for a request, best first. Later fonts supply characters that the first lacks. Takes the first
  /// available family (VRML97 6.20.2): SERIF, SANS and TYPEWRITER are always available, others if the system has them
  /// or an alias. Returns only fonts with outlines. Returns an empty list if the system has none.
  [[nodiscard]] std::vector<FontFile> find(const vrml::FontRequest& request) const;

 private:
  struct Configuration;
  std::unique_ptr<Configuration> configuration_;
};

/// Converts the language of a FontStyle, `language_TERRITORY` (VRML97 6.20.4), to BCP 47, for example "zh-TW".
[[nodiscard]] std::string language_tag(const std::string& language);

}  // namespace gs::render
