#pragma once

#include "app/formats/content_types.h"
#include "net/serve/http_server.h"

#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

/// The type that a file's name tells, `.gz` at its end not counted; null for
/// none.
[[nodiscard]] const ContentType* content_type_by_name(std::string_view name);

/// The MIME type that a server gives a file, by its name: that of our content
/// types, those of the web, else application/octet-stream; and whether gzip
/// pays.
[[nodiscard]] net::ServedType served_type_of(std::string_view name);

/// Whether a file can be encoded as a QNV stream, as far as its name tells.
[[nodiscard]] bool can_be_encoded(std::string_view name);

/// The page of a folder for people (HTML, without scripts) or programs (JSON).
/// With `made`: with pictures of what opens as a world, and the streams that
/// can be asked for. Names are any bytes.
/// `request.query` may have fields of a form: search (part of a name) and sort (name, size or date, with a - before it
/// the other way round).
[[nodiscard]] net::FolderPage archive_index(const net::FolderListing& listing, const net::FolderRequest& request,
                                            bool made);
/// The link (see SceneLink) by which a click on a page opens a scene: of a name "x.wrl.gslink" to x.wrl, as the client
/// knows the folder. Nothing: it is no such name.
[[nodiscard]] std::optional<net::FolderPage> scene_link_page(const std::string& name, const net::FolderRequest& request,
                                                             bool made);

}  // namespace gs::app
