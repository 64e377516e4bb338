#pragma once

#include "app/formats/content_types.h"
#include "app/formats/streamed_names.h"
#include "net/serve/http_server.h"

#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

/// Returns the MIME type that a server sends for a file name, and whether gzip saves bytes. Searches the content types
/// of the program, then common types of the web. Returns application/octet-stream for other names.
[[nodiscard]] net::ServedType served_type_of(std::string_view name);

/// Returns the page of a folder, as HTML without scripts or as JSON. `name` is the name of the served folder. If
/// `made`, the page has thumbnails of worlds and links to made streams. Names may contain any bytes.
///
/// `request.query` may have the form fields `search` (part of a name) and `sort` (name, size or date; a leading "-"
/// reverses the order).
[[nodiscard]] net::FolderPage archive_index(const net::FolderListing& listing, const net::FolderRequest& request,
                                            bool made, const std::string& name = "Archive");
/// Returns the link file that opens a scene from a web page (see SceneLink). For the name "x.wrl.gslink", the file
/// links to x.wrl at the URL by which the client reached the folder. Returns nullopt for other names.
[[nodiscard]] std::optional<net::FolderPage> scene_link_page(const std::string& name, const net::FolderRequest& request,
                                                             bool made);

}  // namespace gs::app
