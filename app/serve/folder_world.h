#pragma once

#include "net/serve/http_server.h"

namespace gs::app {

/// Returns a VRML97 world that shows a folder: a wall of pictures and names, each of which opens its file or folder.
/// Names may contain any bytes. If `made`, the pictures are made on demand, and files that can be encoded open as
/// streams.
[[nodiscard]] net::FolderPage folder_world(const net::FolderListing& listing, bool made);

}  // namespace gs::app
