#pragma once

#include "app/formats/common/mesh_asset.h"
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

/// Form in which a dataset is shown.
enum class DatasetForm : std::uint8_t { nothing, volume, mesh };

/// Dataset of a file, as lists of users show it.
struct DatasetEntry {
  std::string path;                  // "/data/1/meshes/E/x"
  std::vector<std::uint64_t> shape;  // slowest axis first
  std::string type;                  // "f32", "3 x f32 (x, y, z)"
  std::string unit{};
  std::string axes{};  // names of the axes: "time, latitude, longitude"
  DatasetForm form = DatasetForm::nothing;
  std::string note{};      // meaning by the conventions of the file, or the reason why it is not shown
  double rank = 0;         // of datasets that can be shown, the highest one is the default
  double view_rank = 0;    // the same for views that read parts of large arrays; 0 means `rank`
  bool is_minor = false;   // describes other datasets: coordinates, connectivity, numbers of points
  bool has_globe = false;  // a volume that is a mesh on a globe if the user wants that

  /// Returns the form for the choice of a user.
  [[nodiscard]] DatasetForm form_for(const VoxelComponent& choice) const {
    return has_globe && choice.globe.value_or(false) ? DatasetForm::mesh : form;
  }
};

/// File of datasets: its arrays, read by the conventions that it follows. One thread at a time.
class DatasetFile {
 public:
  virtual ~DatasetFile() = default;
  [[nodiscard]] virtual const std::vector<DatasetEntry>& entries() const = 0;
  /// Opens a dataset with DatasetForm::volume. Returns a message on failure.
  [[nodiscard]] virtual VolumeResult volume(std::size_t entry, const VoxelComponent& choice) = 0;
  /// Reads a dataset with DatasetForm::mesh. Reports problems. Throws OutOfBudget.
  virtual void mesh(std::size_t entry, const VoxelComponent& choice, MeshBuilder& builder) = 0;
};

/// File to open: its format, and its content as a volume's file has it.
enum class DatasetFormat : std::uint8_t { hdf5, netcdf, xdmf, zarr };
[[nodiscard]] bool is_hdf5(std::span<const std::byte> bytes);
/// Returns the format that the first bytes or the name state, or nullopt.
[[nodiscard]] std::optional<DatasetFormat> dataset_format_of(std::string_view path, std::span<const std::byte> bytes);

using DatasetFileResult = std::variant<std::unique_ptr<DatasetFile>, std::string>;
/// Opens a file of datasets. Returns a message on failure. Safe for untrusted files as far as the libraries are.
[[nodiscard]] DatasetFileResult open_dataset_file(DatasetFormat format, const VolumeFile& file);

/// Returns the entry that a user chose by its path or the last part of it, or the default without a choice. Returns a
/// message with the nearest names if there is none.
[[nodiscard]] std::variant<std::size_t, std::string> choose_dataset(std::span<const DatasetEntry> entries,
                                                                    std::string_view choice, bool by_view = false);

/// Returns the shape of a dataset: "24 x 170 x 180", or "1 value".
[[nodiscard]] std::string shape_text(std::span<const std::uint64_t> shape);

}  // namespace gs::app
