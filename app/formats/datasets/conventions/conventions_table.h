#pragma once

#include "app/formats/datasets/arrays/grid_volume.h"
#include "app/formats/datasets/conventions/convention.h"

// Functions of the rows of the table of conventions.
namespace gs::app {

/// Reads common attributes of values into a grid: unit, title, scale, missing values, valid range.
void read_value_attributes(DatasetTree& tree, const ArrayInfo& array, GridSpec& spec);
/// Reads attributes that many programs share into a grid: unit, scale, missing values, spacing, names of axes.
void read_common_attributes(DatasetTree& tree, const ArrayInfo& array, GridSpec& spec);

[[nodiscard]] bool suits_any(DatasetTree& tree);
[[nodiscard]] std::vector<DatasetEntry> list_plain(DatasetTree& tree);
[[nodiscard]] VolumeResult plain_volume(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice);

[[nodiscard]] bool suits_cf(DatasetTree& tree);
[[nodiscard]] std::vector<DatasetEntry> list_cf(DatasetTree& tree);
[[nodiscard]] VolumeResult cf_volume(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice);
void cf_mesh(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice, MeshBuilder& builder);

[[nodiscard]] bool suits_exodus(DatasetTree& tree);
[[nodiscard]] std::vector<DatasetEntry> list_exodus(DatasetTree& tree);
[[nodiscard]] VolumeResult exodus_volume(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice);
void exodus_mesh(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice, MeshBuilder& builder);
[[nodiscard]] std::optional<GridRows> exodus_grid(DatasetTree& tree, const DatasetEntry& entry,
                                                  const VoxelComponent& choice);

[[nodiscard]] bool suits_vtkhdf(DatasetTree& tree);
[[nodiscard]] std::vector<DatasetEntry> list_vtkhdf(DatasetTree& tree);
[[nodiscard]] VolumeResult vtkhdf_volume(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice);
void vtkhdf_mesh(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice, MeshBuilder& builder);
[[nodiscard]] std::optional<GridRows> vtkhdf_grid(DatasetTree& tree, const DatasetEntry& entry,
                                                  const VoxelComponent& choice);

[[nodiscard]] bool suits_ome(DatasetTree& tree);
[[nodiscard]] std::vector<DatasetEntry> list_ome(DatasetTree& tree);
[[nodiscard]] VolumeResult ome_volume(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice);

[[nodiscard]] bool suits_openpmd(DatasetTree& tree);
[[nodiscard]] std::vector<DatasetEntry> list_openpmd(DatasetTree& tree);
[[nodiscard]] VolumeResult openpmd_volume(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice);
void openpmd_mesh(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice, MeshBuilder& builder);

}  // namespace gs::app
