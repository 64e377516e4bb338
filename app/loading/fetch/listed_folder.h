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
  std::string trouble;             // reason why further names are missing; empty if the list is complete

  /// Returns the URL of a file in the folder.
  [[nodiscard]] net::Url url_of(const std::string& name) const { return object_url(bucket, prefix + name); }
};

/// Reads the other pages of a list one after the other. `first` is the first page, and `url` the URL of that page.
[[nodiscard]] ListedFolder listed_folder(const net::Url& url, BucketPage first, const ReadWanted& read,
                                         const WorldBudget& budget);

/// Returns the names of the files and subfolders in `folder`. Its path must end with a slash. Requests the lists of all
/// bucket_places() at the same time. Returns nullopt if no server lists the folder.
[[nodiscard]] std::optional<std::vector<std::string>> names_in_bucket(const net::Url& folder, const ReadWanted& read,
                                                                      const WorldBudget& budget);

/// Returns a function that reads the files of a listed folder, and answers kFolderReference with their names. It also
/// reads ahead the next files of the list, because readers of scans need all files. One thread.
[[nodiscard]] ReadFile reader_of_listed(std::shared_ptr<const ListedFolder> folder, ReadWanted read);

}  // namespace gs::app
