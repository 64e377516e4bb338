#include "app/formats/content_types.h"

#include "app/formats/gltf/gltf.h"
#include "app/formats/mesh/avs_geometry.h"
#include "app/formats/mesh/obj.h"
#include "app/formats/mesh/off.h"
#include "app/formats/mesh/ply.h"
#include "app/formats/mesh/points.h"
#include "app/formats/mesh/stl.h"
#include "app/formats/mesh/ucd.h"
#include "app/formats/mesh/vtk_legacy.h"
#include "app/formats/mesh/vtp.h"
#include "app/formats/volume/volume.h"
#include "base/gzip.h"
#include "base/text.h"
#include "qnv/codecs/payloads.h"

#include <algorithm>
#include <vector>

namespace gs::app {
namespace {

using Bytes = std::span<const std::byte>;

bool is_vrml(Bytes bytes) {
  std::string_view text = text_of(bytes);
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text.starts_with("#VRML") || text.starts_with("#vrml") || text.starts_with("#X3D") ||
         text.starts_with("#Inventor");
}
bool is_ply(Bytes bytes) { return text_of(bytes).starts_with("ply\n") || text_of(bytes).starts_with("ply\r"); }
bool is_glb(Bytes bytes) { return text_of(bytes).starts_with("glTF"); }

// Comments, then a line of five whole numbers; the comments of some begin like those of AVS fields.
bool is_ucd_text(Bytes bytes) {
  std::string_view text = text_of(bytes);
  while (text.starts_with('#')) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return false;
    text.remove_prefix(end + 1);
  }
  int numbers = 0;
  bool inside = false;
  for (const char c : text) {
    if (c == '\n') return numbers == 5;
    if (c == ' ' || c == '\t' || c == '\r') {
      inside = false;
      continue;
    }
    if (c < '0' || c > '9') return false;
    if (!inside) ++numbers;
    inside = true;
  }
  return false;
}

using ImportMesh = void (*)(Bytes, vrml::SceneGraph&, Diagnostics&);
template <ImportMesh import_mesh>
void alone(Bytes bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics, const ReadFile&) {
  import_mesh(bytes, scene, diagnostics);
}

// Of types that share a mark the more special one comes first. Volumes follow, from their own table.
constexpr ContentType kTypes[] = {
    {"VRML97", "model/vrml", ".wrl .wrz .vrml ", is_vrml},
    {"QNV", "model/x-qnv", ".qnv ", qnv::is_stream, ContentClass::stream},
    {"compressed splats PLY", "application/x-ply", "", is_splats_compressed_ply, ContentClass::cloud, nullptr,
     import_splats_compressed_ply},
    {"splats PLY", "application/x-ply", "", is_splats_ply, ContentClass::cloud, nullptr, import_splats_ply},
    {"points PLY", "application/x-ply", "", is_points_ply, ContentClass::cloud, nullptr, import_points_ply, false,
     UpRule::survey},
    {"PLY", "application/x-ply", ".ply ", is_ply, ContentClass::mesh, alone<import_ply>, nullptr, false,
     UpRule::by_shape, true, "ply"},
    {"glTF", "model/gltf-binary", ".glb .gltf ", is_glb, ContentClass::mesh, import_gltf},
    {"OBJ", "model/obj", ".obj ", nullptr, ContentClass::mesh, import_obj},
    {"OFF", "model/x-off", ".off ", is_off, ContentClass::mesh, alone<import_off>},
    {"STL", "model/stl", ".stl ", nullptr, ContentClass::mesh, alone<import_stl>, nullptr, false, UpRule::z, true},
    {"AVS geometry", "model/x-avs-geometry", ".mgf .geom .geo ", is_avs_geometry, ContentClass::mesh,
     alone<import_avs_geometry>},
    {"AVS UCD", "model/x-avs-ucd", ".inp .ucd ", is_ucd_text, ContentClass::mesh, alone<import_ucd>},
    {"VTK PolyData", "application/x-vtk-poly-data", ".vtp ", is_vtp, ContentClass::mesh, alone<import_vtp>},
    {"VTK UnstructuredGrid", "application/x-vtk-unstructured-grid", ".vtu ", is_vtu, ContentClass::mesh,
     alone<import_vtu>},
    {"legacy VTK", "application/x-vtk", ".vtk ", is_vtk_legacy, ContentClass::mesh, alone<import_vtk_legacy>, nullptr,
     false, UpRule::y, false, "# vtk DataFile Version"},
    {"SPZ splats", "model/x-spz", ".spz ", is_splats_spz, ContentClass::cloud, nullptr, import_splats_spz, true},
    {"splats", "model/x-splat", ".splat ", nullptr, ContentClass::cloud, nullptr, import_splats_antimatter},
    {"KSplat", "model/x-ksplat", ".ksplat ", nullptr, ContentClass::cloud, nullptr, import_splats_ksplat},
    {"points", "text/x-xyz", ".xyz ", nullptr, ContentClass::cloud, nullptr, import_points_xyz, false, UpRule::survey},
};

// Splats as pictures of WebP, in a ZIP archive or beside their meta.json.
bool is_sog(Bytes bytes) {
  const std::string_view text = text_of(bytes).substr(0, 4096);
  if (text.starts_with("PK\x03\x04")) {
    const std::string_view name = text.substr(std::min<std::size_t>(text.size(), 30), 32);
    return name.starts_with("meta.json") || name.starts_with("means_") || name.starts_with("lod-meta.json");
  }
  return text.starts_with('{') && text.find("\"means\"") != std::string_view::npos &&
         text.find("means_l.webp") != std::string_view::npos;
}
ImportedCloud refuse_sog(Bytes, const WorldBudget&) {
  return "SOG (splats as WebP pictures) is not supported; convert it with PlayCanvas splat-transform to PLY, "
         "compressed PLY, SPZ, KSplat or .splat";
}

// Known types that are not read. Messages name them.
constexpr ContentType kNotRead[] = {
    {"SOG", "model/x-sog", ".sog ", is_sog, ContentClass::cloud, nullptr, refuse_sog},
};

}  // namespace

std::span<const ContentType> content_types() {
  static const std::vector<ContentType> types = [] {
    std::vector<ContentType> all(std::begin(kTypes), std::end(kTypes));
    for (const VolumeFormatName& volume : volume_format_names())
      all.push_back({volume.name, volume.mime, volume.extensions, volume.sniff, ContentClass::volume, nullptr, nullptr,
                     false, volume.up});
    return all;
  }();
  return types;
}

const ContentType* content_type_by_mark(Bytes bytes) {
  for (const ContentType& type : content_types())
    if (type.sniff && type.sniff(bytes)) return &type;
  return nullptr;
}

const ContentType& content_type_of(std::string_view path, Bytes bytes) {
  if (const ContentType* type = content_type_by_mark(bytes)) return *type;
  for (const ContentType& type : kNotRead)
    if (type.sniff(bytes)) return type;
  std::string name(path);
  std::transform(name.begin(), name.end(), name.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  const std::size_t point = name.rfind('.');
  if (point != std::string::npos) {
    const std::string extension = name.substr(point) + ' ';
    for (const ContentType& type : content_types())
      if (type.extensions.find(extension) != std::string_view::npos) return type;
    for (const ContentType& type : kNotRead)
      if (type.extensions.find(extension) != std::string_view::npos) return type;
  }
  return content_types().front();
}

std::optional<std::string> refuse_first_bytes(std::string_view path, Bytes first) {
  if (is_gzip(first)) return std::nullopt;
  const ContentType& type = content_type_of(path, first);
  if (text_of(first).starts_with(type.mark)) return std::nullopt;
  return "not in " + std::string(type.name) + " format; expected '" + std::string(type.mark) + "' as its first bytes";
}

std::vector<std::byte> first_bytes(Bytes bytes) {
  constexpr std::size_t kEnough = 8192;  // headers of PLY splats list a hundred properties
  if (!is_gzip(bytes)) {
    const Bytes head = bytes.first(std::min(bytes.size(), kEnough));
    return {head.begin(), head.end()};
  }
  std::vector<std::byte> head;
  (void)gunzip(bytes, own_budget(), [&](std::string_view piece) {
    const auto* first = reinterpret_cast<const std::byte*>(piece.data());
    head.insert(head.end(), first, first + std::min(piece.size(), kEnough));
    return head.size() < kEnough;
  });
  return head;
}

std::string content_type_list() {
  std::string text;
  for (const ContentType& type : content_types()) {
    text += (text.empty() ? "" : ", ") + std::string(type.name);
    std::string_view extensions = type.extensions;
    if (!extensions.empty()) extensions.remove_suffix(1);
    if (!extensions.empty()) text += " (" + std::string(extensions) + ")";
  }
  return text;
}

bool is_outline_stream(std::span<const std::byte> bytes) {
  const qnv::PayloadRow* payload = qnv::payload_of(bytes);
  return payload && payload->reader == qnv::PayloadReader::polygons;
}

}  // namespace gs::app
