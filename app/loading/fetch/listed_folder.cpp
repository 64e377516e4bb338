#include "app/loading/fetch/listed_folder.h"

#include "base/text.h"
#include "net/base/reference_policy.h"

#include <algorithm>
#include <map>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMostNames = 100'000;
constexpr std::size_t kMostPages = 1000;
constexpr std::uint64_t kMostPageBytes = std::uint64_t{16} << 20;

WantedPart wanted_page(const net::Url& url) {
  WantedPart wanted{url, std::nullopt};
  wanted.max_bytes = kMostPageBytes;
  return wanted;
}

/// Calls `take` for `page` and each page after it. Returns the reason why further pages are missing; empty if the list
/// is complete.
template <class Take>
std::string for_pages(net::Url url, BucketPage page, const ReadWanted& read, const WorldBudget& budget, Take&& take) {
  for (std::size_t pages = 1;; ++pages) {
    const std::string next = std::exchange(page.next, {});
    if (!take(page)) return "only the first " + std::to_string(kMostNames) + " files are used";
    if (next.empty()) return {};
    if (pages >= kMostPages) return "the list has more than " + std::to_string(kMostPages) + " pages";
    net::Url after = next_list_url(url, next);
    if (after.query == url.query) return "the list has no end";
    url = std::move(after);
    const WantedPart wanted = wanted_page(url);
    std::vector<FileResult> results = read({&wanted, 1});
    const auto* const bytes = results.size() == 1 ? std::get_if<SharedBytes>(&results.front()) : nullptr;
    if (!bytes) {
      const auto* const problem = results.size() == 1 ? std::get_if<std::string>(&results.front()) : nullptr;
      return "a further page of the list cannot be read" + (problem ? ": " + *problem : std::string());
    }
    auto parsed = read_bucket_page(bytes->bytes, budget);
    if (const auto* const problem = std::get_if<std::string>(&parsed)) return "a further page of the list: " + *problem;
    page = std::get<BucketPage>(std::move(parsed));
  }
}

}  // namespace

ListedFolder listed_folder(const net::Url& url, BucketPage first, const ReadWanted& read, const WorldBudget& budget) {
  ListedFolder folder;
  const BucketPlace place = place_of_list(url, first);
  folder.bucket = place.bucket;
  folder.prefix = place.prefix.substr(0, place.prefix.rfind('/') + 1);  // empty if it has no slash
  folder.trouble = for_pages(url, std::move(first), read, budget, [&](const BucketPage& page) {
    for (const std::string& key : page.keys) {
      if (folder.names.size() >= kMostNames) return false;
      // Skips empty objects with a slash at their end, by which stores represent folders.
      if (key.size() > folder.prefix.size() && key.starts_with(folder.prefix) && !key.ends_with('/') &&
          key.find('\n') == std::string::npos)
        folder.names.push_back(key.substr(folder.prefix.size()));
    }
    return true;
  });
  std::ranges::sort(folder.names);
  folder.names.erase(std::unique(folder.names.begin(), folder.names.end()), folder.names.end());
  return folder;
}

std::optional<std::vector<std::string>> names_in_bucket(const net::Url& folder, const ReadWanted& read,
                                                        const WorldBudget& budget) {
  std::vector<WantedPart> wanted;
  std::vector<std::string> prefixes;
  for (const BucketPlace& place : bucket_places(folder)) {
    wanted.push_back(wanted_page(list_url(place, true)));
    prefixes.push_back(place.prefix);
  }
  if (wanted.empty()) return std::nullopt;
  const std::vector<FileResult> results = read(wanted);
  for (std::size_t i = 0; i < std::min(results.size(), wanted.size()); ++i) {
    const auto* const bytes = std::get_if<SharedBytes>(&results[i]);
    if (!bytes || !is_bucket_list(bytes->bytes)) continue;
    auto page = read_bucket_page(bytes->bytes, budget);
    auto* const first = std::get_if<BucketPage>(&page);
    if (!first || first->prefix != prefixes[i]) continue;
    std::vector<std::string> names;
    const auto add = [&](std::string_view key) {
      if (!key.starts_with(prefixes[i])) return;
      key.remove_prefix(prefixes[i].size());
      if (key.ends_with('/')) key.remove_suffix(1);
      if (!key.empty() && key.find('/') == std::string_view::npos) names.emplace_back(key);
    };
    (void)for_pages(wanted[i].url, std::move(*first), read, budget, [&](const BucketPage& one) {
      std::ranges::for_each(one.keys, add);
      std::ranges::for_each(one.folders, add);
      return names.size() < kMostNames;
    });
    if (names.empty()) continue;
    std::ranges::sort(names);
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
  }
  return std::nullopt;
}

ReadFile reader_of_listed(std::shared_ptr<const ListedFolder> folder, ReadWanted read) {
  struct Ahead {
    std::map<std::string, std::size_t> places;  // indices in the list, by reference
    std::map<std::string, FileResult> results;  // results of files that were read ahead
    std::vector<bool> read;                     // files of the list that were requested
  };
  const auto ahead = std::make_shared<Ahead>();
  ahead->read.resize(folder->names.size());
  for (std::size_t i = 0; i < folder->names.size(); ++i) ahead->places[net::reference_of_path(folder->names[i])] = i;
  return [folder = std::move(folder), read = std::move(read), ahead](const std::string& reference) -> BytesResult {
    if (reference == kFolderReference) {
      std::string names;
      for (const std::string& name : folder->names) names += name + '\n';
      return shared_bytes(copied_bytes(names));
    }
    const auto place = ahead->places.find(reference);
    if (place == ahead->places.end()) return reference + ": not in the list of the folder";
    auto known = ahead->results.find(reference);
    if (known == ahead->results.end()) {
      constexpr std::size_t kAtOnce = 16;
      std::vector<WantedPart> wanted;
      std::vector<std::string> references;
      for (std::size_t i = place->second; i < std::min(place->second + kAtOnce, folder->names.size()); ++i) {
        // Files that were read ahead or returned before are not requested again.
        if (i != place->second && ahead->read[i]) continue;
        ahead->read[i] = true;
        wanted.push_back({folder->url_of(folder->names[i]), std::nullopt});
        references.push_back(net::reference_of_path(folder->names[i]));
      }
      std::vector<FileResult> results = read(wanted);
      results.resize(wanted.size(), std::string("it was not read"));
      for (std::size_t i = 0; i < results.size(); ++i)
        ahead->results.insert_or_assign(references[i], std::move(results[i]));
      known = ahead->results.find(reference);
    }
    // Each result is returned once; callers keep the files that they need again.
    const FileResult result = std::move(known->second);
    ahead->results.erase(known);
    if (const auto* const bytes = std::get_if<SharedBytes>(&result)) return *bytes;
    const auto* const problem = std::get_if<std::string>(&result);
    return problem ? *problem : reference + ": " + std::get<NoFile>(result).why;
  };
}

}  // namespace gs::app
