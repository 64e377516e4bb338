#pragma once

#include "app/formats/common/voxel_component.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {

class TransferReader;
class TransferWriter;

/// Form in which a dataset is shown.
enum class DatasetForm : std::uint8_t { nothing, volume, mesh };

/// Dataset of a file, as shown in lists.
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
  bool has_globe = false;  // a volume that --globe yes turns into a mesh

  /// Returns the form for the choice of a user.
  [[nodiscard]] DatasetForm form_for(const VoxelComponent& choice) const {
    return has_globe && choice.globe.value_or(false) ? DatasetForm::mesh : form;
  }
};

/// Datasets of an open file, and the choices within the shown dataset.
struct DatasetList {
  std::vector<DatasetEntry> entries;
  std::string shown;                           // path of the dataset that was read; empty if none was
  std::uint64_t components = 1;                // numbers of an element
  std::vector<std::string> component_names{};  // or none
  std::uint64_t channels = 1;                  // indices on the axes that are neither space nor time nor components
  std::vector<double> times{};                 // of its steps; empty if it has one
  std::pair<double, double> range{0, 0};       // minimum and maximum of the values of a surface
};

/// Returns true if an array, by its name, only numbers points or cells and holds no result.
[[nodiscard]] bool is_bookkeeping(std::string_view name);

/// Returns the entry that a user chose by its path or the last part of it, or the default without a choice. Returns a
/// message with the nearest names if there is none.
[[nodiscard]] std::variant<std::size_t, std::string> choose_dataset(std::span<const DatasetEntry> entries,
                                                                    std::string_view choice, bool by_view = false);

/// Returns the shape of a dataset: "24 x 170 x 180", or "1 value".
[[nodiscard]] std::string shape_text(std::span<const std::uint64_t> shape);

/// Writes a list for another process. Omits the entries beyond kMostListed.
void write_datasets(TransferWriter& to, const DatasetList& list);
inline constexpr std::size_t kMostListed = 20'000;
/// Reads a list. Throws Impossible.
[[nodiscard]] DatasetList read_datasets(TransferReader& from);

}  // namespace gs::app
