#include "app/base/local_file.h"
#include "app/loading/fetch/fetcher.h"
#include "app/loading/fetch/loading.h"
#include "net/base/schemes.h"
#include "net/transfer/transport.h"

#include <utility>

// Functions that block until files are read, for importers and for views.
namespace gs::app {

ReadFile Fetcher::reader_of(const net::Origin& origin) {
  return [this, origin](const std::string& name) -> BytesResult {
    const net::Url url = net::resolve(net::parse_url(origin.url), net::parse_url(net::tidy_url(name)));
    const auto refused = policy_.refuse(origin, url);
    if (refused && !refused->folder.empty()) (void)loading_.results.refuse_folder(refused->folder, name);
    if (refused) return name + ": " + refused->message;
    if (url.scheme == "file") {
      LocalFile local_file = open_local_file(url, policy_, origin);
      if (!local_file.folder.empty()) (void)loading_.results.refuse_folder(local_file.folder, name);
      if (!local_file.file) return local_file.problem;
      return shared_bytes(std::move(*local_file.file));
    }
    if (url.scheme == "data") {
      auto decoded = net::decode_data_url(url.text());
      if (!decoded) return std::string("malformed data: URL");
      return shared_bytes(std::move(decoded->bytes));
    }
    if (loading_.options.offline) return name + ": " + std::string(kOfflineProblem);
    return network_.read_now(url, origin);
  };
}

ReadFiles Fetcher::files_of(const net::Origin& origin) {
  return files_by(origin,
                  [this, origin](std::span<const WantedPart> wanted) { return network_.read_all_now(wanted, origin); });
}

std::shared_ptr<ServedFiles> Fetcher::served_files() const {
  return std::make_shared<ServedFiles>(network_.loader_options(), loading_.budget);
}

ReadFiles Fetcher::files_for_views(const net::Origin& origin) {
  const std::shared_ptr<ServedFiles> served = ahead_ ? std::exchange(ahead_, nullptr) : served_files();
  return files_by(origin,
                  [served, origin](std::span<const WantedPart> wanted) { return served->read(wanted, origin); });
}

// Returns a function that reads resources of servers through `read` if the policy allows it. It does not refer to this
// object.
ReadWanted Fetcher::read_allowed(const net::Origin& origin, ReadWanted read) const {
  const auto cache = loading_.options.component.growing ? net::CacheUse::reload : net::Request{}.cache;
  return [read = std::move(read), origin, policy = policy_, offline = loading_.options.offline,
          cache](std::span<const WantedPart> parts) {
    std::vector<FileResult> results(parts.size());
    std::vector<WantedPart> wanted;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::string name = net::url_for_messages(parts[i].url.text());
      if (const auto refused = policy.refuse(origin, parts[i].url)) {
        results[i] = name + ": " + refused->message;
      } else if (offline) {
        results[i] = name + ": " + std::string(kOfflineProblem);
      } else {
        wanted.push_back(parts[i]);
        wanted.back().cache = cache;
        places.push_back(i);
      }
    }
    if (wanted.empty()) return results;
    std::vector<FileResult> received = read(wanted);
    for (std::size_t i = 0; i < places.size(); ++i) results[places[i]] = std::move(received[i]);
    return results;
  };
}

ListFolder Fetcher::lister_of(const net::Origin& origin, bool by_view) {
  if (bucket_places(net::resolve(net::parse_url(origin.url), net::parse_url("."))).empty()) return nullptr;
  ReadWanted read;
  if (by_view)
    read = [served = served_files(), origin](std::span<const WantedPart> wanted) {
      return served->read(wanted, origin);
    };
  else
    read = [this, origin](std::span<const WantedPart> wanted) { return network_.read_all_now(wanted, origin); };
  return [read = read_allowed(origin, std::move(read)), origin,
          budget = loading_.budget](const std::string& reference) -> std::optional<std::vector<std::string>> {
    net::Url folder = net::resolve(net::parse_url(origin.url), net::parse_url(reference));
    if (!folder.path.ends_with('/')) folder.path += '/';
    return names_in_bucket(folder, read, budget);
  };
}

ListedFolder Fetcher::listed_folder(const net::Url& url, BucketPage first, const net::Origin& origin) {
  const ReadWanted read = read_allowed(
      origin, [this, origin](std::span<const WantedPart> wanted) { return network_.read_all_now(wanted, origin); });
  return app::listed_folder(url, std::move(first), read, loading_.budget);
}

ReadFile Fetcher::reader_of_listed(std::shared_ptr<const ListedFolder> folder, const net::Origin& origin) {
  return app::reader_of_listed(std::move(folder),
                               read_allowed(origin, [this, origin](std::span<const WantedPart> wanted) {
                                 return network_.read_all_now(wanted, origin);
                               }));
}

// Returns a function that reads files through `read` if the policy allows it. It does not refer to this object.
ReadFiles Fetcher::files_by(const net::Origin& origin, ReadWanted read) const {
  const auto cache = loading_.options.component.growing ? net::CacheUse::reload : net::Request{}.cache;
  return [read = std::move(read), origin, policy = policy_, offline = loading_.options.offline,
          cache](std::span<const FileRequest> requests) {
    std::vector<FileResult> results(requests.size());
    std::vector<WantedPart> wanted;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < requests.size(); ++i) {
      const net::Url url = net::resolve(net::parse_url(origin.url), net::parse_url(requests[i].reference));
      if (url.scheme == "file") {
        results[i] = read_local_part(url, policy, origin, requests[i]);
      } else if (const auto refused = policy.refuse(origin, url)) {
        results[i] = requests[i].reference + ": " + refused->message;
      } else if (offline) {
        results[i] = requests[i].reference + ": " + std::string(kOfflineProblem);
      } else {
        wanted.push_back({url, requests[i].part, cache});
        places.push_back(i);
      }
    }
    if (wanted.empty()) return results;
    std::vector<FileResult> received = read(wanted);
    for (std::size_t i = 0; i < places.size(); ++i) results[places[i]] = std::move(received[i]);
    return results;
  };
}

}  // namespace gs::app
