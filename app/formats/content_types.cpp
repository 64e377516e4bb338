#include "app/formats/content_types.h"

#include "app/confined/decoder_pool.h"
#include "app/formats/common/scene_builder.h"
#include "app/formats/datasets/dataset_formats.h"
#include "app/formats/foreign_types.h"
#include "app/formats/gltf/gltf.h"
#include "app/formats/gltf/gltf_splats.h"
#include "app/formats/mesh/points.h"
#include "app/formats/splats/splats.h"
#include "app/formats/splats/splats_rad.h"
#include "app/formats/splats/splats_sog.h"
#include "app/formats/volume/confined/confined_volume.h"
#include "app/formats/volume/volume_common.h"
#include "base/gzip.h"
#include "base/text.h"
#include "net/files/file.h"
#include "qnv/codecs/payloads.h"
#include "vrml/syntax/scene_reader.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {

// Rows of mesh formats, each in the file of its importer.
extern const ContentType kPlyFormat, kObjFormat, kOffFormat, kStlFormat, kAvsGeometryFormat, kUcdFormat,
    kVtkLegacyFormat, kPcdFormat;

namespace {

// Meshes in files of datasets. The row of the volumes has the same name.
constexpr ContentType kHdf5MeshFormat = mesh_type("HDF5", "application/x-hdf5", "", nullptr, read_dataset_mesh),
                      kNetcdfMeshFormat = mesh_type("NetCDF", "application/x-netcdf", "", nullptr, read_dataset_mesh),
                      kXdmfMeshFormat = mesh_type("XDMF", "model/x-xdmf", "", nullptr, read_dataset_mesh),
                      kVtsMeshFormat = mesh_type("VTK StructuredGrid", "application/x-vtk-structured-grid", "", nullptr,
                                                 read_dataset_mesh),
                      kPvdMeshFormat = mesh_type("ParaView collection", "application/x-paraview-collection", "",
                                                 nullptr, read_dataset_mesh),
                      kVtkSeriesMeshFormat =
                          mesh_type("VTK file series", "application/x-vtk-series", "", nullptr, read_dataset_mesh);

using Bytes = std::span<const std::byte>;

bool is_vrml(Bytes bytes) {
  std::string_view text = text_of(bytes);
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  const std::string mark = lower_case(text.substr(0, 10));
  return mark.starts_with("#vrml") && mark != "#vrml v1.0";
}
template <vrml::Grammar grammar>
bool is_text_of(Bytes bytes) {
  return vrml::grammar_of(text_of(bytes)) == grammar;
}
bool is_vrml_1(Bytes bytes) {
  std::string_view text = text_of(bytes);
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return lower_case(text.substr(0, 10)) == "#vrml v1.0";
}
bool is_inventor(Bytes bytes) { return lower_case(text_of(bytes).substr(0, 9)) == "#inventor"; }

// Returns the row of a text that a reader of vrml/ reads.
ContentType text_type(std::string_view name, std::string_view mime, std::string_view extensions,
                      bool (*sniff)(Bytes bytes), vrml::Grammar grammar) {
  ContentType type{name, mime, extensions, sniff};
  type.grammar = grammar;
  return type;
}

bool is_glb(Bytes bytes) { return text_of(bytes).starts_with("glTF"); }

Asset read_gltf(const ImportSource& source) {
  auto scene = std::make_unique<vrml::SceneGraph>(source.path, source.budget);
  if (source.for_x3d) scene->set_language(vrml::Language::x3d, kX3DVersionOfGltf);
  bool whole = true;
  try {
    import_gltf(source.bytes, *scene, source.diagnostics, source.read_file);
  } catch (const OutOfBudget&) {
    whole = source.budget->stopped();
  }
  if (!whole || scene->memory().exhausted())
    source.diagnostics.add(
        {Severity::error, source.path, {}, source.budget->refusal(Resource::nodes) + "; skipped the rest"});
  return SceneAsset(std::move(scene));
}

template <ImportedVectors (*import)(Bytes, const WorldBudget&)>
Asset read_vectors(const ImportSource& source) {
  ImportedVectors imported = import(source.bytes, source.budget);
  if (auto* splats = std::get_if<qnv::Splats>(&imported)) return std::move(*splats);
  if (auto* splats = std::get_if<qnv::Gaussians>(&imported)) return std::move(*splats);
  source.diagnostics.add({Severity::error, source.path, {}, std::move(std::get<std::string>(imported))});
  return {};
}

/// Notes which dataset of several is shown, unless the user chose it.
void note_dataset(const qnv::VolumeSource& volume, const ImportSource& source) {
  std::string path, count;
  for (const auto& [key, value] : volume.layout.metadata) {
    if (key == kDatasetMetadata) path = value;
    if (key == kDatasetsMetadata) count = value;
  }
  if (count.empty() || !source.component.dataset.empty()) return;
  source.diagnostics.add({Severity::note,
                          source.path,
                          {},
                          "shows " + path + ", one of " + count + " datasets (--dataset chooses another)"});
}

Asset read_volume(const ImportSource& source) {
  auto opened = open_volume_confined(
      source.path, {},
      {source.read_file, source.name, source.component, source.read_files, source.list_folder, source.need},
      source.budget);
  if (auto* volume = std::get_if<qnv::VolumeSource>(&opened)) {
    note_dataset(*volume, source);
    return std::move(*volume);
  }
  // open_volume_confined() puts the file name first. Remove it, because diagnostics have it too.
  std::string& problem = std::get<std::string>(opened);
  if (problem.starts_with(source.path + ": ")) problem.erase(0, source.path.size() + 2);
  source.diagnostics.add({Severity::error, source.path, {}, std::move(problem)});
  return {};
}

const ContentType* type_by_name(std::string_view path, std::span<const ContentType> types) {
  std::string name = lower_case(path);
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  const std::size_t point = name.rfind('.');
  // A name such as ".wrl" has no extension.
  if (point == std::string::npos || point == 0 || name[point - 1] == '/') return nullptr;
  const std::string extension = name.substr(point) + ' ';
  for (const ContentType& type : types)
    if (type.extensions.find(extension) != std::string_view::npos) return &type;
  return nullptr;
}

}  // namespace

std::span<const ContentType> content_types() {
  static const std::vector<ContentType> types = [] {
    constexpr auto kSplats = ContentClass::splats;
    // Table of types. If several types share a mark, the most specific one comes first. content_types() appends the
    // volumes from their own table.
    std::vector<ContentType> all = {
        {"VRML97", "model/vrml", ".wrl .wrz .vrml ", is_vrml},
        text_type("X3D in classic encoding", "model/x3d-vrml", ".x3dv .x3dvz ", is_text_of<vrml::Grammar::x3d_classic>,
                  vrml::Grammar::x3d_classic),
        text_type("X3D in XML encoding", "model/x3d+xml", ".x3d .x3dz ", is_text_of<vrml::Grammar::x3d_xml>,
                  vrml::Grammar::x3d_xml),
        text_type("X3D in JSON encoding", "model/x3d+json", ".x3dj .x3djz ", is_text_of<vrml::Grammar::x3d_json>,
                  vrml::Grammar::x3d_json),
        text_type("VRML 1.0", "model/vrml", "", is_vrml_1, vrml::Grammar::inventor),
        text_type("Inventor", "application/x-inventor", ".iv ", is_inventor, vrml::Grammar::inventor),
        {"QNV", "model/x-qnv", ".qnv ", qnv::is_stream, ContentClass::stream},
        {.name = "compressed splats PLY",
         .mime = "application/x-ply",
         .extensions = "",
         .sniff = is_splats_compressed_ply,
         .content = kSplats,
         .read = read_vectors<import_splats_compressed_ply>,
         .open_rows = open_compressed_ply_rows},
        {.name = "splats PLY",
         .mime = "application/x-ply",
         .extensions = "",
         .sniff = is_splats_ply,
         .content = kSplats,
         .read = read_vectors<import_splats_ply>,
         .open_rows = open_splats_ply_rows},
        {"points PLY", "application/x-ply", "", is_points_ply, kSplats, read_vectors<import_points_ply>,
         UpRule::survey},
        kPlyFormat,
        {"glTF splats", "model/gltf-binary", "", is_gltf_splats, kSplats, read_gltf_splats},
        {"glTF", "model/gltf-binary", ".glb .gltf ", is_glb, ContentClass::mesh, read_gltf, UpRule::y, false, true},
        kObjFormat,
        kOffFormat,
        kStlFormat,
        kAvsGeometryFormat,
        kUcdFormat,
        mesh_type("VTK PolyData", "application/x-vtk-poly-data", ".vtp .pvtp ", is_vtp, read_dataset_mesh),
        mesh_type("VTK UnstructuredGrid", "application/x-vtk-unstructured-grid", ".vtu .pvtu ", is_vtu,
                  read_dataset_mesh),
        mesh_type("VTK MultiBlock", "application/x-vtk-multi-block", ".vtm .vtmb .vtpd .vtpc .vth .vthb ", is_vtm,
                  read_dataset_mesh),
        kVtkLegacyFormat,
        {"points PCD", "application/x-pcd", "", is_points_pcd, kSplats, read_vectors<import_points_pcd>,
         UpRule::survey},
        kPcdFormat,
        {"SPZ splats", "model/x-spz", ".spz ", is_splats_spz, kSplats, read_vectors<import_splats_spz>, UpRule::y,
         true},
        {"SOG", "application/zip", ".sog ", is_splats_sog, kSplats, read_splats_sog},
        {"RAD", "model/x-rad", ".rad ", is_splats_rad, kSplats, read_splats_rad},
        {"streamed SOG", "application/json", "", is_splats_sog_levels, kSplats, read_splats_sog_levels},
        {.name = "splats",
         .mime = "model/x-splat",
         .extensions = ".splat ",
         .content = kSplats,
         .read = read_vectors<import_splats_antimatter>,
         .open_rows = open_antimatter_rows},
        {"KSplat", "model/x-ksplat", ".ksplat ", nullptr, kSplats, read_vectors<import_splats_ksplat>},
        {"points", "text/x-xyz", ".xyz ", nullptr, kSplats, read_vectors<import_points_xyz>, UpRule::survey},
    };
    for (const VolumeFormatName& volume : volume_format_names()) {
      all.push_back(
          {volume.name, volume.mime, volume.extensions, volume.sniff, ContentClass::volume, read_volume, volume.up});
      all.back().belongs_to_others = volume.belongs_to_others;
    }
    std::ranges::find(all, "streamed SOG", &ContentType::name)->belongs_to_others = true;
    for (const ContentType* const mesh : {&kHdf5MeshFormat, &kNetcdfMeshFormat, &kXdmfMeshFormat, &kVtsMeshFormat,
                                          &kPvdMeshFormat, &kVtkSeriesMeshFormat}) {
      const auto row = std::ranges::find(all, mesh->name, &ContentType::name);
      row->holds_mesh = holds_dataset_mesh;
      row->mesh_type = mesh;
    }
    return all;
  }();
  return types;
}

const ContentType* content_type_by_mark(Bytes bytes) {
  for (const ContentType& type : content_types())
    if (type.sniff && type.sniff(bytes)) return &type;
  return nullptr;
}

const ContentType* content_type_by_name(std::string_view path) { return type_by_name(path, content_types()); }

const ContentType& content_type_of(std::string_view path, Bytes bytes) {
  if (const ContentType* type = content_type_by_mark(bytes)) return *type;
  for (const ContentType& type : foreign_types())
    if (type.sniff && type.sniff(bytes)) return type;
  const ContentType* named = nullptr;
  for (const std::span<const ContentType> types : {content_types(), foreign_types()})
    if (!named) named = type_by_name(path, types);
  if (!named) named = &content_types().front();
  return named->content == ContentClass::vrml && unknown_binary().sniff(bytes) ? unknown_binary() : *named;
}

const ContentType& type_of_content(const ContentType& type, const ImportSource& source) {
  if (!type.holds_mesh) return type;
  if (!source.local || DecoderPool::of_program().program().empty())
    return type.holds_mesh(source) ? *type.mesh_type : type;
  // A child tries to open it as a volume.
  const auto opened = open_volume_confined(
      source.path, {}, {source.read_file, source.name, source.component, {}, {}, source.need}, source.budget);
  const auto* const problem = std::get_if<std::string>(&opened);
  return problem && problem->ends_with(kIsMesh) ? *type.mesh_type : type;
}

std::optional<std::string> refuse_first_bytes(std::string_view path, Bytes first) {
  if (is_gzip(first)) return std::nullopt;
  const ContentType& type = content_type_of(path, first);
  if (text_of(first).starts_with(type.mark)) return std::nullopt;
  return "not in " + std::string(type.name) + " format; expected '" + std::string(type.mark) + "' as its first bytes";
}

std::string file_of_folder(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return {};
  if (std::string zarr = zarr_entry_of_folder(path); !zarr.empty()) return zarr;
  for (const char* const name : {"lod-meta.json", "meta.json"}) {
    std::string file = (std::filesystem::path(path) / name).string();
    const auto mapped = net::map_file(file);
    const auto* const meta = std::get_if<net::MappedFile>(&mapped);
    if (meta && (is_splats_sog(meta->bytes()) || is_splats_sog_levels(meta->bytes()))) return file;
  }
  return {};
}

std::vector<std::byte> first_bytes(Bytes bytes) {
  constexpr std::size_t kEnough = 32768;  // a glTF with splats may list 60 accessors before it names its extensions
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
