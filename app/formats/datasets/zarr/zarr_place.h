#pragma once

#include "app/formats/datasets/zarr/zarr_file.h"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// Returns the place of a container in a ZIP archive, or a message.
[[nodiscard]] std::variant<ZarrPlace, std::string> zarr_place_of_zip(SharedBytes archive, const WorldBudget& budget);

/// Returns the names of the metadata files by which readers open a container, in the order of the attempts.
[[nodiscard]] std::span<const std::string_view> zarr_entry_files();
/// Returns the URLs of metadata files to try, if a URL names a container on a server: it has a part that ends with
/// ".zarr" or ".n5", and no file behind. Otherwise returns nothing.
[[nodiscard]] std::vector<std::string> zarr_entries_of_url(std::string_view url);
/// Returns the name of the folder if a path names a metadata file of a container, otherwise the name of the file.
[[nodiscard]] std::string zarr_title_of(std::string_view path);

}  // namespace gs::app
