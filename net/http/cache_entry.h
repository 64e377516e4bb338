#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "net/base/range_set.h"
#include "net/http/http_headers.h"

namespace gs::net {

/// Cached head of a response.
struct CachedHead {
  std::string url;  // URL after redirects
  std::string content_type;
  Validator validator;
  std::optional<std::uint64_t> total;  // bytes of the complete resource
  bool accepts_ranges = false;
  // The response was compressed in transit, so byte ranges of the server do not apply to the stored bytes.
  bool encoded = false;
  std::int64_t stored_at = 0;  // time of the server's last confirmation, Unix seconds
  std::int64_t fresh_for = 0;  // freshness, seconds after stored_at
  AddressSpace space = AddressSpace::global;  // space of the host that sent the response
};

/// Extent of the data file that was written at once, with its CRC-32 (as in zlib).
struct CacheExtent {
  std::uint64_t begin = 0;
  std::uint32_t size = 0;
  std::uint32_t checksum = 0;

  [[nodiscard]] std::uint64_t end() const { return begin + size; }
};

/// Record of one cached resource. Each version has its own data file (`data`). While a record names a data file, the
/// file only grows.
struct CacheEntry {
  static constexpr std::uint32_t kLargestExtent = 64 << 10;  // maximum bytes, because reads check whole extents
  static constexpr std::size_t kMaxExtents = 1 << 17;

  std::string key;
  std::uint64_t data = 0;
  CachedHead head;
  std::vector<CacheExtent> extents;  // sorted, without overlap

  [[nodiscard]] RangeSet present() const;
  /// Adds an extent. Ignores an extent that overlaps others. Joins it with the previous extent if the result is small
  /// enough. Returns false if there are too many extents.
  bool add(CacheExtent extent);
};

[[nodiscard]] std::vector<std::byte> write_cache_entry(const CacheEntry& entry);
/// Parses an entry. Returns nullopt if the data is damaged. Safe for untrusted bytes.
[[nodiscard]] std::optional<CacheEntry> read_cache_entry(std::span<const std::byte> bytes);

[[nodiscard]] std::uint32_t cache_checksum(std::span<const std::byte> bytes, std::uint32_t before = 0);

}  // namespace gs::net
