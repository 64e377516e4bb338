#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/noncopyable.h"
#include "net/base/descriptor.h"
#include "net/files/file.h"
#include "net/http/cache_entry.h"

namespace gs::net {

class HttpCache;

struct HttpCacheOptions {
  std::string folder;  // created if missing; must contain nothing else
  std::uint64_t max_bytes = std::uint64_t{2} << 30;
  std::size_t max_entries = 4096;  // maximum number of entries, with two files each
  std::uint64_t max_entry_bytes = 0;  // maximum bytes of an entry; 0 means a quarter of max_bytes
  std::function<std::uint64_t()> random;  // returns 64 random bits for file names
};

/// Cached version of a resource at the time of `find`. Remains readable if the cache changes.
class CachedResource {
 public:
  [[nodiscard]] const CachedHead& head() const { return entry_.head; }
  [[nodiscard]] const RangeSet& present() const { return present_; }
  /// Reports whether the cache has all bytes of the resource.
  [[nodiscard]] bool complete() const { return entry_.head.total && present_.contains({0, *entry_.head.total}); }
  [[nodiscard]] bool fresh(std::int64_t now) const {
    return now >= entry_.head.stored_at && now - entry_.head.stored_at < entry_.head.fresh_for;
  }
  /// Reads 1 to `most` bytes from `offset` on. Returns nullopt if the bytes are missing or damaged. The caller must
  /// then drop the entry.
  [[nodiscard]] std::optional<std::vector<std::byte>> read(std::uint64_t offset, std::size_t most) const;

 private:
  friend class HttpCache;
  CacheEntry entry_;
  RangeSet present_;
  Descriptor file_;
};

/// Writer of one version of a resource. Does nothing after its first failure.
class CacheWriter : NonCopyable {
 public:
  /// Discards bytes that were not committed.
  ~CacheWriter();

  /// Stores bytes at an offset. Ignores bytes that are stored already.
  void append(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Makes the appended bytes available to `find`. `total` is the size of the resource, if known. Discards an
  /// incomplete version that has no strong validator.
  void commit(std::optional<std::uint64_t> total, std::int64_t now);

 private:
  friend class HttpCache;
  CacheWriter(HttpCache& cache, CacheEntry entry, Descriptor file, bool own_file);
  HttpCache& cache_;
  CacheEntry entry_;  // entry to store; `extents` has only the appended bytes
  RangeSet present_;  // appended and earlier extents
  Descriptor file_;
  std::uint64_t written_ = 0;
  bool own_file_;  // created by this writer; no entry refers to the file yet
  bool failed_ = false;
};

/// Disk cache of server responses (RFC 9111, for one user). Limits bytes and files, and removes the least recently used
/// entries first. Several processes may share a folder: they replace entries by renaming, under a lock with a short
/// wait. Checksums reveal damage after crashes, and damaged entries are dropped. One thread per object.
class HttpCache {
 public:
  [[nodiscard]] static std::variant<std::unique_ptr<HttpCache>, FileError> open(HttpCacheOptions options,
                                                                                std::int64_t now);

  /// Finds a resource. `key` is the requested URL and everything else that selects the response. `now` is in Unix
  /// seconds here and in the other functions.
  [[nodiscard]] std::optional<CachedResource> find(const std::string& key, std::int64_t now);
  /// Returns a writer for the version that `head` describes. If the cache has a part of this version, the writer
  /// continues it. Otherwise its commit replaces the entry of the key. Returns null on disk errors. The cache must
  /// outlive the writer.
  [[nodiscard]] std::unique_ptr<CacheWriter> write(const std::string& key, const CachedHead& head);
  /// Extends the freshness of a version that the server has confirmed. The version is fresh for `fresh_for` seconds
  /// from `now`.
  void confirm(const std::string& key, const Validator& version, std::int64_t fresh_for, std::int64_t now);
  void drop(const std::string& key);

  /// Approximate use of the disk. Other processes' writes are included only after clean().
  struct Usage {
    std::uint64_t bytes = 0;
    std::size_t entries = 0;
  };
  [[nodiscard]] Usage usage() const { return usage_; }
  /// Counts files and bytes again. Removes remains of crashes, and entries above the limits.
  void clean(std::int64_t now);

 private:
  friend class CacheWriter;
  explicit HttpCache(HttpCacheOptions options) : options_(std::move(options)) {}
  [[nodiscard]] std::string entry_path(const std::string& key) const;
  [[nodiscard]] std::string data_path(const std::string& key, std::uint64_t data) const;
  [[nodiscard]] std::optional<CacheEntry> load(const std::string& key) const;
  [[nodiscard]] bool store(const CacheEntry& entry, std::int64_t now);
  [[nodiscard]] Descriptor lock() const;
  void commit(CacheWriter& writer, std::int64_t now);
  void touch(const std::string& path, std::int64_t now);

  HttpCacheOptions options_;
  Usage usage_;
  std::uint64_t written_since_clean_ = 0;
  std::size_t stored_since_clean_ = 0;
  std::uint32_t touches_ = 0;
};

}  // namespace gs::net
