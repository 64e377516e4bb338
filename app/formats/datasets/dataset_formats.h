#pragma once

#include "app/formats/common/content_type.h"
#include "app/formats/datasets/conventions/dataset_file.h"

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Reports whether files of a type have datasets, which users may list and choose.
[[nodiscard]] bool has_datasets(const ContentType& type);
/// Returns true if the chosen dataset of a file is a mesh. A file that cannot be opened has none.
[[nodiscard]] bool holds_dataset_mesh(const ImportSource& source);
/// Reads the chosen dataset of a file as a mesh.
[[nodiscard]] Asset read_dataset_mesh(const ImportSource& source);

/// Unstructured grid of a file of arrays, which can be read in parts.
struct DatasetGrid {
  std::shared_ptr<ArrayFile> file;
  GridRows rows;
};
/// Opens the chosen dataset of a file of arrays if it is an unstructured grid that can be read in parts. Reads the
/// sizes of its parts only. Returns nullopt for other files and datasets.
[[nodiscard]] std::optional<DatasetGrid> open_dataset_grid(const VolumeFile& file);

/// Lists the datasets of a file that open_dataset_file() opens. Returns a message on failure.
[[nodiscard]] std::variant<std::vector<DatasetEntry>, std::string> list_datasets(const ImportSource& source);
[[nodiscard]] std::variant<std::vector<DatasetEntry>, std::string> list_datasets(const VolumeFile& file);

/// Loads the module for scientific formats. Files that need it report problems.
void load_datasets();
/// Loads the module for scientific formats if a local file needs it, for processes that confine themselves afterwards.
void prepare_datasets(const std::string& path);

/// Metadata keys of a volume from a file of datasets: the path of the dataset, and a note if the file has several.
inline constexpr std::string_view kDatasetMetadata = "dataset", kDatasetsMetadata = "datasets";

}  // namespace gs::app
