#pragma once

#include "net/serve/served_folder.h"

#include <span>
#include <vector>

namespace gs::app {

/// Row of a folder's page: an entry, with the data files that belong to it.
struct IndexRow {
  net::FolderEntry entry;  // its size includes the data files
  std::vector<net::FolderEntry> data;
};

/// Joins each header to its data files, such as a.nhdr to a.raw and a.gltf to a.bin. Names decide: a data file begins
/// with the header's name without extension. Keeps the order of the entries.
[[nodiscard]] std::vector<IndexRow> index_rows(std::span<const net::FolderEntry> entries);

}  // namespace gs::app
