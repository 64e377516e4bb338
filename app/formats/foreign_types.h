#pragma once

#include "app/formats/common/content_type.h"

#include <optional>
#include <span>
#include <string>

namespace gs::app {

/// Returns the types that are recognised but not read. Each row has a `remedy`. A row becomes readable when it moves to
/// `content_types` and gets an importer. The most specific row comes first.
[[nodiscard]] std::span<const ContentType> foreign_types();

/// Returns the type of bytes that no row recognises and that are not text.
[[nodiscard]] const ContentType& unknown_binary();

/// Returns the error for a folder that was given instead of a file, such as a Zarr array. Returns nullopt if `path` is
/// not a folder. Reads the names in the folder.
[[nodiscard]] std::optional<std::string> refusal_of_folder(const std::string& path);

}  // namespace gs::app
