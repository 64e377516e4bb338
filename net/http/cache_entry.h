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

/// Cached description of a response, without its bytes.
struct CachedHead {
  std::string url;  // after redirects
  std::string content_type;
  Validator validator;
  std::optional<std::uint64_t> total;  // bytes of the whole resource
  bool accepts_ranges = false;
  // The response was compressed in transit, so byte ranges of the server do not match the stored bytes.
  bool encoded = false;
  std::int64_t stored_at = 0;                 // Unix seconds of the server's last confirmation
  std::int64_t fresh_for = 0;                 // seconds after stored_at
  AddressSpace space = AddressSpace::global;  // of the host that sent it
};

/// Bytes of the data file that were written together, with their CRC-32 (as in zlib).
struct CacheExtent {
  std::uint64_t begin = 0;
  std::uint32_t size = 0;
  std::uint32_t checksum = 0;

  [[nodiscard]] std::uint64_t end() const { return begin + size; }
};

/// Record of one cached resource. Each version has its own data file (`data`), so a data file that a record names only
/// grows.
struct CacheEntry {
  static constexpr std::uint32_t kLargestExtent = 64 << 10;  // bytes to read in order to check one of them
  static constexpr std::size_t kMaxExtents = 1 << 17;

  std::string key;
  std::uint64_t data = 0;
  CachedHead head;
  std::vector<CacheExtent> extents;  // sorted, without overlaps

  [[nodiscard]] RangeSet present() const;
  /// Adds an extent. Ignores extents that overlap others. Joins it with its neighbour if the result is small enough.
  /// Returns false if there are too many.
  bool add(CacheExtent extent);
};

[[nodiscard]] std::vector<std::byte> write_cache_entry(const CacheEntry& entry);
/// Parses an entry. Returns nullopt for damaged data. Safe for untrusted bytes.
[[nodiscard]] std::optional<CacheEntry> read_cache_entry(std::span<const std::byte> bytes);

[[nodiscard]] std::uint32_t cache_checksum(std::span<const std::byte> bytes, std::uint32_t before = 0);

}  // namespace gs::net
