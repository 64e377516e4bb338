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

/// Returns the type of a file by its first bytes (see `first_bytes`), else by its name without a final `.gz`, else
/// VRML97, which reports errors best.
[[nodiscard]] const ContentType& content_type_of(std::string_view path, std::span<const std::byte> bytes);

/// Rejects a file by its first bytes (at most 8 KiB) if its name promises a type with a mark that they lack. Returns
/// nullopt if reading it makes sense. A large file can be refused before it is mapped.
[[nodiscard]] std::optional<std::string> refuse_first_bytes(std::string_view path, std::span<const std::byte> first);

/// Returns the type that the first bytes identify, or null if there is none.
[[nodiscard]] const ContentType* content_type_by_mark(std::span<const std::byte> bytes);

/// The first bytes of a file, behind its gzip wrapper if it has one: enough to tell its type.
[[nodiscard]] std::vector<std::byte> first_bytes(std::span<const std::byte> bytes);

/// "VRML97 (.wrl .wrz .vrml), PLY (.ply), ...": for help.
[[nodiscard]] std::string content_type_list();

/// Reports whether bytes begin like a QNV stream with the outlines payload, which has polygons instead of vectors.
[[nodiscard]] bool is_outline_stream(std::span<const std::byte> bytes);

}  // namespace gs::app
