#pragma once

#include "app/formats/common/voxel_component.h"
#include "app/formats/datasets/arrays/dataset_tree.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Common code of the readers of VTKHDF files.
namespace gs::app {

inline constexpr std::string_view kVtkhdfPointData = "/VTKHDF/PointData", kVtkhdfCellData = "/VTKHDF/CellData";
inline constexpr const char* kVtkhdfRoot = "/VTKHDF";

/// Returns the type of a file, such as "UnstructuredGrid". Early files do not state it. Other files give an empty text.
[[nodiscard]] std::string vtkhdf_type(DatasetTree& tree);
/// Reports whether an array is directly in a folder.
[[nodiscard]] bool is_in_folder(const std::string& path, std::string_view folder);
/// Returns the count of numbers per element of an array. Its first `axes` axes count elements.
[[nodiscard]] std::size_t parts_of_array(const ArrayInfo& array, std::size_t axes);
/// Returns the times of the steps; empty if the file has none.
[[nodiscard]] std::vector<double> vtkhdf_times(DatasetTree& tree);

/// Chosen step of a mesh in a VTKHDF file: a range of parts.
class VtkhdfStep {
 public:
  explicit VtkhdfStep(DatasetTree& tree) : tree_(tree) {}

  /// Chooses a step. Returns an error if there is no such step.
  [[nodiscard]] std::optional<std::string> choose(const VoxelComponent& choice);
  /// Returns the number of steps; 0 for a file without steps.
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  [[nodiscard]] std::uint64_t step() const { return step_; }
  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  /// Returns the number of the first part of the step.
  [[nodiscard]] double part() const { return part_; }

  /// Returns the number of the step in an array of the group Steps. Returns `otherwise` if there is none.
  [[nodiscard]] double offset(const std::string& name, std::size_t column, double otherwise = 0);
  /// Returns the rows of the step in an array with one number per part: first row and count.
  [[nodiscard]] std::pair<std::uint64_t, std::uint64_t> parts_of_step(const ArrayInfo& array) const;

 private:
  DatasetTree& tree_;
  std::vector<double> times_;
  std::uint64_t steps_ = 0, step_ = 0, parts_ = 0;
  double part_ = 0;
};

}  // namespace gs::app
