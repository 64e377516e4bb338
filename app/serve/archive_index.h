#pragma once

#include "app/formats/content_types.h"
#include "net/serve/http_server.h"

#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

/// Returns the content type of a file name, ignoring a trailing `.gz`, or null if the name has none.
[[nodiscard]] const ContentType* content_type_by_name(std::string_view name);

/// Returns the MIME type that a server sends for a file name, and whether gzip saves bytes. Looks in our content types,
/// then in those of the web; otherwise returns application/octet-stream.
[[nodiscard]] net::ServedType served_type_of(std::string_view name);

/// Returns true if a file of this name can be encoded as a QNV stream.
[[nodiscard]] bool can_be_encoded(std::string_view name);

/// Returns the page of a folder, as HTML without scripts or as JSON. `made` adds thumbnails of worlds and links to made
/// streams. Names may contain any bytes.
///
/// `request.query` may have the form fields `search` (part of a name) and `sort` (name, size or date; a leading -
/// reverses the order).
[[nodiscard]] net::FolderPage archive_index(const net::FolderListing& listing, const net::FolderRequest& request,
                                            bool made);
/// Returns the link file (see SceneLink) that opens a scene from a web page. The name "x.wrl.gslink" gives a link to
/// x.wrl, with the folder's URL as the client uses it. Returns nullopt for other names.
[[nodiscard]] std::optional<net::FolderPage> scene_link_page(const std::string& name, const net::FolderRequest& request,
                                                             bool made);

}  // namespace gs::app
