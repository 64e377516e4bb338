#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace gs::app {

/// What a link to a scene says: as playlists are for sounds, so that a click in a web browser opens the stream itself
/// and not a copy that was fetched before.
///
/// As a file (`.gslink`, application/x-ghostspace-link): a line "[GhostSpace link]", then lines "KEY=VALUE"; of the
/// keys URL is needed, Viewpoint and Budget are not; others, and lines that begin with #, are passed over. UTF-8. As a
/// URL: "ghostspace:" before another URL; "ghostspace://" before one without "http://" is the same.
struct SceneLink {
  std::string url;         // http, https or cells
  std::string viewpoint;   // empty: none
  std::size_t budget = 0;  // vectors; 0: none is said
};

/// Scheme of a link to a scene.
inline constexpr std::string_view kLinkScheme = "ghostspace";
inline constexpr std::string_view kLinkMime = "application/x-ghostspace-link", kLinkExtension = ".gslink";

/// What is wrong, and what was expected, where it is no link. Safe for any bytes: a link leads to the network only, and
/// nothing that is of this machine alone can be named by it.
[[nodiscard]] std::variant<SceneLink, std::string> read_link_file(std::string_view text);
[[nodiscard]] std::string link_file_text(const SceneLink& link);
/// Of a URL of the scheme "ghostspace"; nothing: it is none.
[[nodiscard]] std::optional<std::variant<SceneLink, std::string>> read_link_url(std::string_view url);

/// A file or URL that the user gives: where it leads if it is such a link, by its name; nothing: it is none. Reads the
/// file.
[[nodiscard]] std::optional<std::variant<SceneLink, std::string>> scene_link_of(const std::string& path_or_url);
/// The URL, with the Viewpoint behind it.
[[nodiscard]] std::string place_of(const SceneLink& link);

}  // namespace gs::app
