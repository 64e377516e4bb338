#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

/// Returns true if a path has an extension of a text format with all nodes (scene_formats.h). Ignores case.
[[nodiscard]] bool is_text_path(std::string_view path);
/// Returns true if a path has the extension of QNV streams. Ignores case.
[[nodiscard]] bool is_stream_path(std::string_view path);
/// Returns the extensions of all formats in which a world can be saved: ".wrl (VRML97), .x3d (X3D XML), ...; only the
/// surface: .ply, ...".
[[nodiscard]] std::string save_format_list();
/// Returns a path with ".wrl" added if it has no extension of a format in which a world can be saved.
[[nodiscard]] std::string path_with_format(const std::string& path);

/// Writes a text to a file completely or not at all. Compresses it if is_packed_path(). Returns the error,
/// or nullopt.
[[nodiscard]] std::optional<std::string> write_world_text(const std::string& path, std::string_view text);

}  // namespace gs::app
