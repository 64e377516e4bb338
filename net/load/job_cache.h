#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "net/http/http_cache.h"
#include "net/load/job_location.h"

namespace gs::net {

/// Version of the resource that a request delivers: from the cache or from the first response.
struct LoadVersion {
  Validator validator;
  std::optional<std::uint64_t> total;  // bytes of the resource; nullopt if unknown
  bool encoded = false, accepts_ranges = false;
  AddressSpace space = AddressSpace::global;

  [[nodiscard]] LoadHead head(const std::string& url, const std::string& content_type, bool cached) const {
    return {url, total, content_type, validator, accepts_ranges, cached, space};
  }
};

/// Cached bytes of one request, and the writer that stores its received bytes. Does nothing if the request must not use
/// the cache. One thread.
class JobCache {
 public:
  /// All arguments must outlive the object. A null `cache` disables caching.
  JobCache(HttpCache* cache, const std::function<std::int64_t()>& unix_seconds, const Request& request,
           const JobLocation& location)
      : cache_(cache), unix_seconds_(unix_seconds), request_(request), location_(location) {}

  /// Result of a search. The cached bytes need a confirmation by the server unless trusted() is true.
  struct Found {
    LoadVersion version;
    RangeSet missing;  // bytes that the cache lacks
    bool all = false;  // the cache has all needed bytes
  };
  /// Searches the current URL for the needed bytes. Returns nullopt if there is no usable entry. `needs_all` means that
  /// the whole resource is needed, in order.
  [[nodiscard]] std::optional<Found> look_up(const RangeSet& needed, bool needs_all);
  /// Drops the entry that look_up() found, and the unfinished writer.
  void close();
  /// Drops the entry that look_up() found.
  void forget_entry() { entry_.reset(); }
  /// Deletes the entry of the current URL from the disk.
  void drop();
  /// Prevents later searches for this request, or allows them again.
  void set_searching(bool searching) { searching_ = searching; }

  [[nodiscard]] bool has_entry() const { return entry_.has_value(); }
  [[nodiscard]] const CachedHead& head() const { return entry_->head(); }
  /// Reports whether the entry is fresh, or the server has confirmed it.
  [[nodiscard]] bool trusted() const { return entry_ && trusted_; }
  void confirm(const Validator& version, std::int64_t fresh_for);
  /// Returns the needed bytes that the entry has.
  [[nodiscard]] RangeSet held(const RangeSet& needed) const;
  /// Returns the needed bytes that the entry can deliver now: in each range of `needed`, those at its beginning. The
  /// bytes of a range are delivered in order.
  [[nodiscard]] RangeSet pending(const RangeSet& needed) const;
  [[nodiscard]] std::optional<std::vector<std::byte>> read(std::uint64_t offset, std::size_t most) const;

  /// Begins to store received bytes if the response permits this and nothing is stored yet.
  void open_writer(const ResponseHead& head, const LoadVersion& version);
  void append(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Ends the writing. `total` is the size of a complete resource.
  void commit(std::optional<std::uint64_t> total);

 private:
  [[nodiscard]] std::string key() const;
  [[nodiscard]] bool is_allowed() const;

  HttpCache* cache_;
  const std::function<std::int64_t()>& unix_seconds_;
  const Request& request_;
  const JobLocation& location_;
  std::optional<CachedResource> entry_;
  ByteRange part_;  // part of `entry_` that is delivered
  bool trusted_ = false, searching_ = true;
  std::unique_ptr<CacheWriter> writer_;
};

}  // namespace gs::net
