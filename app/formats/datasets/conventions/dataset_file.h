#pragma once

#include "app/formats/common/dataset_list.h"
#include "app/formats/common/mesh_asset.h"
#include "app/formats/datasets/arrays/array_file.h"
#include "app/formats/datasets/conventions/grid_rows.h"
#include "app/formats/volume/volume_common.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// File of datasets: its arrays, read by the conventions that it follows. One thread at a time.
class DatasetFile {
 public:
  virtual ~DatasetFile() = default;
  [[nodiscard]] virtual const std::vector<DatasetEntry>& entries() const = 0;
  /// Opens a dataset with DatasetForm::volume. Returns a message on failure.
  [[nodiscard]] virtual VolumeResult volume(std::size_t entry, const VoxelComponent& choice) = 0;
  /// Reads a dataset with DatasetForm::mesh. Reports problems. Throws OutOfBudget.
  virtual void mesh(std::size_t entry, const VoxelComponent& choice, MeshBuilder& builder) = 0;
  /// Returns the arrays of an unstructured grid that can be read in parts. Returns nullopt for other datasets.
  [[nodiscard]] virtual std::optional<GridRows> grid(std::size_t /*entry*/, const VoxelComponent& /*choice*/) {
    return std::nullopt;
  }
  /// Returns the file with the arrays that grid() names. Returns null if the format has no grids.
  [[nodiscard]] virtual std::shared_ptr<ArrayFile> arrays() const { return nullptr; }
};

/// File to open: its format, and its content as a volume's file has it.
enum class DatasetFormat : std::uint8_t { hdf5, netcdf, xdmf, zarr };
[[nodiscard]] bool is_hdf5(std::span<const std::byte> bytes);
/// Returns the format that the first bytes or the name state, or nullopt.
[[nodiscard]] std::optional<DatasetFormat> dataset_format_of(std::string_view path, std::span<const std::byte> bytes);

using DatasetFileResult = std::variant<std::unique_ptr<DatasetFile>, std::string>;
/// Opens a file of datasets. Returns a message on failure. Safe for untrusted files as far as the libraries are.
[[nodiscard]] DatasetFileResult open_dataset_file(DatasetFormat format, const VolumeFile& file);

}  // namespace gs::app
