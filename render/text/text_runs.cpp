#include "render/text/text_runs.h"

#include <fribidi/fribidi.h>
#include <hb.h>

#include <algorithm>
#include <utility>

namespace gs::render {
namespace {

constexpr std::size_t kLongestRun = 4096;  // characters; keeps the time for shaping linear

void clean(std::u32string& text) {
  std::size_t kept = 0;
  for (char32_t c : text) {
    if (c == U'\t' || c == U'\n' || c == U'\r' || c == 0x2028 || c == 0x2029 || c == 0x85) c = U' ';
    if (c < 0x20 || (c >= 0x7F && c < 0xA0)) continue;
    text[kept++] = c;
  }
  text.resize(kept);
}

/// Returns the embedding levels of UAX #9; odd levels are from right to left. Returns an empty list if all characters
/// have the direction of the line.
std::vector<FriBidiLevel> levels_of(const std::u32string& text, bool left) {
  std::vector<FriBidiCharType> types(text.size());
  const auto length = static_cast<FriBidiStrIndex>(text.size());
  const std::vector<FriBidiChar> characters(text.begin(), text.end());
  fribidi_get_bidi_types(characters.data(), length, types.data());
  const bool any = std::any_of(types.begin(), types.end(), [](FriBidiCharType type) {
    return type == FRIBIDI_TYPE_RTL || type == FRIBIDI_TYPE_AL || type == FRIBIDI_TYPE_RLE ||
           type == FRIBIDI_TYPE_RLO || type == FRIBIDI_TYPE_RLI;
  });
  if (!any) return {};
  std::vector<FriBidiBracketType> brackets(text.size());
  fribidi_get_bracket_types(characters.data(), length, types.data(), brackets.data());
  std::vector<FriBidiLevel> levels(text.size());
  FriBidiParType base = left ? FRIBIDI_PAR_RTL : FRIBIDI_PAR_LTR;
  if (fribidi_get_par_embedding_levels_ex(types.data(), brackets.data(), length, &base, levels.data()) == 0) return {};
  return levels;
}

bool inherits(hb_script_t script) {
  return script == HB_SCRIPT_COMMON || script == HB_SCRIPT_INHERITED || script == HB_SCRIPT_UNKNOWN;
}

/// Returns the script of each character. Common characters, such as blanks, have the script of the previous character.
std::vector<hb_script_t> scripts_of(const std::u32string& text) {
  hb_unicode_funcs_t* unicode = hb_unicode_funcs_get_default();
  std::vector<hb_script_t> scripts(text.size());
  hb_script_t first = HB_SCRIPT_LATIN, current = HB_SCRIPT_INVALID;
  for (std::size_t i = text.size(); i-- > 0;)
    if (scripts[i] = hb_unicode_script(unicode, text[i]); !inherits(scripts[i])) first = scripts[i];
  for (hb_script_t& script : scripts) {
    if (!inherits(script)) current = script;
    script = current == HB_SCRIPT_INVALID ? first : current;
  }
  return scripts;
}

}  // namespace

std::vector<TextRun> runs_of(std::u32string& text, vrml::TextDirection direction) {
  clean(text);
  if (text.empty()) return {};
  const bool horizontal = direction == vrml::TextDirection::right || direction == vrml::TextDirection::left;
  const bool left = direction == vrml::TextDirection::left;
  const std::vector<FriBidiLevel> levels = horizontal ? levels_of(text, left) : std::vector<FriBidiLevel>{};
  const auto level_at = [&](std::size_t i) { return levels.empty() ? FriBidiLevel{left} : levels[i]; };
  const std::vector<hb_script_t> scripts = scripts_of(text);
  struct Levelled {
    TextRun run;
    int level;
  };
  std::vector<Levelled> runs;
  int highest = 0, lowest_odd = 127;
  for (std::size_t first = 0; first < text.size();) {
    const int level = level_at(first);
    std::size_t end = first + 1;
    while (end < text.size() && end - first < kLongestRun && level_at(end) == level && scripts[end] == scripts[first])
      ++end;
    const vrml::TextDirection way = !horizontal      ? direction
                                    : level % 2 == 1 ? vrml::TextDirection::left
                                                     : vrml::TextDirection::right;
    runs.push_back({{first, end, way, static_cast<std::uint32_t>(scripts[first])}, level});
    highest = std::max(highest, level);
    if (level % 2 == 1) lowest_odd = std::min(lowest_odd, level);
    first = end;
  }
  // UAX #9, rule L2: from the highest level down, reverse all sequences at that level or higher.
  for (int level = highest; level >= lowest_odd; --level)
    for (std::size_t first = 0; first < runs.size(); ++first) {
      if (runs[first].level < level) continue;
      std::size_t end = first;
      while (end < runs.size() && runs[end].level >= level) ++end;
      std::reverse(runs.begin() + static_cast<std::ptrdiff_t>(first), runs.begin() + static_cast<std::ptrdiff_t>(end));
      first = end;
    }
  if (direction == vrml::TextDirection::up) std::reverse(runs.begin(), runs.end());
  std::vector<TextRun> result;
  result.reserve(runs.size());
  for (const Levelled& each : runs) result.push_back(each.run);
  return result;
}

}  // namespace gs::render
