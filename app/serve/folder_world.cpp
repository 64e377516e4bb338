#include "app/serve/folder_world.h"

#include "app/formats/content_types.h"
#include "app/formats/streamed_names.h"
#include "net/serve/served_folder.h"
#include "vrml/xml/text_decoder.h"

#include <algorithm>
#include <cstdio>

namespace gs::app {
namespace {

constexpr std::size_t kMaxTiles = 120, kColumns = 6, kLongestTileLabel = 22;
// Metres: size of a picture, and distances between pictures.
constexpr double kTileWidth = 1.6, kTileHeight = 1.2, kStepX = 2, kStepY = 1.9;

// Returns a text as a string of VRML97. Bytes that are not UTF-8 become question marks.
std::string vrml_string(std::string_view text) {
  const bool good = vrml::xml::is_utf8(text);
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    const auto byte = static_cast<unsigned char>(c);
    out += byte < 0x20 || byte == 0x7f || (!good && byte >= 0x80) ? '?' : c;
  }
  return out + "\"";
}

std::string tile_label(const net::FolderEntry& entry) {
  std::string name = entry.folder ? entry.name + "/" : entry.name;
  if (name.size() <= kLongestTileLabel) return name;
  // Do not cut in the middle of a UTF-8 character.
  std::size_t end = kLongestTileLabel - 3;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;
  return name.substr(0, end) + "...";
}

std::string text_shape(const std::string& text, double size) {
  char style[120];
  std::snprintf(style, sizeof style, "FontStyle { family \"SANS\" justify \"MIDDLE\" size %.2f }", size);
  return "Shape { appearance Appearance { material Material { emissiveColor .9 .9 .9 diffuseColor 0 0 0 } } geometry "
         "Text { string " +
         vrml_string(text) + " fontStyle " + style + " } }";
}

// Returns a picture of an entry with its name. `x` and `y` are the centre of the picture.
std::string folder_tile(const net::FolderEntry& entry, bool made, double x, double y) {
  const bool shown = !entry.folder && content_type_by_name(entry.name);
  const std::string opened = entry.folder ? net::encode_name(entry.name) + "/"
                                          : net::encode_name(made ? streamed_name(entry.name) : entry.name);
  std::string appearance =
      entry.folder ? "material Material { diffuseColor .9 .7 .3 }" : "material Material { diffuseColor .35 .38 .42 }";
  if (shown && made)
    appearance +=
        " texture ImageTexture { url " + vrml_string("./" + net::encode_name(entry.name) + "?thumbnail") + " }";
  char place[100], box[100];
  std::snprintf(place, sizeof place, "Transform { translation %.3f %.3f 0 children ", x, y);
  std::snprintf(box, sizeof box, "Box { size %.2f %.2f .05 }", entry.folder ? kTileWidth / 2 : kTileWidth, kTileHeight);
  char below[100];
  std::snprintf(below, sizeof below, "Transform { translation 0 %.3f 0 children ", -kTileHeight / 2 - 0.3);
  const std::string tiles = "[ Shape { appearance Appearance { " + appearance + " } geometry " + box + " } " + below +
                            text_shape(tile_label(entry), 0.16) + " } ]";
  if (!shown && !entry.folder) return place + tiles + " }\n";
  return place + std::string("Anchor { description ") + vrml_string(entry.name) + " url " + vrml_string("./" + opened) +
         " children " + tiles + " } }\n";
}

}  // namespace

net::FolderPage folder_world(const net::FolderListing& listing, bool made) {
  const std::vector<net::FolderEntry>& entries = listing.entries;
  const std::size_t count = std::min(entries.size(), kMaxTiles);
  const double middle = kStepX * static_cast<double>(std::min(count, kColumns) - std::min<std::size_t>(count, 1)) / 2;
  std::string world = "#VRML V2.0 utf8\nWorldInfo { title " + vrml_string(listing.path) +
                      " }\nBackground { skyColor .12 .13 .15 }\nNavigationInfo { type [ \"EXAMINE\" \"ANY\" ] }\n";
  char view[200];
  std::snprintf(view, sizeof view, "Viewpoint { position 0 -2 %.2f description \"Folder\" }\n",
                std::max(5.0, middle * 1.6 + 4));
  world += view;
  std::string heading = listing.path;
  if (count < entries.size() || !listing.complete)
    heading += " (" + std::to_string(count) + " of " + (listing.complete ? "" : "more than ") +
               std::to_string(entries.size()) + " entries)";
  world += "Transform { translation 0 1.2 0 children " + text_shape(heading, 0.25) + " }\n";
  for (std::size_t i = 0; i < count; ++i)
    world += folder_tile(entries[i], made, kStepX * static_cast<double>(i % kColumns) - middle,
                         -kStepY * static_cast<double>(i / kColumns));
  return {"model/vrml", world};
}

}  // namespace gs::app
