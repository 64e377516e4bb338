#include "app/formats/datasets/conventions/dataset_file.h"

#include "app/formats/archive/zip_archive.h"
#include "app/formats/datasets/arrays/classic_netcdf.h"
#include "app/formats/datasets/arrays/dataset_module.h"
#include "app/formats/datasets/conventions/conventions_table.h"
#include "app/formats/datasets/conventions/xdmf.h"
#include "app/formats/datasets/zarr/zarr_place.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace gs::app {
namespace {

constexpr Convention kConventions[] = {
    {"VTKHDF", suits_vtkhdf, list_vtkhdf, vtkhdf_volume, vtkhdf_mesh, vtkhdf_grid},
    {"openPMD", suits_openpmd, list_openpmd, openpmd_volume, openpmd_mesh},
    {"Exodus II", suits_exodus, list_exodus, exodus_volume, exodus_mesh, exodus_grid},
    {"OME-Zarr", suits_ome, list_ome, ome_volume, nullptr},
    {"CF", suits_cf, list_cf, cf_volume, cf_mesh},
    {"plain", suits_any, list_plain, plain_volume, nullptr},
};

/// File of arrays with a convention.
class TreeFile final : public DatasetFile {
 public:
  explicit TreeFile(DatasetTree tree) : tree_(std::move(tree)) {
    convention_ = std::ranges::find_if(kConventions, [this](const Convention& one) { return one.suits(tree_); });
    entries_ = convention_->list(tree_);
  }
  const std::vector<DatasetEntry>& entries() const override { return entries_; }
  VolumeResult volume(std::size_t entry, const VoxelComponent& choice) override {
    VolumeResult result = convention_->volume(tree_, entries_[entry], choice);
    if (auto* problem = std::get_if<std::string>(&result)) *problem = entries_[entry].path + ": " + *problem;
    if (auto* source = std::get_if<qnv::VolumeSource>(&result))
      source->trouble = [file = tree_.file()] { return file->trouble(); };
    return result;
  }
  void mesh(std::size_t entry, const VoxelComponent& choice, MeshBuilder& builder) override {
    if (convention_->mesh) convention_->mesh(tree_, entries_[entry], choice, builder);
  }
  std::optional<GridRows> grid(std::size_t entry, const VoxelComponent& choice) override {
    return convention_->grid ? convention_->grid(tree_, entries_[entry], choice) : std::nullopt;
  }
  std::shared_ptr<ArrayFile> arrays() const override { return tree_.file(); }

 private:
  DatasetTree tree_;
  const Convention* convention_;
  std::vector<DatasetEntry> entries_;
};

/// Opens a Zarr or N5 container through one of its metadata files, or in an archive.
DatasetFileResult open_zarr(const VolumeFile& file) {
  // Requests a list from a server only if nothing else names the nodes.
  const bool lists = file.list_folder && (file.component.served || file.list_folder("."));
  ZarrPlace place{file.read_files, lists ? file.list_folder : nullptr, file.budget, file.component.served};
  if (is_zip(file.content.bytes)) {
    auto zipped = zarr_place_of_zip(file.content, file.budget);
    if (auto* const problem = std::get_if<std::string>(&zipped)) return std::move(*problem);
    place = std::move(std::get<ZarrPlace>(zipped));
  }
  if (!place.read) return std::string("other files are not read here");
  auto opened = ZarrFile::open(std::move(place));
  if (auto* const problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  auto made = std::make_unique<TreeFile>(
      DatasetTree(std::get<std::shared_ptr<ZarrFile>>(std::move(opened)), file.content, file.budget));
  return std::unique_ptr<DatasetFile>(std::move(made));
}

}  // namespace

std::span<const Convention> conventions() { return kConventions; }

bool is_hdf5(std::span<const std::byte> bytes) {
  constexpr std::string_view kMark("\x89HDF\r\n\x1a\n", 8);
  // A user block of 512, 1024, 2048, ... bytes may precede the mark.
  constexpr std::size_t kFirst = 512, kMost = 32768;
  for (std::size_t at = 0; at + kMark.size() <= bytes.size() && at <= kMost; at = at == 0 ? kFirst : at * 2)
    if (std::memcmp(bytes.data() + at, kMark.data(), kMark.size()) == 0) return true;
  return false;
}

std::optional<DatasetFormat> dataset_format_of(std::string_view path, std::span<const std::byte> bytes) {
  if (is_hdf5(bytes)) return DatasetFormat::hdf5;
  if (is_classic_netcdf(bytes)) return DatasetFormat::netcdf;
  const std::string name = lower_case(path);
  if (is_xdmf(bytes) || name.ends_with(".xdmf") || name.ends_with(".xmf")) return DatasetFormat::xdmf;
  if (is_zarr(bytes)) return DatasetFormat::zarr;
  return std::nullopt;
}

DatasetFileResult open_dataset_file(DatasetFormat format, const VolumeFile& file) {
  if (format == DatasetFormat::xdmf) return open_xdmf_file(file);
  if (format == DatasetFormat::zarr) return open_zarr(file);
  constexpr std::uint64_t kMostCache = std::uint64_t{64} << 20;
  const auto cache = static_cast<std::size_t>(std::min(file.budget->left(Resource::volumes) / 8, kMostCache));
  ArrayFileResult opened = format == DatasetFormat::netcdf
                               ? open_classic_netcdf({file.content.owner, file.content.bytes, file.content.need})
                               : open_with_module("HDF5", file.content, cache);
  if (auto* problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  auto made = std::make_unique<TreeFile>(
      DatasetTree(std::get<std::shared_ptr<ArrayFile>>(std::move(opened)), file.content, file.budget));
  return std::unique_ptr<DatasetFile>(std::move(made));
}

}  // namespace gs::app
