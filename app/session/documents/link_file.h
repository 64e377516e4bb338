#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace gs::app {

/// Link to a scene. It lets a web browser start this program with the URL of a stream, instead of downloading the
/// stream. Playlists do the same for sounds.
///
/// As a file (`.gslink`, application/x-ghostspace-link), a link consists of a line "[GhostSpace link]" and lines
/// "KEY=VALUE" in UTF-8. The key URL is required; Viewpoint and Budget are optional. Other keys and lines that begin
/// with # are ignored.
///
/// As a URL, a link is "ghostspace:" before another URL. "ghostspace://" may replace "ghostspace:http://".
struct SceneLink {
  std::string url;         // http, https or cells
  std::string viewpoint;   // name of the initial Viewpoint; empty means the first one
  std::size_t budget = 0;  // vector budget; 0 means that the link sets none
};

/// URL scheme of links to scenes.
inline constexpr std::string_view kLinkScheme = "ghostspace";
inline constexpr std::string_view kLinkMime = "application/x-ghostspace-link", kLinkExtension = ".gslink";

/// Parses the text of a link file. Returns an error if the text is not a link. Safe for untrusted bytes: the URL of a
/// link is always a network URL and cannot name a local file.
[[nodiscard]] std::variant<SceneLink, std::string> read_link_file(std::string_view text);
[[nodiscard]] std::string link_file_text(const SceneLink& link);
/// Parses a URL of the scheme "ghostspace" to a link or an error. Returns nullopt if the URL has another scheme.
[[nodiscard]] std::optional<std::variant<SceneLink, std::string>> read_link_url(std::string_view url);

/// Reads the link that a file name or URL of the user denotes. Returns nullopt if the name or URL has not the form of a
/// link.
[[nodiscard]] std::optional<std::variant<SceneLink, std::string>> scene_link_of(const std::string& path_or_url);

}  // namespace gs::app
