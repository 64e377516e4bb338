#include "app/formats/volume/volume.h"

#include "app/base/local_file.h"
#include "app/formats/common/dataset_list.h"
#include "app/formats/volume/file_states.h"
#include "app/formats/volume/volume_common.h"
#include "base/gzip.h"
#include "net/files/file.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <optional>
#include <utility>

namespace gs::app {
namespace {

VolumeResult open_without_header(const VolumeFile&) {
  return "the file has no header; state its size and type with --dims XxYxZ --type " + std::string(kVoxelTypes);
}

constexpr VolumeFormat kVolumeFormats[] = {
    {{"DICOM", ".dcm .dicom .ima ", nullptr, "application/dicom", UpRule::patient_s}, is_dicom, open_datasets},
    {{"AVS field", ".fld ", nullptr, "application/x-avs-field"}, is_avs_field, open_avs_field},
    {{"NRRD", ".nrrd .nhdr ", nullptr, "application/x-nrrd", UpRule::slices}, is_nrrd, open_nrrd, is_plain_nrrd},
    {{"MetaImage", ".mhd .mha ", nullptr, "application/x-metaimage", UpRule::patient_s},
     is_meta_image,
     open_meta_image,
     is_plain_meta_image},
    {{"NIfTI", ".nii .hdr .img ", nullptr, "application/x-nifti", UpRule::patient_r},
     is_nifti,
     open_nifti,
     is_plain_nifti},
    {{"FITS", ".fits .fit .fts ", nullptr, "image/fits"}, is_fits, open_fits},
    {{"VTK ImageData", ".vti .pvti ", nullptr, "application/x-vtk-image-data"}, is_vti, open_vti},
    {{"VTK RectilinearGrid", ".vtr .pvtr ", nullptr, "application/x-vtk-rectilinear-grid"}, is_vtr, open_datasets},
    {{"VTK StructuredGrid", ".vts .pvts ", nullptr, "application/x-vtk-structured-grid"}, is_vts, open_datasets},
    {{"ParaView collection", ".pvd ", nullptr, "application/x-paraview-collection"}, is_pvd, open_datasets},
    {{"VTK file series", ".series ", nullptr, "application/x-vtk-series"}, is_vtk_series, open_datasets},
    {{"SLC", ".slc ", nullptr, "application/x-slc"}, is_slc, open_slc},
    {{"TIFF", ".tif .tiff .btf ", nullptr, "image/tiff", UpRule::slices, true}, is_tiff, open_datasets, is_tiff},
    {{"HDF5", ".h5 .hdf5 .hdf .he5 .vtkhdf .nc4 ", nullptr, "application/x-hdf5"}, is_hdf5, open_datasets, is_hdf5},
    {{"NetCDF", ".nc .cdf .nc3 .exo .ex2 .exii .e ", nullptr, "application/x-netcdf"},
     is_classic_netcdf,
     open_datasets,
     is_classic_netcdf},
    {{"XDMF", ".xdmf .xmf ", nullptr, "model/x-xdmf"}, is_xdmf, open_datasets},
    {{"Zarr", ".zarr ", nullptr, "application/x-zarr", UpRule::slices}, is_zarr, open_datasets},
    {{"raw voxels", ".raw .vol ", nullptr, "application/x-volume", UpRule::slices}, nullptr, open_without_header},
};

const VolumeFormat* format_of(std::string_view path, std::span<const std::byte> bytes) {
  for (const VolumeFormat& format : kVolumeFormats)
    if (format.sniff && format.sniff(bytes)) return &format;
  std::string name = lower_case(path);
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  const std::size_t point = name.rfind('.');
  if (point == std::string::npos) return nullptr;
  const std::string extension = name.substr(point) + ' ';
  for (const VolumeFormat& format : kVolumeFormats)
    if (format.name.extensions.find(extension) != std::string_view::npos) return &format;
  return nullptr;
}

std::string known_formats() {
  std::string text;
  for (const VolumeFormat& format : kVolumeFormats) text += (text.empty() ? "" : ", ") + std::string(format.name.name);
  return text;
}

VolumeResult open_as(const VolumeFormat* format, const VolumeFile& file, const RawVolume& raw) {
  if (raw.dimensions != std::array<std::uint32_t, 3>{}) return open_raw(file, raw);
  if (!format) return "unknown format; expected one of: " + known_formats();
  VolumeResult result = format->open(file);
  if (const auto* problem = std::get_if<std::string>(&result)) return std::string(format->name.name) + ": " + *problem;
  return result;
}

/// Notes the components and steps of a volume, unless its reader did.
void note_choices(const qnv::VolumeSource& volume, const VoxelComponent& choice) {
  if (!choice.found) return;
  if (choice.found->components == 1 && !volume.components.empty()) choice.found->components = volume.components.size();
  if (choice.found->times.empty()) choice.found->times = volume.times;
}

}  // namespace

std::string entry_of_folder(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return {};
  constexpr std::size_t kLookedAt = 2000;
  for (const std::string& name : files_below(path, kLookedAt)) {
    std::string file = path + '/' + name;
    const auto opened = net::open_file(file);
    const auto* const bytes = std::get_if<net::RandomAccessFile>(&opened);
    std::array<std::byte, 160> first{};
    if (bytes && is_dicom(std::span(first).first(bytes->read(0, first)))) return file;
  }
  return {};
}

void use_folder(const std::string& path, VolumeOrigin& origin) {
  if (origin.component.served) return;
  if (!entry_of_folder(path).empty()) origin.component.folder = path;
  if (!origin.component.folder.empty()) origin.read_beside = folder_reader(origin.component.folder);
}

bool read_dimensions(std::string_view text, RawVolume& raw) {
  std::array<std::uint32_t, 3> dimensions{};
  const char* next = text.data();
  const char* end = next + text.size();
  for (std::size_t i = 0; i < 3; ++i) {
    if (i > 0 && (next == end || (*next != 'x' && *next != 'X'))) return false;
    const auto [behind, error] = std::from_chars(next + (i > 0 ? 1 : 0), end, dimensions[i]);
    if (error != std::errc() || dimensions[i] == 0) return false;
    next = behind;
  }
  if (next != end) return false;
  raw.dimensions = dimensions;
  return true;
}

bool read_voxel_type(std::string_view text, RawVolume& raw) {
  static constexpr std::pair<std::string_view, qnv::VoxelType> kNames[] = {
      {"u8", qnv::VoxelType::u8},   {"i8", qnv::VoxelType::i8},   {"u16", qnv::VoxelType::u16},
      {"i16", qnv::VoxelType::i16}, {"u32", qnv::VoxelType::u32}, {"i32", qnv::VoxelType::i32},
      {"f32", qnv::VoxelType::f32}, {"f64", qnv::VoxelType::f64}};
  const std::string name = lower_case(text);
  for (const auto& [type_name, type] : kNames) {
    if (!name.starts_with(type_name)) continue;
    const std::string_view order = std::string_view(name).substr(type_name.size());
    if (!order.empty() && order != "le" && order != "be") continue;
    raw.type = type;
    raw.big_endian = order == "be";
    return true;
  }
  return false;
}

std::optional<qnv::ShownStep> read_shown_step(std::string_view text) {
  qnv::ShownStep step;
  const char* const end = text.data() + text.size();
  if (const auto whole = std::from_chars(text.data(), end, step.number); whole.ec == std::errc() && whole.ptr == end)
    return step;
  double time = 0;
  const auto [at, error] = std::from_chars(text.data(), end, time);
  if (error != std::errc() || at != end || !std::isfinite(time)) return std::nullopt;
  step.number = 0;
  step.time = time;
  return step;
}

std::optional<VoxelComponent> read_voxel_component(std::string_view text) {
  VoxelComponent component;
  component.magnitude = text == "magnitude";
  if (component.magnitude) return component;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), component.index);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(component) : std::nullopt;
}

bool reads_by_parts(std::string_view name, std::span<const std::byte> first) {
  const VolumeFormat* const format = is_gzip(first) ? nullptr : format_of(name, first);
  return format && format->by_parts && format->by_parts(first);
}

bool may_read_by_parts(std::string_view name) {
  if (lower_case(name).ends_with(".gz")) return false;
  const VolumeFormat* const format = format_of(name, {});
  return format && format->by_parts;
}

std::span<const VolumeFormat> volume_formats() { return kVolumeFormats; }

VolumeResult open_raw(const VolumeFile& file, const RawVolume& raw) {
  qnv::VolumeLayout layout;
  layout.dimensions = raw.dimensions;
  for (int i = 0; i < 3; ++i) layout.axes[static_cast<std::size_t>(i)][i] = raw.spacing[static_cast<std::size_t>(i)];
  StoredVoxels voxels;
  voxels.content = file.content;
  voxels.offset = raw.offset;
  voxels.type = static_cast<StoredType>(raw.type);
  voxels.big_endian = raw.big_endian;
  voxels.component = file.component;
  return make_source(std::move(layout), std::move(voxels));
}

std::variant<SharedBytes, std::string> map_volume(const std::string& path) {
  const std::string entry = entry_of_folder(path);
  auto opened = net::map_file(entry.empty() ? path : entry);
  if (const auto* error = std::get_if<net::FileError>(&opened)) return error->message;
  SharedBytes bytes = shared_bytes(std::move(std::get<net::MappedFile>(opened)));
  if (bytes.bytes.empty()) return path + ": the file is empty; expected a volume";
  return bytes;
}

std::variant<qnv::VolumeSource, std::string> open_volume(const std::string& path, const RawVolume& raw,
                                                         const VolumeOrigin& origin, const WorldBudget& budget) {
  if (const std::string entry = zarr_entry_of_folder(path); !entry.empty())
    return open_volume(entry, raw, origin, budget);
  const auto mapped = map_volume(path);
  if (const auto* problem = std::get_if<std::string>(&mapped)) return *problem;
  VolumeOrigin own = origin;
  use_folder(path, own);
  note_files(path, std::get<SharedBytes>(mapped), own);
  return open_volume_file(path, std::get<SharedBytes>(mapped), raw, own, budget);
}

std::variant<qnv::VolumeSource, std::string> open_volume_file(const std::string& path, const SharedBytes& bytes,
                                                              const RawVolume& raw, const VolumeOrigin& origin,
                                                              const WorldBudget& budget) {
  if (bytes.file && (origin.component.growing || origin.need)) bytes.file->tolerate_writes();
  SharedBytes content = bytes;
  content.need = origin.need;
  BytesResult unpacked = unpacked_file(path, content, budget);
  if (auto* problem = std::get_if<std::string>(&unpacked)) return std::move(*problem);
  const VolumeFile file{path,
                        origin.name.empty() ? path.substr(path.rfind('/') + 1) : origin.name,  // all if no '/'
                        std::get<SharedBytes>(std::move(unpacked)),
                        origin.read_beside ? origin.read_beside : reader_beside(path, {}),
                        budget,
                        origin.component,
                        origin.read_files ? origin.read_files : files_beside(path, {}),
                        origin.read_files ? origin.list_folder : lister_beside(path)};
  if (file.content.bytes.empty()) return path + ": the file is empty; expected a volume";
  VolumeResult result = open_as(format_of(path, file.content.bytes), file, raw);
  if (const auto changed = file.content.file ? file.content.file->changed() : std::nullopt)
    return path + ": " + *changed;
  if (const auto* problem = std::get_if<std::string>(&result)) return path + ": " + *problem;
  note_choices(std::get<qnv::VolumeSource>(result), file.component);
  if (const auto problem = too_large_slices(std::get<qnv::VolumeSource>(result).layout, *budget))
    return path + ": " + *problem;
  return result;
}

std::optional<std::string> too_large_slices(const qnv::VolumeLayout& layout, const Budget& budget) {
  // Consumers of a volume hold up to kSlices slices as floats in memory.
  constexpr std::uint64_t kSlices = 8;
  const std::uint64_t voxels = qnv::slice_voxels(layout);
  if (kSlices * sizeof(float) * voxels <= budget.left(Resource::volumes)) return std::nullopt;
  return "slices of " + std::to_string(voxels) + " voxels take " + budget.refusal(Resource::volumes);
}

bool is_volume(std::string_view path, std::span<const std::byte> bytes) {
  if (!is_gzip(bytes)) return format_of(path, bytes) != nullptr;
  std::vector<std::byte> head;
  (void)gunzip(bytes, own_budget(), [&](std::string_view piece) {
    constexpr std::size_t kEnough = 4096;
    const auto* first = reinterpret_cast<const std::byte*>(piece.data());
    head.assign(first, first + std::min(piece.size(), kEnough));
    return false;
  });
  return format_of(path, head) != nullptr;
}

std::span<const VolumeFormatName> volume_format_names() {
  static constexpr auto kNames = [] {
    std::array<VolumeFormatName, std::size(kVolumeFormats)> names{};
    for (std::size_t i = 0; i < names.size(); ++i) {
      names[i] = kVolumeFormats[i].name;
      names[i].sniff = kVolumeFormats[i].sniff;
    }
    return names;
  }();
  return kNames;
}

}  // namespace gs::app
