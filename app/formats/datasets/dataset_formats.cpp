#include "app/formats/datasets/dataset_formats.h"

#include "app/base/local_file.h"
#include "app/formats/datasets/arrays/dataset_module.h"
#include "app/formats/datasets/vtk/vtk_datasets.h"
#include "app/formats/dicom/dicom_datasets.h"
#include "app/formats/tiff/tiff_datasets.h"
#include "base/gzip.h"
#include "net/files/file.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

VolumeFile volume_file(const ImportSource& source) {
  VolumeFile file{source.path,
                  source.name.empty() ? file_name(source.path) : source.name,
                  SharedBytes{nullptr, source.bytes},
                  source.read_file,
                  source.budget,
                  source.component,
                  source.read_files ? source.read_files : files_beside(source.path, {}),
                  source.read_files ? source.list_folder : lister_beside(source.path)};
  if (!file.component.folder.empty() && !file.component.served) file.read_beside = folder_reader(file.component.folder);
  return file;
}

DatasetFileResult open_any_dataset_file(const VolumeFile& file) {
  if (is_dicom(file.content.bytes)) return open_dicom_datasets(file);
  if (is_tiff(file.content.bytes)) return open_tiff_datasets(file);
  if (is_vtk_datasets(file.content.bytes)) return open_vtk_datasets(file);
  const auto format = dataset_format_of(file.name, file.content.bytes);
  if (!format) return std::string("the first bytes are not those of a file of datasets; the file may be damaged");
  return open_dataset_file(*format, file);
}

/// File with a chosen dataset.
struct ChosenDataset {
  std::unique_ptr<DatasetFile> file;
  std::size_t entry = 0;

  [[nodiscard]] DatasetForm form(const VoxelComponent& choice) const { return file->entries()[entry].form_for(choice); }
};

std::variant<ChosenDataset, std::string> open_chosen(const VolumeFile& file) {
  auto opened = open_any_dataset_file(file);
  if (auto* const problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  ChosenDataset chosen{std::get<std::unique_ptr<DatasetFile>>(std::move(opened)), 0};
  if (file.component.found) {
    *file.component.found = {};
    file.component.found->entries = chosen.file->entries();
  }
  auto entry = choose_dataset(chosen.file->entries(), file.component.dataset, file.component.by_view);
  if (auto* const problem = std::get_if<std::string>(&entry)) return std::move(*problem);
  chosen.entry = std::get<std::size_t>(entry);
  if (file.component.found) file.component.found->shown = chosen.file->entries()[chosen.entry].path;
  return chosen;
}

std::size_t shown_datasets(std::span<const DatasetEntry> entries) {
  return static_cast<std::size_t>(std::ranges::count_if(
      entries, [](const DatasetEntry& one) { return one.form != DatasetForm::nothing && !one.is_minor; }));
}

}  // namespace

VolumeResult open_datasets(const VolumeFile& file) {
  auto opened = open_chosen(file);
  if (auto* const problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  auto& chosen = std::get<ChosenDataset>(opened);
  const DatasetEntry& entry = chosen.file->entries()[chosen.entry];
  if (entry.form_for(file.component) == DatasetForm::mesh) return entry.path + std::string(kIsMesh);
  VolumeResult result = chosen.file->volume(chosen.entry, file.component);
  const std::size_t shown = shown_datasets(chosen.file->entries());
  if (auto* const volume = std::get_if<qnv::VolumeSource>(&result); volume && shown > 1)
    add_metadata(volume->layout, kDatasetsMetadata, std::to_string(shown));
  return result;
}

bool has_datasets(const ContentType& type) {
  return type.holds_mesh || type.read == read_dataset_mesh || type.mime == "application/dicom" ||
         type.mime == "image/tiff" || type.mime.starts_with("application/x-vtk-");
}

bool holds_dataset_mesh(const ImportSource& source) {
  const auto opened = open_chosen(volume_file(source));
  const auto* const chosen = std::get_if<ChosenDataset>(&opened);
  return chosen && chosen->form(source.component) == DatasetForm::mesh;
}

Asset read_dataset_mesh(const ImportSource& source) {
  MeshBuilder builder(source.path, source.budget, source.diagnostics);
  builder.choose(source.component);
  try {
    auto opened = open_chosen(volume_file(source));
    if (const auto* const problem = std::get_if<std::string>(&opened)) {
      builder.fail(*problem);
    } else {
      auto& chosen = std::get<ChosenDataset>(opened);
      const DatasetEntry& entry = chosen.file->entries()[chosen.entry];
      const std::size_t shown = shown_datasets(chosen.file->entries());
      if (source.component.dataset.empty() && shown > 1)
        builder.note("shows " + entry.path + ", one of " + std::to_string(shown) +
                     " datasets (--dataset chooses another)");
      chosen.file->mesh(chosen.entry, source.component, builder);
    }
  } catch (const OutOfBudget&) {
    builder.cut_short();
  }
  return builder.take();
}

std::optional<DatasetGrid> open_dataset_grid(const VolumeFile& file) {
  const auto format = dataset_format_of(file.name, file.content.bytes);
  if (format != DatasetFormat::hdf5 && format != DatasetFormat::netcdf) return std::nullopt;
  auto opened = open_chosen(file);
  auto* const chosen = std::get_if<ChosenDataset>(&opened);
  if (!chosen || chosen->form(file.component) != DatasetForm::mesh) return std::nullopt;
  auto rows = chosen->file->grid(chosen->entry, file.component);
  auto arrays = chosen->file->arrays();
  if (!rows || !arrays) return std::nullopt;
  return DatasetGrid{std::move(arrays), std::move(*rows)};
}

void load_datasets() { (void)dataset_module(); }

bool needs_dataset_module(std::string_view path, std::span<const std::byte> bytes) {
  if (is_gzip(bytes)) {
    const std::string name = lower_case(path);
    return std::ranges::any_of(
        std::initializer_list<std::string_view>{".h5.gz", ".hdf5.gz", ".hdf.gz", ".nc.gz", ".xdmf.gz"},
        [&](std::string_view end) { return name.ends_with(end); });
  }
  if (is_tiff(bytes) || is_dicom(bytes) || needs_module_for_vtk(bytes)) return true;
  const auto format = dataset_format_of(path, bytes);
  return format == DatasetFormat::hdf5 || format == DatasetFormat::xdmf || format == DatasetFormat::zarr;
}

void prepare_datasets(const std::string& path) {
  const std::string entry = entry_of_folder(path);
  const auto opened = net::open_file(entry.empty() ? path : entry);
  const auto* const file = std::get_if<net::RandomAccessFile>(&opened);
  if (!file) return;
  constexpr std::size_t kHead = 33'000;  // with the user block that may precede HDF5
  std::vector<std::byte> head(kHead);
  head.resize(file->read(0, head));
  if (needs_dataset_module(path, head)) load_datasets();
}

std::variant<std::vector<DatasetEntry>, std::string> list_datasets(const ImportSource& source) {
  return list_datasets(volume_file(source));
}

std::variant<std::vector<DatasetEntry>, std::string> list_datasets(const VolumeFile& file) {
  auto opened = open_any_dataset_file(file);
  if (auto* const problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  return std::get<std::unique_ptr<DatasetFile>>(opened)->entries();
}

}  // namespace gs::app
