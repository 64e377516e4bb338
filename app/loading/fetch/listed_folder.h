#pragma once

#include "app/base/read_file.h"
#include "app/base/read_files.h"
#include "app/loading/fetch/read_resources.h"
#include "app/loading/listing/bucket_list.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// Function that reads resources of servers, several at a time. Returns one result per resource, in their order.
using ReadWanted = std::function<std::vector<FileResult>(std::span<const WantedPart> wanted)>;

/// Folder in a bucket, with the names of its files.
struct ListedFolder {
  net::Url bucket;
  std::string prefix;              // of all keys, up to the last slash
  std::vector<std::string> names;  // keys without the prefix; those of subfolders have slashes
  std::string trouble;             // reason why further names are missing; empty if there are none

  /// Returns the URL of a file in the folder.
  [[nodiscard]] net::Url url_of(const std::string& name) const { return object_url(bucket, prefix + name); }
};

/// Completes a list from its first page: reads the further pages one after the other. `url` is the URL of that page.
[[nodiscard]] ListedFolder listed_folder(const net::Url& url, BucketPage first, const ReadWanted& read,
                                         const WorldBudget& budget);

/// Returns the names of the files and subfolders in the folder `folder`. Its path ends with a slash. Tries the
/// places of bucket_places() at once. Returns nullopt if no server lists it.
[[nodiscard]] std::optional<std::vector<std::string>> names_in_bucket(const net::Url& folder, const ReadWanted& read,
                                                                      const WorldBudget& budget);

/// Returns a function that reads the files of a listed folder, and answers kFolderReference with their names. It reads
/// the files that follow in the list, too, because readers of scans read all of them. One thread.
[[nodiscard]] ReadFile reader_of_listed(std::shared_ptr<const ListedFolder> folder, ReadWanted read);

}  // namespace gs::app
