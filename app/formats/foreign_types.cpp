#include "app/formats/foreign_types.h"

#include "app/formats/volume/volume_common.h"
#include "app/formats/archive/zip_archive.h"

#include "base/text.h"
#include "net/files/file.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>

// Table of the formats that are recognised but not read, with the advice for their users.
namespace gs::app {
namespace {

using Bytes = std::span<const std::byte>;

/// String as a template argument. May contain zero bytes.
template <std::size_t size>
struct Mark {
  constexpr Mark(const char (&text)[size]) { std::copy_n(text, size, letters); }
  [[nodiscard]] constexpr std::string_view view() const { return {letters, size - 1}; }
  char letters[size]{};
};

/// Reports whether the bytes contain `mark` at the offset `at`.
template <Mark mark, std::size_t at = 0>
bool has_mark(Bytes bytes) {
  const std::string_view text = text_of(bytes);
  return text.size() >= at && text.substr(at).starts_with(mark.view());
}

template <bool (*... tests)(Bytes)>
bool any_of(Bytes bytes) {
  return (tests(bytes) || ...);
}

/// Returns the start of a text without byte order mark and blanks. Converts UTF-16 if all characters are Latin.
std::string start_of_text(Bytes bytes) {
  constexpr std::size_t kEnough = 8192;
  const std::string_view raw = text_of(bytes).substr(0, kEnough);
  const bool little = raw.starts_with("\xff\xfe") || raw.starts_with(std::string_view("<\0", 2));
  const bool big = raw.starts_with("\xfe\xff") || raw.starts_with(std::string_view("\0<", 2));
  std::string text;
  if (little || big)
    for (std::size_t i = big ? 1 : 0; i < raw.size(); i += 2) text += raw[i];
  else
    text = raw;
  const std::size_t mark = little || big ? text.find('<') : text.starts_with("\xef\xbb\xbf") ? 3 : 0;
  const std::size_t first = text.find_first_not_of(" \t\r\n", std::min(mark, text.size()));
  return first == std::string::npos ? std::string() : text.substr(first);
}

/// Returns the name of the root element of an XML file, without its prefix. Empty for other files.
std::string root_element(Bytes bytes) {
  const std::string text = start_of_text(bytes);
  std::size_t at = 0;
  while (at < text.size() && text[at] == '<') {
    std::size_t end = std::string::npos;
    if (text.compare(at, 4, "<!--") == 0)
      end = text.find("-->", at);
    else if (text.compare(at, 2, "<?") == 0 || text.compare(at, 2, "<!") == 0)
      end = text.find('>', at);
    else
      break;
    at = end == std::string::npos ? end : text.find('<', end);
  }
  if (at >= text.size() || text[at] != '<') return {};
  const std::string name = text.substr(at + 1, text.find_first_of(" \t\r\n/>", at + 1) - at - 1);
  return name.substr(name.find(':') == std::string::npos ? 0 : name.find(':') + 1);
}
template <Mark name>
bool has_root(Bytes bytes) {
  return root_element(bytes) == name.view();
}
bool is_xml(Bytes bytes) { return !root_element(bytes).empty(); }
bool is_html(Bytes bytes) {
  const std::string text = lower_case(std::string_view(start_of_text(bytes)).substr(0, 64));
  return text.starts_with("<!doctype html") || lower_case(root_element(bytes)) == "html";
}

bool is_tileset(Bytes bytes) {
  const std::string text = start_of_text(bytes);
  return text.starts_with('{') && text.find("\"geometricError\"") != std::string::npos;
}
bool is_ifc(Bytes bytes) {
  return has_mark<"ISO-10303-21;">(bytes) && start_of_text(bytes).find("'IFC") != std::string::npos;
}
bool is_iges(Bytes bytes) { return has_mark<"S      1", 72>(bytes) || has_mark<"S0000001", 72>(bytes); }
bool is_dxf(Bytes bytes) {
  const std::string text = start_of_text(bytes).substr(0, 32);
  return text.starts_with("0\n") || text.starts_with("0\r\n") ? text.find("SECTION") != std::string::npos : false;
}
bool is_3ds(Bytes bytes) { return has_mark<"MM">(bytes) && (has_mark<"\x02\0", 6>(bytes) || has_mark<"==", 6>(bytes)); }

bool is_usdz(Bytes bytes) {
  const std::string_view name = first_name_in_zip(bytes);
  return name.ends_with(".usd") || name.ends_with(".usda") || name.ends_with(".usdc");
}
bool is_3mf(Bytes bytes) {
  return is_zip(bytes) && (first_name_in_zip(bytes).starts_with("3D/") ||
                           text_of(bytes).substr(0, 8192).find("3D/3dmodel.model") != std::string_view::npos);
}
/// Reports whether the first bytes are no text: they contain a zero byte, or control characters in large numbers.
bool is_binary(Bytes bytes) {
  const std::string_view text = text_of(bytes).substr(0, 1024);
  const auto odd = static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 && std::string_view("\t\n\r\f\v").find(c) == std::string_view::npos;
  }));
  return text.find('\0') != std::string_view::npos || odd * 20 > text.size();
}

constexpr ContentType foreign(std::string_view name, std::string_view extensions, bool (*sniff)(Bytes bytes),
                              std::string_view remedy) {
  ContentType type{name, "", extensions, sniff, ContentClass::mesh};
  type.remedy = remedy;
  return type;
}

constexpr std::string_view kX3d = "export it as X3D in XML encoding (.x3d) or as VRML97 (.wrl) from its editor";
constexpr std::string_view kBlender = "open it in Blender and export glTF (.glb)";
constexpr std::string_view kFreeCad = "open it in FreeCAD and export glTF (.glb), STL or OBJ";
constexpr std::string_view kCad = "export STL, OBJ or glTF (.glb) from the program that wrote it";
constexpr std::string_view kParaView = "open it in ParaView and save the data as .vti, .vtp or .vtu";
constexpr std::string_view kArray =
    "write the array as NRRD, or as raw voxels and state their number with --dims XxYxZ --type f32";
constexpr std::string_view kCloudCompare = "convert it to PLY with CloudCompare or with 'pdal translate IN OUT.ply'";
constexpr std::string_view kImage =
    "GhostSpace shows images as textures of a world; open the world or model that uses it";
constexpr std::string_view kUnpack = "unpack it, then open a file in it";

// Rows of one kind stay together. The first rows are those that are most likely to become readable.
constexpr ContentType kForeignTypes[] = {
    foreign("X3D in binary encoding (Fast Infoset)", ".x3db ", has_mark<"\xe0\0\0\x01">, kX3d),
    foreign("CGNS", ".cgns ", has_mark<"@(#)ADF Database", 4>, kParaView),
    foreign("HDF4", "", has_mark<"\x0e\x03\x13\x01">, kArray),
    foreign("IFC", ".ifc ", is_ifc, kFreeCad),
    foreign("STEP", ".step .stp .p21 ", has_mark<"ISO-10303-21;">, kFreeCad),
    foreign("USD (usdz archive)", ".usdz ", is_usdz, kBlender),
    foreign("USD", ".usd .usda .usdc ", any_of<has_mark<"#usda ">, has_mark<"PXR-USDC">>, kBlender),
    foreign("FBX", ".fbx ", any_of<has_mark<"Kaydara FBX Binary">, has_mark<"; FBX ">>, kBlender),
    foreign("COLLADA", ".dae ", has_root<"COLLADA">, kBlender),
    foreign("LAS", ".las .laz ", has_mark<"LASF">, kCloudCompare),
    foreign("E57", ".e57 ", has_mark<"ASTM-E57">, kCloudCompare),
    foreign("VTK XML of another type", ".htg ", has_root<"VTKFile">,
            kParaView),
    foreign("URDF", ".urdf ", has_root<"robot">, "open the meshes that it names, or export the robot as glTF"),
    foreign("3MF", ".3mf ", is_3mf, "open it in the slicer or in Blender and export STL"),
    foreign("AMF", ".amf ", has_root<"amf">, "open it in the slicer and export STL"),
    foreign("IGES", ".iges .igs ", is_iges, kFreeCad),
    foreign("Open CASCADE BREP", ".brep ", any_of<has_mark<"DBRep_DrawableShape">, has_mark<"CASCADE Topology">>,
            kFreeCad),
    foreign("Parasolid", ".x_t .x_b ", has_mark<"**ABCDEFGHIJKLMNOPQRSTUVWXYZ">, kCad),
    foreign("ACIS", ".sat .sab ", nullptr, kCad),
    foreign("DXF", ".dxf ", is_dxf, kCad),
    foreign("DWG", ".dwg ", has_mark<"AC10">, kCad),
    foreign("Rhino 3DM", ".3dm ", has_mark<"3D Geometry File Format">, kCad),
    foreign("Blender", ".blend ", has_mark<"BLENDER">, kBlender),
    foreign("3DS", ".3ds ", is_3ds, kBlender),
    foreign("Alembic", ".abc ", has_mark<"Ogawa">, kBlender),
    foreign("OpenVDB", ".vdb ", has_mark<" BDV\0\0\0\0">, kArray),
    foreign("NumPy array", ".npy ", has_mark<"\x93NUMPY">, kArray),
    foreign("MATLAB array", ".mat ", has_mark<"MATLAB 5.0 MAT-file">, kArray),
    foreign("MRC", ".mrc .ccp4 ", has_mark<"MAP ", 208>, kArray),
    foreign("Gmsh mesh", ".msh ", has_mark<"$MeshFormat">, "save it as .vtk with Gmsh (File, Export)"),
    foreign("Draco mesh", ".drc ", has_mark<"DRACO">, "decode it with 'draco_decoder -i IN.drc -o OUT.ply'"),
    foreign("3D Tiles", ".b3dm .i3dm .pnts .cmpt ",
            any_of<has_mark<"b3dm">, has_mark<"i3dm">, has_mark<"pnts">, has_mark<"cmpt">, is_tileset>,
            "convert its tiles to glTF (.glb) with 3d-tiles-tools"),
    foreign("PNG", ".png ", has_mark<"\x89PNG\r\n">, kImage),
    foreign("JPEG", ".jpg .jpeg ", has_mark<"\xff\xd8\xff">, kImage),
    foreign("GIF", ".gif ", has_mark<"GIF8">, kImage),
    foreign("WebP", ".webp ", has_mark<"WEBP", 8>, kImage),
    foreign("PDF", ".pdf ", has_mark<"%PDF-">, kCad),
    foreign("ZIP archive", ".zip .kmz ", is_zip, kUnpack),
    foreign("7z archive", ".7z ", has_mark<"7z\xbc\xaf\x27\x1c">, kUnpack),
    foreign("RAR archive", ".rar ", has_mark<"Rar!">, kUnpack),
    foreign("tar archive", ".tar .tgz ", has_mark<"ustar", 257>, kUnpack),
    foreign("xz file", ".xz ",
            has_mark<"\xfd"
                     "7zXZ">,
            kUnpack),
    foreign("bzip2 file", ".bz2 ", has_mark<"BZh">, kUnpack),
    foreign("Git LFS pointer", "", has_mark<"version https://git-lfs">,
            "the file itself is missing; fetch it with 'git lfs pull'"),
    foreign("HTML page", ".html .htm ", is_html, "open the link to the file itself instead of the page about it"),
    foreign("XML of an unknown kind", "", is_xml, "'ghostspace --help' lists the formats that can be opened"),
    foreign("UTF-16 text", "", any_of<has_mark<"\xff\xfe">, has_mark<"\xfe\xff">>, "save it as UTF-8 text"),
};

constexpr ContentType kUnknownBinary =
    foreign("data of an unknown format", "", is_binary,
            "'ghostspace --help' lists the formats that can be opened; for raw voxels, state their number with --dims "
            "XxYxZ");

}  // namespace

std::span<const ContentType> foreign_types() { return kForeignTypes; }

const ContentType& unknown_binary() { return kUnknownBinary; }

std::optional<std::string> refusal_of_folder(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return std::nullopt;
  constexpr int kLookedAt = 64;
  int looked_at = 0;
  for (std::filesystem::directory_iterator entry(path, error), end; !error && entry != end && looked_at < kLookedAt;
       entry.increment(error), ++looked_at)
    if (entry->is_directory(error) && !zarr_entry_of_folder(entry->path().string()).empty())
      return "a folder cannot be opened; open the Zarr container in it: " + entry->path().string();
  return "a folder cannot be opened; open one of its files, or list them with 'ghostspace serve FOLDER'";
}

}  // namespace gs::app
