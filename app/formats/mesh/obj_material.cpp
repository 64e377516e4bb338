#include "app/formats/mesh/obj_material.h"

#include "app/formats/common/text_cursor.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gs::app {
namespace {

constexpr float kMaxExponent = 128;  // specular exponent at shininess 1 (VRML97 4.14.4)

float clamped(float value) { return value > 0 ? std::min(value, 1.0f) : 0.0f; }

/// Reads "Kd r g b", or "Kd r" for grey. Returns false for spectral curves and CIE colours, which are rare and
/// unsupported.
bool read_color(TextCursor words, vrml::Color& color) {
  std::array<float, 3> part{};
  int count = 0;
  while (count < 3 && words.skip_space() && words.number(part[static_cast<std::size_t>(count)])) ++count;
  if (count == 0) return false;
  if (count < 3) part[1] = part[2] = part[0];
  color = {clamped(part[0]), clamped(part[1]), clamped(part[2])};
  return true;
}

bool read_number(TextCursor words, float& value) { return words.skip_space() && words.number(value); }

/// Returns the file name in a texture statement, after the options. The name may contain blanks.
std::string texture_name(TextCursor words) {
  constexpr std::array<std::pair<std::string_view, int>, 13> kTextureOptions = {{{"-blendu", 1},
                                                                                 {"-blendv", 1},
                                                                                 {"-boost", 1},
                                                                                 {"-cc", 1},
                                                                                 {"-clamp", 1},
                                                                                 {"-imfchan", 1},
                                                                                 {"-mm", 2},
                                                                                 {"-o", 3},
                                                                                 {"-s", 3},
                                                                                 {"-t", 3},
                                                                                 {"-texres", 1},
                                                                                 {"-bm", 1},
                                                                                 {"-type", 1}}};
  while (words.skip_space()) {
    const char* start = words.next;
    const std::string_view word = words.word();
    const auto option =
        std::find_if(kTextureOptions.begin(), kTextureOptions.end(), [&](const auto& o) { return o.first == word; });
    if (option == kTextureOptions.end()) {
      words.next = start;
      break;
    }
    for (int i = 0; i < option->second && words.skip_space(); ++i) {
      const char* value_start = words.next;
      float number = 0;
      const bool is_number = words.number(number) && (words.at_end() || TextCursor::is_space(*words.next));
      if (is_number) continue;
      words.next = value_start;
      // -o, -s and -t have one to three numbers.
      if (option->second == 3) break;
      (void)words.word();
    }
  }
  return std::string(trimmed({words.next, static_cast<std::size_t>(words.end - words.next)}));
}

std::string beside(const std::string& library, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  std::string folder = library;
  std::replace(folder.begin(), folder.end(), '\\', '/');
  const std::size_t slash = folder.rfind('/');
  const bool absolute = name.starts_with('/') || name.find(':') != std::string::npos;
  return slash == std::string::npos || absolute ? name : folder.substr(0, slash + 1) + name;
}

struct MaterialReader {
  const std::string& library;
  Look* look;
  bool shiny = true;  // false for illum 0 and 1, which have no highlight

  /// Reads one statement. Returns false if the statement is supported and has invalid values.
  bool read(std::string_view keyword, TextCursor words) {
    float number = 0;
    if (keyword == "Kd") return read_color(words, look->diffuse);
    if (keyword == "Ke") return read_color(words, look->emissive);
    if (keyword == "Ks") {
      vrml::Color specular;
      const bool good = read_color(words, specular);
      if (shiny) look->specular = specular;
      return good;
    }
    if (keyword == "Ns") {
      const bool good = read_number(words, number);
      look->shininess = clamped(number / kMaxExponent);
      return good;
    }
    if (keyword == "illum") {
      const bool good = read_number(words, number);
      shiny = number >= 2;
      if (!shiny) look->specular = {};
      return good;
    }
    if (keyword == "d" || keyword == "Tr") {
      TextCursor value = words;
      if (value.word() == "-halo") words = value;
      const bool good = read_number(words, number);
      if (good) look->transparency = clamped(keyword == "d" ? 1 - number : number);
      return good;
    }
    if (keyword == "map_Kd") {
      const std::string name = texture_name(words);
      if (!name.empty()) look->texture_url = vrml::String(beside(library, name));
      return !name.empty();
    }
    return true;
  }
};

}  // namespace

void read_obj_materials(std::span<const std::byte> bytes, const std::string& library, ObjMaterials& materials,
                        MeshBuilder& builder) {
  TextCursor cursor(bytes);
  Look unused;
  MaterialReader reader{library, &unused};
  std::uint32_t number = 0;
  while (!cursor.at_end()) {
    const std::string_view line = cursor.line();
    ++number;
    TextCursor words(line.data(), line.data() + line.size());
    const std::string_view keyword = words.word();
    if (keyword.empty() || keyword.front() == '#') continue;
    if (keyword == "newmtl") {
      const auto name = trimmed({words.next, static_cast<std::size_t>(words.end - words.next)});
      const auto [entry, added] = materials.try_emplace(std::string(name));
      unused = {};
      reader.look = added ? &entry->second : &unused;
      reader.shiny = true;
    } else if (!reader.read(keyword, words)) {
      builder.warn("material library " + library + ", line " + std::to_string(number) + ": broken " +
                   std::string(keyword) + "; it is skipped");
    }
  }
}

}  // namespace gs::app
