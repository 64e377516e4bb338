#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "net/base/descriptor.h"
#include "net/files/file.h"
#include "net/http/cache_entry.h"

namespace gs::net {

class HttpCache;

struct HttpCacheOptions {
  std::string folder;  // made where missing; nothing else should live in it
  std::uint64_t max_bytes = std::uint64_t{2} << 30;
  std::size_t max_entries = 4096;         // two files each
  std::uint64_t max_entry_bytes = 0;      // 0: a quarter of max_bytes
  std::function<std::uint64_t()> random;  // 64 bits by chance, to name files
};

/// One version of a resource as it was in the cache when it was found. Stays readable whatever happens to the cache.
class CachedResource {
 public:
  [[nodiscard]] const CachedHead& head() const { return entry_.head; }
  [[nodiscard]] const RangeSet& present() const { return present_; }
  /// Whether all of it is there.
  [[nodiscard]] bool complete() const { return entry_.head.total && present_.contains({0, *entry_.head.total}); }
  [[nodiscard]] bool fresh(std::int64_t now) const {
    return now >= entry_.head.stored_at && now - entry_.head.stored_at < entry_.head.fresh_for;
  }
  /// Some bytes from `offset` on, at least one and at most `most`. Nothing when they are not there, or damaged: then
  /// the entry is to be dropped.
  [[nodiscard]] std::optional<std::vector<std::byte>> read(std::uint64_t offset, std::size_t most) const;

 private:
  friend class HttpCache;
  CacheEntry entry_;
  RangeSet present_;
  Descriptor file_;
};

/// Stores bytes of one version of a resource. Does nothing more after the first failure: a cache may forget.
class CacheWriter {
 public:
  CacheWriter(const CacheWriter&) = delete;
  CacheWriter& operator=(const CacheWriter&) = delete;
  /// What was not committed is lost.
  ~CacheWriter();

  /// Bytes that are stored already are left as they are.
  void append(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Makes what was appended findable. `total` where it has become known. A version that nothing identifies to the last
  /// byte is kept only when it is complete.
  void commit(std::optional<std::uint64_t> total, std::int64_t now);

 private:
  friend class HttpCache;
  CacheWriter(HttpCache& cache, CacheEntry entry, Descriptor file, bool own_file);
  HttpCache& cache_;
  CacheEntry entry_;  // its extents: those appended
  RangeSet present_;  // these, and those that were there before
  Descriptor file_;
  std::uint64_t written_ = 0;
  bool own_file_;  // no entry names it yet
  bool failed_ = false;
};

/// Answers of servers on disk: RFC 9111 for one user. Bounded in bytes and files, the least recently used goes first.
/// Several processes may share a folder: entries are replaced by renaming, and changed under a lock for which nobody
/// waits long. What a crash leaves behind is found by checksums and dropped. One thread an object.
class HttpCache {
 public:
  [[nodiscard]] static std::variant<std::unique_ptr<HttpCache>, FileError> open(HttpCacheOptions options,
                                                                                std::int64_t now);

  /// `key` is the URL asked for and whatever else the answer depends on. `now` in Unix seconds throughout.
  [[nodiscard]] std::optional<CachedResource> find(const std::string& key, std::int64_t now);
  /// For bytes of the version that `head` describes. Continues what is there of the same version, else replaces it on
  /// commit. Null when the disk does not play along. The cache must outlive it.
  [[nodiscard]] std::unique_ptr<CacheWriter> write(const std::string& key, const CachedHead& head);
  /// The server has confirmed the version: it is as fresh as `fresh_for` says from `now` on.
  void confirm(const std::string& key, const Validator& version, std::int64_t fresh_for, std::int64_t now);
  void drop(const std::string& key);

  /// About as much as is on disk; other processes' writing is seen late.
  struct Usage {
    std::uint64_t bytes = 0;
    std::size_t entries = 0;
  };
  [[nodiscard]] Usage usage() const { return usage_; }
  /// Counts anew, removes what crashes left behind, and what is too much.
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
