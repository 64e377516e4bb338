#pragma once

#include "app/base/read_files.h"
#include "app/loading/fetch/waker.h"
#include "base/budget.h"
#include "base/noncopyable.h"
#include "net/load/loader.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Part of a resource on a server, or all of it.
struct WantedPart {
  net::Url url;
  std::optional<FilePart> part;
  net::CacheUse cache = net::Request{}.cache;
};

/// Functions that read_resources() calls.
struct ReadingHooks {
  std::function<bool()> stopped;                      // returns true if it must end
  std::function<void(net::LoadEvent)> other{};        // takes events of other requests; may be null
  std::function<void()> wait;                         // waits for events of the loader
  std::function<void(std::uint64_t bytes)> received{};  // counts received bytes; may be null
};

/// Returns the bytes of several resources, which are requested at once. Blocks. Charges them to `budget`.
[[nodiscard]] std::vector<FileResult> read_resources(net::Loader& loader, std::span<const WantedPart> wanted,
                                                     const net::Origin& from, const WorldBudget& budget,
                                                     const ReadingHooks& hooks);

/// Returns the text of a URL without its fragment.
[[nodiscard]] std::string without_fragment(net::Url url);

/// Reader of files of servers for views, which read while the world is shown. It has a loader of its own. Any thread.
class ServedFiles : NonCopyable {
 public:
  ServedFiles(net::LoaderOptions settings, WorldBudget budget);
  ~ServedFiles();

  [[nodiscard]] std::vector<FileResult> read(std::span<const WantedPart> wanted, const net::Origin& from);

 private:
  const WorldBudget budget_;
  const std::shared_ptr<Waker> waker_ = std::make_shared<Waker>();
  std::mutex mutex_;  // one call of read() at a time
  net::LoaderOptions settings_;
  std::unique_ptr<net::Loader> loader_;  // created for the first resource
};

}  // namespace gs::app
