#pragma once

#include "app/formats/datasets/conventions/dataset_file.h"
#include "app/formats/volume/volume.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Datasets of a file, or a message.
using ListedDatasets = std::variant<std::vector<DatasetEntry>, std::string>;

/// Lists the datasets of a local file as list_datasets() does, but in a confined child, as open_volume_confined() opens
/// volumes. Returns a message without the file name on failure.
[[nodiscard]] ListedDatasets list_datasets_confined(const std::string& path, const VolumeOrigin& origin,
                                                    const WorldBudget& budget);

/// Bytes of a list between processes. Trusts nothing: returns nullopt for bytes that no honest child sends.
[[nodiscard]] std::vector<std::byte> transfer_bytes(const ListedDatasets& listed);
[[nodiscard]] std::optional<ListedDatasets> listed_datasets_of(std::span<const std::byte> bytes);

/// Child: lists the datasets of a file, for the request of list_datasets_confined().
[[nodiscard]] ListedDatasets list_in_child(const std::string& path, const SharedBytes& file, const VolumeOrigin& origin,
                                           const WorldBudget& budget);

}  // namespace gs::app
