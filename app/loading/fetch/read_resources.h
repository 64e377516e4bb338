#pragma once

#include "app/base/read_files.h"
#include "app/loading/fetch/waker.h"
#include "base/budget.h"
#include "base/noncopyable.h"
#include "net/load/loader.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Reason why a resource on a server is not read with LoadOptions::offline.
inline constexpr std::string_view kOfflineProblem =
    "the network is disabled; open the world without --offline to load it";

/// Part of a resource on a server, or all of it.
struct WantedPart {
  net::Url url;
  std::optional<FilePart> part;
  net::CacheUse cache = net::Request{}.cache;
  std::uint64_t max_bytes = net::Request{}.max_bytes;  // of the resource
};

/// Functions that read_resources() calls.
struct ReadingHooks {
  std::function<bool()> stopped;                                        // returns true if the reading must end
  std::function<void(net::LoadEvent)> other{};                          // takes events of other requests; may be null
  std::function<void()> wait;                                           // waits for events of the loader
  std::function<void(std::uint64_t bytes)> received{};                  // counts received bytes; may be null
  std::function<void(std::size_t index, const net::LoadHead&)> head{};  // takes the head of each resource; may be null
};

/// Returns the bytes of several resources, which are requested at once. Blocks. Charges them to `budget`.
[[nodiscard]] std::vector<FileResult> read_resources(net::Loader& loader, std::span<const WantedPart> wanted,
                                                     const net::Origin& from, const WorldBudget& budget,
                                                     const ReadingHooks& hooks);

/// Ranges to receive of one version of a resource on a server.
struct WantedRanges {
  net::Url url;
  net::Validator validator;
  std::uint64_t total = 0;  // bytes of this version
  std::vector<net::ByteRange> ranges;
  net::CacheUse cache = net::Request{}.cache;
};
/// Reason why ranges were not received.
struct RangesProblem {
  std::string message;
  bool changed = false;  // the server has another version now
};
/// Function that takes received bytes. Returns false to end the transfer.
using TakeBytes = std::function<bool(std::uint64_t offset, std::span<const std::byte> bytes)>;

/// Receives ranges of a resource, several at a time. Blocks. Returns the reason if some are missing.
[[nodiscard]] std::optional<RangesProblem> read_ranges(net::Loader& loader, const WantedRanges& wanted,
                                                       const net::Origin& from, const TakeBytes& take,
                                                       const ReadingHooks& hooks);

/// Returns the text of a URL without its fragment.
[[nodiscard]] std::string without_fragment(net::Url url);

/// Reader of files of servers for views, which read while the world is shown. It has a loader of its own. Any thread.
class ServedFiles : NonCopyable {
 public:
  ServedFiles(net::LoaderOptions settings, WorldBudget budget);
  ~ServedFiles();

  [[nodiscard]] std::vector<FileResult> read(std::span<const WantedPart> wanted, const net::Origin& from);
  [[nodiscard]] std::optional<RangesProblem> read_ranges(const WantedRanges& wanted, const net::Origin& from,
                                                         const TakeBytes& take);
  /// Resource that was read before its first use.
  struct Ahead {
    FileResult result;
    std::optional<net::LoadHead> head;
  };
  /// Reads resources at once, and keeps them. The next read() of each resource needs no request.
  void read_ahead(std::span<const net::Url> urls, const net::Origin& from);
  /// Returns a resource that was read ahead and not read since, or null.
  [[nodiscard]] const Ahead* find_ahead(const net::Url& url) const;

 private:
  /// Creates the loader at the first call. Returns the functions for a call of read().
  ReadingHooks prepare();

  const WorldBudget budget_;
  const std::shared_ptr<Waker> waker_ = std::make_shared<Waker>();
  std::mutex mutex_;  // one call of read() at a time
  net::LoaderOptions settings_;
  std::unique_ptr<net::Loader> loader_;  // created for the first resource
  std::map<std::string, Ahead> ahead_;   // by URL; one thread adds and finds
};

}  // namespace gs::app
