#pragma once

#include "app/formats/common/content_type.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

[[nodiscard]] std::span<const ContentType> content_types();

/// Returns the type of a file. Decides by the first bytes (see `first_bytes`), else by the name without a final `.gz`.
/// Includes the foreign types, which have a `remedy` instead of an importer. Otherwise returns VRML97 for text, because
/// its parser reports the best errors.
[[nodiscard]] const ContentType& content_type_of(std::string_view path, std::span<const std::byte> bytes);

/// Returns the type of a whole file of `type`, which may hold a mesh instead of a volume (ContentType::holds_mesh). A
/// confined child looks into local files.
[[nodiscard]] const ContentType& type_of_content(const ContentType& type, const ImportSource& source);

/// Refuses a file if its name belongs to a type with a `mark` and the file does not begin with that mark. Returns the
/// message, or nullopt to read the file. `first` may be limited to 8 KiB, so that a large file need not be mapped.
[[nodiscard]] std::optional<std::string> refuse_first_bytes(std::string_view path, std::span<const std::byte> first);

/// Returns the type that the first bytes identify, or null.
[[nodiscard]] const ContentType* content_type_by_mark(std::span<const std::byte> bytes);

/// Returns the type with the extension of a name, in any case and without a final `.gz`, or null.
[[nodiscard]] const ContentType* content_type_by_name(std::string_view path);

/// Returns the first bytes of a file, enough to detect its type. Decompresses them if the file is gzip-compressed.
[[nodiscard]] std::vector<std::byte> first_bytes(std::span<const std::byte> bytes);

/// Returns the metadata file (Zarr, N5 or SOG) by which readers open a local folder. Returns an empty text for other
/// folders and for files.
[[nodiscard]] std::string file_of_folder(const std::string& path);

/// Returns the list of types for help texts: "VRML97 (.wrl .wrz .vrml), PLY (.ply), ...".
[[nodiscard]] std::string content_type_list();

/// Returns true if the bytes begin like a QNV stream with the outlines payload, which has polygons instead of vectors.
[[nodiscard]] bool is_outline_stream(std::span<const std::byte> bytes);

}  // namespace gs::app
