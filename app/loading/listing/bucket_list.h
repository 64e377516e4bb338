#pragma once

#include "base/budget.h"
#include "net/base/url.h"

#include <cstddef>
#include <span>
#include <string>
#include <variant>
#include <vector>

// Lists of buckets in the format of object stores: Amazon S3 ListObjects, versions 1 and 2
// (docs.aws.amazon.com/AmazonS3/latest/API/API_ListObjectsV2.html).
namespace gs::app {

/// Page of the list of a bucket.
struct BucketPage {
  std::string prefix;                // beginning of all keys
  std::vector<std::string> keys;     // of objects
  std::vector<std::string> folders;  // common prefixes of further keys, with a slash at their ends
  /// Parameter of the query for the next page, such as "continuation-token=abc". Empty if this is the last page.
  std::string next;
};

/// Returns true if the first bytes of a file are those of a page of a list.
[[nodiscard]] bool is_bucket_list(std::span<const std::byte> first);

/// Reads a page. Returns a message on failure. Leaves out keys that are longer than stores permit. Safe for untrusted
/// bytes; charges memory to `budget` while reading.
[[nodiscard]] std::variant<BucketPage, std::string> read_bucket_page(std::span<const std::byte> bytes,
                                                                     const WorldBudget& budget);

/// Folder in a bucket.
struct BucketPlace {
  net::Url bucket;     // URL of the bucket, with a slash at the end of its path, without a query
  std::string prefix;  // beginning of the keys in the folder; empty or, for folders, with a slash at its end
};

/// Returns the folders in buckets that a URL may mean: the first part of the path, or the host, names the bucket. `url`
/// is a folder with a slash at its end, or the common beginning of several objects. Returns an empty list for schemes
/// without buckets, and for URLs with a user, a password or a query.
[[nodiscard]] std::vector<BucketPlace> bucket_places(const net::Url& url);
/// Returns the folder that a received page lists. `url` is the URL of its request.
[[nodiscard]] BucketPlace place_of_list(const net::Url& url, const BucketPage& page);

/// Returns the URL of a page of the list. With `folders`, the list summarises keys below subfolders. `next` is
/// BucketPage::next of the previous page.
[[nodiscard]] net::Url list_url(const BucketPlace& place, bool folders, const std::string& next = {});
/// Returns the URL that has the page after the one at `url`.
[[nodiscard]] net::Url next_list_url(const net::Url& url, const std::string& next);

/// Returns the URL of an object.
[[nodiscard]] net::Url object_url(const net::Url& bucket, const std::string& key);

}  // namespace gs::app
