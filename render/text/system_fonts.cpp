#include "render/text/system_fonts.h"

#include "render/text/text_runs.h"
#include "render/text/utf8.h"

#include <utility>

namespace gs::render {
namespace {

constexpr std::size_t kMaxChoices = 512;  // maximum kept font requests, from untrusted FontStyles
constexpr std::size_t kMaxLanguages = 256;
constexpr std::size_t kMaxFaces = 256;  // maximum open fonts
constexpr std::size_t kMaxOutlineBytes = std::size_t{64} << 20;

std::string key_of(const vrml::FontRequest& font) {
  std::string key{font.bold ? 'B' : 'b', font.italic ? 'I' : 'i'};
  key += font.language;
  for (const std::string& family : font.families) (key += '\0') += family;
  return key;
}

/// Reports whether a character has the font of the previous character, as marks and joiners do.
bool joins(char32_t c) {
  return (c >= 0x300 && c < 0x370) || c == 0x200C || c == 0x200D || (c >= 0xFE00 && c < 0xFE10) || c == U' ';
}

}  // namespace

SystemFonts::Choice& SystemFonts::choice(const vrml::FontRequest& font) {
  if (const auto known = choices_.find(key_of(font)); known != choices_.end()) return known->second;
  // Limit the searches: each takes some milliseconds, and a world can make any number of requests.
  vrml::FontRequest wanted = font;
  if (choices_.size() >= kMaxChoices) wanted = {{}, font.bold, font.italic, {}};
  const auto [found, fresh] = choices_.try_emplace(key_of(wanted));
  if (fresh) {
    if (!catalogue_) catalogue_ = std::make_unique<FontCatalogue>();
    Choice& made = found->second;
    made.files = catalogue_->find(wanted);
    made.faces.resize(made.files.size(), nullptr);
    made.tried.resize(made.files.size(), false);
    made.bold = font.bold;
    made.italic = font.italic;
  }
  return found->second;
}

FontFace* SystemFonts::face(Choice& choice, std::size_t place) {
  if (choice.tried[place]) return choice.faces[place];
  choice.tried[place] = true;
  const FontFile& file = choice.files[place];
  const FontFace::Synthetic synthetic{choice.italic && !file.slanted, choice.bold && !file.bold};
  const FaceKey key{file, synthetic.slanted, synthetic.bold};
  auto found = faces_.find(key);
  if (found == faces_.end()) {
    if (faces_.size() >= kMaxFaces) return nullptr;
    found = faces_.emplace(key, FontFace::open(file.path, file.index, synthetic, &sheet_)).first;
  }
  return choice.faces[place] = found->second.get();
}

FontFace* SystemFonts::face_for(Choice& choice, char32_t character, FontFace* last) {
  if (last && joins(character)) return last;
  FontFace* first = nullptr;
  for (std::size_t i = 0; i < choice.files.size(); ++i) {
    FontFace* each = face(choice, i);
    if (!each) continue;
    if (each->has(character)) return each;
    if (!first) first = each;
  }
  return first;  // no font has the character; the first shows its glyph for missing characters
}

void SystemFonts::bound_outlines() {
  std::size_t kept = 0;
  for (const auto& [key, face] : faces_) kept += face ? face->kept() : 0;
  if (kept <= kMaxOutlineBytes) return;
  for (const auto& [key, face] : faces_)
    if (face) face->forget_outlines();
}

vrml::LineEdges SystemFonts::edges(const vrml::FontRequest& font) {
  const std::lock_guard lock(mutex_);
  Choice& chosen = choice(font);
  for (std::size_t i = 0; i < chosen.files.size(); ++i)
    if (const FontFace* first = face(chosen, i)) return first->edges();
  return {};
}

vrml::ShapedText SystemFonts::shape(const vrml::FontRequest& font, std::string_view utf8, vrml::TextDirection direction,
                                    std::size_t level) {
  const std::lock_guard lock(mutex_);
  bound_outlines();
  Choice& chosen = choice(font);
  vrml::ShapedText shaped;
  std::u32string text = characters_of(utf8);
  const std::vector<TextRun> runs = runs_of(text, direction);
  RunStyle style;
  style.language = language_tag(font.language);
  // Limit the languages: HarfBuzz keeps each in a list that is searched linearly and never freed.
  if (!languages_.contains(style.language)) {
    if (languages_.size() < kMaxLanguages)
      languages_.insert(style.language);
    else
      style.language.clear();
  }
  struct Part {
    std::size_t first, end;
    FontFace* face;
  };
  std::vector<Part> parts;
  FontFace* last = nullptr;
  for (const TextRun& run : runs) {
    parts.clear();
    for (std::size_t i = run.first; i < run.end; ++i) {
      FontFace* face = face_for(chosen, text[i], i > run.first ? last : nullptr);
      if (!face) continue;
      if (parts.empty() || parts.back().face != face || parts.back().end != i)
        parts.push_back({i, i + 1, face});
      else
        parts.back().end = i + 1;
      last = face;
    }
    // In a run to the left or upwards, the last character is visually first.
    if (run.direction == vrml::TextDirection::left || run.direction == vrml::TextDirection::up)
      for (std::size_t a = 0, b = parts.size(); a + 1 < b; ++a) std::swap(parts[a], parts[--b]);
    style.direction = run.direction;
    style.script = run.script;
    for (const Part& part : parts)
      shaped.extent += part.face->shape(text, part.first, part.end, style, shaped.extent, level, shaped.glyphs);
  }
  // Until here, positions start at the left or top. A line to the left or upwards starts at its other end.
  const auto back = static_cast<float>(shaped.extent);
  if (direction == vrml::TextDirection::left)
    for (vrml::PlacedGlyph& glyph : shaped.glyphs) glyph.at.x -= back;
  if (direction == vrml::TextDirection::up)
    for (vrml::PlacedGlyph& glyph : shaped.glyphs) glyph.at.y += back;
  return shaped;
}

std::shared_ptr<const Image> SystemFonts::glyph_picture() {
  const std::lock_guard lock(mutex_);
  return sheet_.image();
}

SystemFonts& system_fonts() {
  static SystemFonts fonts;
  return fonts;
}

}  // namespace gs::render
