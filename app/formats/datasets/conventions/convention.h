#pragma once

#include "app/formats/datasets/arrays/dataset_tree.h"
#include "app/formats/datasets/conventions/dataset_file.h"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace gs::app {

/// Set of rules for names and attributes of arrays, such as CF. A file follows one of them.
struct Convention {
  std::string_view name;
  bool (*suits)(DatasetTree& tree);
  /// Lists all datasets of the file, those with a meaning by the convention first.
  std::vector<DatasetEntry> (*list)(DatasetTree& tree);
  VolumeResult (*volume)(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice);
  /// Null if the convention has no meshes.
  void (*mesh)(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice, MeshBuilder& builder);
  /// Finds the arrays of an unstructured grid, without reading them. Returns nullopt for other datasets, and for grids
  /// that cannot be read in parts. Null if the convention has no such grids.
  std::optional<GridRows> (*grid)(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice) = nullptr;
};

/// Returns the table of conventions. Every file suits the last one.
[[nodiscard]] std::span<const Convention> conventions();

/// Returns the entry of an array: shape, type, unit and names of axes. It is not shown.
[[nodiscard]] DatasetEntry entry_of(DatasetTree& tree, const ArrayInfo& array);
/// Returns true if an array has numbers that can be read.
[[nodiscard]] bool is_readable(const ArrayInfo& array);
/// Returns the number of elements of an array, or of the last `axes` axes.
[[nodiscard]] double element_count(const ArrayInfo& array);

}  // namespace gs::app
