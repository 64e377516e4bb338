#include "app/interface/base/fonts.h"

#include "app/interface/base/sight_order.h"
#include "render/text/font_catalogue.h"
#include "render/text/utf8.h"
#include "vrml/mesh/text_shaper.h"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

constexpr char32_t kFirstPrivate = 0xE000, kLastPrivate = 0xF8FF, kLastOfPlane = 0xFFFF;

// Usual locations of a font with Latin, Greek and Cyrillic on Linux.
constexpr const char* kFonts[] = {
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/TTF/DejaVuSans.ttf",
    "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
    "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
};
// Unicode ranges that are rendered at first: Latin, Greek, Cyrillic, punctuation and arrows.
constexpr ImWchar kRanges[] = {0x0020, 0x024F, 0x0370, 0x052F, 0x2010, 0x2044, 0x2190, 0x21FF, 0};

bool is_drawn_at_first(char32_t character) {
  for (const ImWchar* range = kRanges; range[0] != 0; range += 2)
    if (character >= range[0] && character <= range[1]) return true;
  return false;
}

void add_character(std::string& text, char32_t c) {
  if (c < 0x80) {
    text += static_cast<char>(c);
  } else if (c < 0x800) {
    text += static_cast<char>(0xC0 | (c >> 6));
    text += static_cast<char>(0x80 | (c & 0x3F));
  } else {
    text += static_cast<char>(0xE0 | (c >> 12));
    text += static_cast<char>(0x80 | ((c >> 6) & 0x3F));
    text += static_cast<char>(0x80 | (c & 0x3F));
  }
}

/// Rendered glyph: the coverage of its pixels on the screen.
struct GlyphPicture {
  int width = 0, height = 0;
  float left = 0, top = 0, advance = 0;  // relative to the pen; `top` and `advance` from the baseline, upwards
  std::vector<unsigned char> coverage;
};

}  // namespace

struct InterfaceFonts::Glyphs {
  ImGuiContext* context = nullptr;
  float pixels = 0, built_pixels = 0;
  std::set<char32_t> wanted;  // characters to render besides kRanges
  std::size_t built = 0;                   // number of `wanted` glyphs already rendered
  std::map<char32_t, char32_t> stand_ins;  // private-use characters for those outside the BMP
  std::map<char32_t, char32_t> stand_for;  // inverse of stand_ins
  FT_Library library = nullptr;
  std::vector<render::FontFile> files;  // best match first; loaded on demand
  std::vector<FT_Face> faces;           // by `files`; null if not opened yet or unusable
  std::vector<bool> tried;

  ~Glyphs() {
    for (const FT_Face face : faces)
      if (face) FT_Done_Face(face);
    if (library) FT_Done_FreeType(library);
  }

  FT_Face face_with(char32_t character) {
    if (!library) {
      if (FT_Init_FreeType(&library) != 0) {
        library = nullptr;
        return nullptr;
      }
      vrml::FontRequest request;
      request.families = {"SANS"};
      files = render::FontCatalogue().find(request);
      faces.assign(files.size(), nullptr);
      tried.assign(files.size(), false);
    }
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (!tried[i]) {
        tried[i] = true;
        if (FT_New_Face(library, files[i].path.c_str(), files[i].index, &faces[i]) != 0) faces[i] = nullptr;
      }
      if (faces[i] && FT_Get_Char_Index(faces[i], character) != 0) return faces[i];
    }
    return nullptr;
  }

  std::optional<GlyphPicture> picture_of(char32_t character) {
    const FT_Face face = face_with(character);
    if (!face || FT_Set_Pixel_Sizes(face, 0, static_cast<FT_UInt>(std::lround(pixels))) != 0) return std::nullopt;
    if (FT_Load_Char(face, character, FT_LOAD_RENDER) != 0) return std::nullopt;
    const FT_GlyphSlot slot = face->glyph;
    const FT_Bitmap& bitmap = slot->bitmap;
    if (bitmap.pixel_mode != FT_PIXEL_MODE_GRAY) return std::nullopt;
    GlyphPicture picture;
    picture.width = static_cast<int>(bitmap.width);
    picture.height = static_cast<int>(bitmap.rows);
    picture.left = static_cast<float>(slot->bitmap_left);
    picture.top = static_cast<float>(slot->bitmap_top);
    picture.advance = static_cast<float>(slot->advance.x) / 64;
    for (int y = 0; y < picture.height; ++y) {
      const unsigned char* row = bitmap.buffer + static_cast<std::ptrdiff_t>(y) * bitmap.pitch;
      picture.coverage.insert(picture.coverage.end(), row, row + picture.width);
    }
    return picture;
  }
};

InterfaceFonts::InterfaceFonts() : glyphs_(std::make_unique<Glyphs>()) {
  glyphs_->context = ImGui::GetCurrentContext();
  ImGui::GetIO().UserData = this;
}

InterfaceFonts::~InterfaceFonts() {
  if (ImGui::GetCurrentContext() == glyphs_->context && glyphs_->context && ImGui::GetIO().UserData == this)
    ImGui::GetIO().UserData = nullptr;
}

InterfaceFonts* InterfaceFonts::current() {
  return ImGui::GetCurrentContext() ? static_cast<InterfaceFonts*>(ImGui::GetIO().UserData) : nullptr;
}

void InterfaceFonts::set_size(float pixels) { glyphs_->pixels = std::clamp(std::round(pixels), 6.0f, 120.0f); }

bool InterfaceFonts::stale() const {
  return glyphs_->pixels != glyphs_->built_pixels || glyphs_->wanted.size() != glyphs_->built;
}

void InterfaceFonts::build() {
  Glyphs& glyphs = *glyphs_;
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  ImFontConfig config;
  config.OversampleH = 2;
  ImFont* font = nullptr;
  for (const char* path : kFonts) {
    std::error_code error;
    if (!font && std::filesystem::is_regular_file(path, error))
      font = atlas.AddFontFromFileTTF(path, glyphs.pixels, &config, kRanges);
  }
  if (!font) {
    config.SizePixels = std::round(glyphs.pixels * 0.9f);
    font = atlas.AddFontDefault(&config);
  }
  struct Placed {
    int rectangle;
    GlyphPicture picture;
    char32_t character;
  };
  std::vector<Placed> placed;
  for (const char32_t character : glyphs.wanted) {
    const auto original = glyphs.stand_for.find(character);
    auto picture = glyphs.picture_of(original == glyphs.stand_for.end() ? character : original->second);
    if (!picture || picture->width > 1000 || picture->height > 1000) continue;
    const int rectangle =
        atlas.AddCustomRectFontGlyph(font, static_cast<ImWchar>(character), std::max(1, picture->width),
                                     std::max(1, picture->height), picture->advance);
    placed.push_back({rectangle, std::move(*picture), character});
  }
  atlas.Build();
  const float base_line = std::round(font->Ascent);
  unsigned char* pixels = nullptr;
  int width = 0, height = 0;
  atlas.GetTexDataAsAlpha8(&pixels, &width, &height);
  for (const Placed& one : placed) {
    const ImFontAtlasCustomRect* place = atlas.GetCustomRectByIndex(one.rectangle);
    for (int y = 0; y < one.picture.height; ++y)
      std::memcpy(pixels + static_cast<std::ptrdiff_t>(place->Y + y) * width + place->X,
                  one.picture.coverage.data() + static_cast<std::ptrdiff_t>(y) * one.picture.width,
                  static_cast<std::size_t>(one.picture.width));
    // Set the glyph's position, which depends on the baseline of the first font.
    auto* glyph = const_cast<ImFontGlyph*>(font->FindGlyphNoFallback(static_cast<ImWchar>(one.character)));
    if (!glyph) continue;
    const float top = base_line - one.picture.top;
    glyph->X0 = one.picture.left;
    glyph->X1 = glyph->X0 + static_cast<float>(std::max(1, one.picture.width));
    glyph->Y0 = top;
    glyph->Y1 = top + static_cast<float>(std::max(1, one.picture.height));
    if (one.picture.width == 0) glyph->Visible = 0;
  }
  glyphs.built = glyphs.wanted.size();
  glyphs.built_pixels = glyphs.pixels;
}

void InterfaceFonts::note(char32_t character) {
  if (character < 0x20 || character > kLastOfPlane || is_drawn_at_first(character)) return;
  if (glyphs_->wanted.size() < kMaxGlyphs) glyphs_->wanted.insert(character);
}

std::string InterfaceFonts::shown(std::string_view utf8) {
  const bool plain = std::all_of(utf8.begin(), utf8.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  if (plain) return std::string(utf8);
  std::string result;
  for (const char32_t character : sight_order(render::characters_of(utf8)).characters)
    if (character != SightOrder::kNothing) add_character(result, drawn(character));
  return result;
}

char32_t InterfaceFonts::drawn(char32_t character) {
  if (character >= kFirstPrivate && character <= kLastPrivate) character = 0xFFFD;  // private use: meaning is unknown
  if (character > kLastOfPlane) {
    const char32_t next = kFirstPrivate + static_cast<char32_t>(glyphs_->stand_ins.size());
    const auto [place, is_new] = glyphs_->stand_ins.try_emplace(character, std::min(next, kLastPrivate));
    if (is_new) glyphs_->stand_for[place->second] = character;
    character = place->second;
  }
  note(character);
  return character;
}

std::string shown(std::string_view utf8) {
  InterfaceFonts* fonts = InterfaceFonts::current();
  return fonts ? fonts->shown(utf8) : std::string(utf8);
}

}  // namespace gs::app
