#include "render/text/font_catalogue.h"

#include <fontconfig/fontconfig.h>

#include <algorithm>
#include <cstring>
#include <string_view>

namespace gs::render {
namespace {

constexpr std::size_t kMaxFonts = 64;  // maximum fonts for one request

struct DestroyPattern {
  void operator()(FcPattern* pattern) const { FcPatternDestroy(pattern); }
};
using Pattern = std::unique_ptr<FcPattern, DestroyPattern>;
struct DestroySet {
  void operator()(FcFontSet* set) const { FcFontSetDestroy(set); }
};

const FcChar8* text(const std::string& bytes) { return reinterpret_cast<const FcChar8*>(bytes.c_str()); }

struct Alias {
  std::string_view family, name;
};
// Families that each browser must have (VRML97 6.20.2), with their names in Fontconfig.
constexpr Alias kAliases[] = {{"SERIF", "serif"}, {"SANS", "sans-serif"}, {"TYPEWRITER", "monospace"}};

Pattern pattern_of(const std::string& family, const vrml::FontRequest& request) {
  Pattern pattern(FcPatternCreate());
  FcPatternAddString(pattern.get(), FC_FAMILY, text(family));
  FcPatternAddInteger(pattern.get(), FC_WEIGHT, request.bold ? FC_WEIGHT_BOLD : FC_WEIGHT_REGULAR);
  FcPatternAddInteger(pattern.get(), FC_SLANT, request.italic ? FC_SLANT_ITALIC : FC_SLANT_ROMAN);
  FcPatternAddBool(pattern.get(), FC_OUTLINE, FcTrue);
  FcPatternAddBool(pattern.get(), FC_SCALABLE, FcTrue);
  FcPatternAddBool(pattern.get(), FC_VARIABLE, FcFalse);
  if (const std::string tag = language_tag(request.language); !tag.empty())
    FcPatternAddString(pattern.get(), FC_LANG, text(tag));
  return pattern;
}

/// Returns acceptable names for a family: its own name, and names that the system declares equivalent.
std::vector<const FcChar8*> names_for(FcPattern* substituted) {
  std::vector<const FcChar8*> names;
  FcValue value;
  FcValueBinding binding;
  for (int i = 0; FcPatternGetWithBinding(substituted, FC_FAMILY, i, &value, &binding) == FcResultMatch; ++i)
    if (binding != FcValueBindingWeak && value.type == FcTypeString) names.push_back(value.u.s);
  return names;
}

bool is_one_of(const FcPattern* font, const std::vector<const FcChar8*>& names) {
  FcChar8* family = nullptr;
  for (int i = 0; FcPatternGetString(font, FC_FAMILY, i, &family) == FcResultMatch; ++i)
    for (const FcChar8* name : names)
      if (FcStrCmpIgnoreCase(family, name) == 0) return true;
  return false;
}

bool usable(const FcPattern* font) {
  FcBool outline = FcFalse, color = FcFalse;
  FcChar8* format = nullptr;
  if (FcPatternGetBool(font, FC_OUTLINE, 0, &outline) != FcResultMatch || !outline) return false;
  if (FcPatternGetBool(font, FC_COLOR, 0, &color) == FcResultMatch && color) return false;
  if (FcPatternGetString(font, FC_FONTFORMAT, 0, &format) != FcResultMatch) return false;
  const auto* name = reinterpret_cast<const char*>(format);
  return std::strcmp(name, "TrueType") == 0 || std::strcmp(name, "CFF") == 0;
}

}  // namespace

struct FontCatalogue::Configuration {
  FcConfig* config = FcInitLoadConfigAndFonts();  // null if the system has no readable configuration
};

FontCatalogue::FontCatalogue() : configuration_(std::make_unique<Configuration>()) {}
FontCatalogue::~FontCatalogue() {
  if (configuration_->config) FcConfigDestroy(configuration_->config);
}

std::vector<FontFile> FontCatalogue::find(const vrml::FontRequest& request) const {
  FcConfig* config = configuration_->config;
  if (!config) return {};
  std::vector<std::string> families = request.families;
  families.emplace_back("SERIF");
  for (const std::string& family : families) {
    const auto* alias = std::find_if(std::begin(kAliases), std::end(kAliases),
                                     [&](const Alias& each) { return each.family == family; });
    const bool generic = alias != std::end(kAliases);
    if (!generic && family.empty()) continue;
    const Pattern pattern = pattern_of(generic ? std::string(alias->name) : family, request);
    FcConfigSubstitute(config, pattern.get(), FcMatchPattern);
    FcDefaultSubstitute(pattern.get());
    FcResult result = FcResultMatch;
    const std::unique_ptr<FcFontSet, DestroySet> set(FcFontSort(config, pattern.get(), FcTrue, nullptr, &result));
    if (!set) continue;
    std::vector<FontFile> files;
    for (int i = 0; i < set->nfont && files.size() < kMaxFonts; ++i) {
      const FcPattern* font = set->fonts[i];
      FcChar8* path = nullptr;
      if (!usable(font) || FcPatternGetString(font, FC_FILE, 0, &path) != FcResultMatch) continue;
      if (files.empty() && !generic && !is_one_of(font, names_for(pattern.get()))) break;
      FontFile file;
      file.path = reinterpret_cast<const char*>(path);
      int weight = FC_WEIGHT_REGULAR, slant = FC_SLANT_ROMAN;
      FcPatternGetInteger(font, FC_INDEX, 0, &file.index);
      FcPatternGetInteger(font, FC_WEIGHT, 0, &weight);
      FcPatternGetInteger(font, FC_SLANT, 0, &slant);
      file.bold = weight >= FC_WEIGHT_DEMIBOLD;
      file.slanted = slant != FC_SLANT_ROMAN;
      files.push_back(std::move(file));
    }
    if (!files.empty()) return files;
  }
  return {};
}

std::string language_tag(const std::string& language) {
  std::string tag = language;
  for (char& c : tag) {
    if (c == '_') c = '-';
    const bool known = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    if (!known) return {};
  }
  return tag;
}

}  // namespace gs::render
