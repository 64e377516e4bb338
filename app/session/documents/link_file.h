#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace gs::app {

/// Link to a scene. Like a playlist for sounds, it lets a web browser open the stream itself instead of a downloaded
/// copy.
///
/// As a file (`.gslink`, application/x-ghostspace-link): a line "[GhostSpace link]", then lines "KEY=VALUE" in UTF-8.
/// The key URL is required; Viewpoint and Budget are optional. Other keys and lines that begin with # are ignored.
///
/// As a URL: "ghostspace:" before another URL. "ghostspace://" may replace "ghostspace:http://".
struct SceneLink {
  std::string url;         // http, https or cells
  std::string viewpoint;   // empty means none
  std::size_t budget = 0;  // vectors; 0 means no budget
};

/// Scheme of a link to a scene.
inline constexpr std::string_view kLinkScheme = "ghostspace";
inline constexpr std::string_view kLinkMime = "application/x-ghostspace-link", kLinkExtension = ".gslink";

/// Parses the text of a link file. Returns the error if it is not a link. Safe for untrusted bytes: a link leads only
/// to the network and cannot name anything local.
[[nodiscard]] std::variant<SceneLink, std::string> read_link_file(std::string_view text);
[[nodiscard]] std::string link_file_text(const SceneLink& link);
/// Parses a URL of the scheme "ghostspace". Returns nullopt if the URL has another scheme.
[[nodiscard]] std::optional<std::variant<SceneLink, std::string>> read_link_url(std::string_view url);

/// Parses the link that the user's file or URL names. Returns nullopt if its name is not that of a link. Reads the
/// file.
[[nodiscard]] std::optional<std::variant<SceneLink, std::string>> scene_link_of(const std::string& path_or_url);

}  // namespace gs::app
