#pragma once

#include "app/formats/common/asset.h"
#include "app/formats/common/dataset_list.h"
#include "app/formats/common/import_limits.h"
#include "base/diagnostic.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

// Bytes of requests and results between this process and a child that imports files. Both are the same program, so the
// bytes have no versions.
namespace gs::app {

/// Request to import a file, without the bytes of the file.
struct ImportRequest {
  std::string type;  // ContentType::name
  std::string path, name;
  bool reads_files = false;  // files to which the file refers can be read
  bool for_x3d = false;
  VoxelComponent component{};
  BudgetLeft left{};  // rest of the budget, by resource
};
[[nodiscard]] std::vector<std::byte> transfer_bytes(const ImportRequest& request);
[[nodiscard]] std::optional<ImportRequest> import_request_of(std::span<const std::byte> bytes);

/// Reports whether transfer_bytes() can write an asset: nothing, a mesh, an imported scene, splats or Gaussians.
[[nodiscard]] bool can_transfer(const Asset& asset);
/// Returns the bytes of an asset that can_transfer() accepts, with its diagnostics and the datasets of its file.
[[nodiscard]] std::vector<std::byte> transfer_bytes(const Asset& asset, const Diagnostics& diagnostics,
                                                    const DatasetList& datasets = {});

/// Reads an asset from a child. Trusts nothing: numbers must be finite and in their ranges, indices valid, arrays of
/// fitting sizes. Otherwise reports an error and returns std::monostate. Adds the child's diagnostics to those of
/// `source`, with the path of `source` and without control characters. Charges the memory to the budget.
[[nodiscard]] Asset asset_of(std::span<const std::byte> bytes, const ImportSource& source);

}  // namespace gs::app
