#include "app/commands/options/desktop_files.h"

#include "app/base/console.h"
#include "app/base/exit_status.h"
#include "app/commands/options/options.h"
#include "app/formats/content_types.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

/// Rules by which a desktop detects a MIME type, for shared-mime-info. Some extensions do not identify the type,
/// because other programs use them. A type without a row is a 3D model with extensions that identify it.
struct DesktopType {
  std::string_view mime;  // MIME type; several content types may have it
  std::string_view comment;  // if empty, the name of the type and "3D model"
  /// First bytes of files: one text per line, with C escapes. If empty, only the extension identifies the type.
  std::string_view magic;
  std::string_view ambiguous;  // ambiguous extensions, each followed by a blank
  std::string_view aliases;  // other names of the MIME type, each followed by a blank
};
constexpr DesktopType kDesktopTypes[] = {
    {"model/vrml", "VRML world", "#VRML V2.0\n#VRML V1.0", "", "x-world/x-vrml application/x-vrml "},
    {"model/x3d-vrml", "X3D world", "#X3D V", "", ""},
    {"model/x3d+xml", "X3D world", "", "", "application/x-x3d+xml "},
    {"model/x3d+json", "X3D world", "", "", ""},
    {"model/x-qnv", "QNV stream of a 3D scene", "\\x89QNV\\r\\n\\x1a\\n", "", ""},
    {"application/x-ply", "PLY 3D model or Gaussian splats", "ply\\n\nply\\r", "", "model/ply "},
    {"model/gltf-binary", "glTF 3D scene", "glTF", ".gltf ", ""},
    {"model/x-off", "OFF 3D model", "OFF\\n\nCOFF\\n\nNOFF\\n", "", ""},
    {"model/x-avs-geometry", "AVS geometry", "# Micro AVS Geom:", ".geom .geo ", ""},
    {"model/x-avs-ucd", "AVS UCD mesh", "", ".inp ", ""},
    {"application/x-vtk-poly-data", "VTK surface", "", "", ""},
    {"application/x-vtk-unstructured-grid", "VTK unstructured grid", "", "", ""},
    {"application/x-vtk", "VTK surface or grid", "# vtk DataFile Version", "", ""},
    {"model/x-spz", "SPZ Gaussian splats", "NGSP", "", ""},
    {"model/x-splat", "Gaussian splats", "", "", ""},
    {"model/x-rad", "RAD Gaussian splats", "RAD0", "", ""},
    {"model/x-ksplat", "KSplat Gaussian splats", "", "", ""},
    {"text/x-xyz", "Points of a 3D scan", "", ".xyz ", ""},
    {"application/x-avs-field", "AVS field", "# AVS", ".fld ", ""},
    {"application/x-nrrd", "NRRD volume", "NRRD000", "", ""},
    {"application/x-metaimage", "MetaImage volume", "ObjectType = Image\nNDims = ", "", ""},
    {"application/x-nifti", "NIfTI volume", "", ".hdr .img ", ""},
    {"image/fits", "FITS image or volume", "SIMPLE  =                    T", "", ""},
    {"application/x-vtk-image-data", "VTK image data", "", "", ""},
    {"application/x-slc", "SLC volume", "11111\\n", "", ""},
    {"application/x-volume", "Volume without a header", "", ".raw .vol ", ""},
};

DesktopType desktop_type_of(const ContentType& type) {
  const auto* found = std::find_if(std::begin(kDesktopTypes), std::end(kDesktopTypes),
                                   [&](const DesktopType& row) { return row.mime == type.mime; });
  return found == std::end(kDesktopTypes) ? DesktopType{type.mime, {}, {}, {}, {}} : *found;
}

std::string comment_of(const ContentType& type, const DesktopType& desktop) {
  return std::string(desktop.comment.empty() ? type.name : desktop.comment) +
         (desktop.comment.empty() ? " 3D model" : "");
}

std::vector<std::string> parts_of(std::string_view text, char end) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t at = std::min(text.find(end), text.size());
    parts.emplace_back(text.substr(0, at));
    text.remove_prefix(std::min(text.size(), at + 1));
  }
  return parts;
}

// Returns the patterns ("*.wrl", ...) of all extensions that identify the type.
std::vector<std::string> globs_of(const ContentType& type, const DesktopType& desktop) {
  std::vector<std::string> globs;
  for (const std::string& extension : parts_of(type.extensions, ' '))
    if (desktop.ambiguous.find(extension + " ") == std::string_view::npos) globs.push_back("*" + extension);
  return globs;
}

// Returns the MIME types that a desktop can detect. They are in the order of the table, each only once.
std::vector<std::string> desktop_mime_types() {
  std::vector<std::string> names;
  for (const ContentType& type : content_types()) {
    const DesktopType desktop = desktop_type_of(type);
    if (type.belongs_to_others || (desktop.magic.empty() && globs_of(type, desktop).empty())) continue;
    std::vector<std::string> all = parts_of(desktop.aliases, ' ');
    all.insert(all.begin(), std::string(type.mime));
    for (const std::string& one : all)
      if (std::find(names.begin(), names.end(), one) == names.end()) names.push_back(one);
  }
  return names;
}

std::string xml_text(std::string_view text) {
  std::string out;
  for (const char c : text) out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  return out;
}

std::string shared_mime_info() {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<mime-info xmlns=\"http://www.freedesktop.org/standards/shared-mime-info\">\n";
  // Several content types may have the same MIME type.
  std::map<std::string_view, std::pair<std::string, std::string>> types;
  std::vector<std::string_view> order;
  for (const ContentType& type : content_types()) {
    const DesktopType desktop = desktop_type_of(type);
    if (type.belongs_to_others || (desktop.magic.empty() && globs_of(type, desktop).empty())) continue;
    auto [entry, fresh] = types.try_emplace(type.mime);
    auto& [head, body] = entry->second;
    if (fresh) {
      order.push_back(type.mime);
      head = "    <comment>" + xml_text(comment_of(type, desktop)) + "</comment>\n    <icon name=\"" +
             std::string(kDesktopName) + "\"/>\n";
    }
    if (fresh)
      for (const std::string& alias : parts_of(desktop.aliases, ' ')) head += "    <alias type=\"" + alias + "\"/>\n";
    if (fresh && !desktop.magic.empty()) {
      body += "    <magic priority=\"60\">\n";
      for (const std::string& magic : parts_of(desktop.magic, '\n'))
        body += "      <match type=\"string\" offset=\"0\" value=\"" + xml_text(magic) + "\"/>\n";
      body += "    </magic>\n";
    }
    for (const std::string& glob : globs_of(type, desktop)) body += "    <glob pattern=\"" + glob + "\"/>\n";
  }
  for (const std::string_view mime : order)
    text += "  <mime-type type=\"" + std::string(mime) + "\">\n" + types[mime].first + types[mime].second +
            "  </mime-type>\n";
  text +=
      "  <mime-type type=\"application/x-ghostspace-link\">\n    <comment>Link to a 3D scene</comment>\n"
      "    <icon name=\"" +
      std::string(kDesktopName) +
      "\"/>\n    <magic priority=\"60\">\n      <match type=\"string\" offset=\"0\" value=\"[GhostSpace link]\"/>\n"
      "    </magic>\n    <glob pattern=\"*.gslink\"/>\n  </mime-type>\n";
  return text + "</mime-info>\n";
}

std::string mime_list() {
  std::string list;
  for (const std::string& type : desktop_mime_types()) list += type + ";";
  return list;
}

std::string desktop_entry() {
  return "[Desktop Entry]\nType=Application\nName=GhostSpace\nGenericName=3D Viewer\n"
         "Comment=Walk through VRML worlds, look at models, scans and volumes, also while they are loading\n"
         "Keywords=VRML;3D;VR;model;viewer;STL;PLY;glTF;volume;splats;\nExec=ghostspace --reuse "
         "%U\nTryExec=ghostspace\n"
         "Icon=" +
         std::string(kDesktopName) +
         "\nTerminal=false\nStartupWMClass=GhostSpace\nStartupNotify=false\nCategories=Graphics;3DGraphics;Viewer;"
         "\nMimeType=" +
         mime_list() +
         "application/x-ghostspace-link;x-scheme-handler/ghostspace;\nActions=demo;\n\n"
         "[Desktop Action demo]\nName=Open the Demo World\nExec=ghostspace\n";
}

std::string thumbnailer_entry() {
  return "[Thumbnailer Entry]\nTryExec=ghostspace\nExec=ghostspace --offline --timeout 10 --memory 1G --size %sx%s "
         "--snapshot %o %i\nMimeType=" +
         mime_list() + "\n";
}

std::string metainfo() {
  std::string mimes;
  for (const std::string& type : desktop_mime_types()) mimes += "    <mediatype>" + type + "</mediatype>\n";
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<component type=\"desktop-application\">\n  <id>" +
         std::string(kDesktopName) +
         "</id>\n  <metadata_license>CC0-1.0</metadata_license>\n  <name>GhostSpace</name>\n"
         "  <summary>Browser for 3D worlds and remote scientific data</summary>\n  <description>\n"
         "    <p>GhostSpace opens interactive VRML97 worlds, meshes, volumes and Gaussian splats from disk or over the "
         "network, and shows them while they load.</p>\n"
         "    <p>It reports problems of a file by line and column and shows the rest. It converts all of them to "
         "streams that show a complete picture after the first kilobytes.</p>\n  </description>\n"
         "  <launchable type=\"desktop-id\">" +
         std::string(kDesktopName) + ".desktop</launchable>\n  <icon type=\"stock\">" + std::string(kDesktopName) +
         "</icon>\n  <categories>\n    <category>Graphics</category>\n    <category>3DGraphics</category>\n"
         "    <category>Viewer</category>\n  </categories>\n  <provides>\n    <binary>ghostspace</binary>\n" +
         mimes +
         "  </provides>\n  <content_rating type=\"oars-1.1\"/>\n  <releases>\n    <release "
         "version=\"" GHOSTSPACE_VERSION "\" date=\"2026-11-23\"/>\n  </releases>\n</component>\n";
}

constexpr DesktopFile kDesktopFiles[] = {
    {"entry", "entry for the desktop menu", desktop_entry},
    {"mime", "file types by name and first bytes (shared-mime-info)", shared_mime_info},
    {"thumbnailer", "entry for thumbnail makers", thumbnailer_entry},
    {"metainfo", "entry for software centres (AppStream)", metainfo},
    {"bash", "completion for bash", bash_completion},
    {"zsh", "completion for zsh", zsh_completion},
    {"fish", "completion for fish", fish_completion},
};

}  // namespace

std::span<const DesktopFile> desktop_files() { return kDesktopFiles; }

std::optional<std::string> check_desktop(const CommandOptions& options) {
  std::string names;
  for (const DesktopFile& file : kDesktopFiles) {
    if (file.name == options.files.front()) return std::nullopt;
    names += (names.empty() ? "expected one of " : ", ") + std::string(file.name);
  }
  return names;
}

int run_desktop(const CommandOptions& options) {
  for (const DesktopFile& file : kDesktopFiles)
    if (file.name == options.files.front()) print_text(file.make());
  return kDone;
}

}  // namespace gs::app
