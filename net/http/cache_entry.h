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

/// What the cache knows of an answer besides its bytes.
struct CachedHead {
  std::string url;  // after redirects
  std::string content_type;
  Validator validator;
  std::optional<std::uint64_t> total;  // bytes of the whole resource
  bool accepts_ranges = false;
  bool encoded = false;        // what is stored was compressed on the way, so that the server's ranges do not fit it
  std::int64_t stored_at = 0;  // Unix seconds at which the server last confirmed it
  std::int64_t fresh_for = 0;  // seconds from then
  AddressSpace space = AddressSpace::global;  // of the host that sent it
};

/// Bytes of the data file that were written together, with their CRC-32 (zlib's).
struct CacheExtent {
  std::uint64_t begin = 0;
  std::uint32_t size = 0;
  std::uint32_t checksum = 0;

  [[nodiscard]] std::uint64_t end() const { return begin + size; }
};

/// The record of one cached resource. The data file of a version has a name of its own (`data`), so that a file once
/// named by a record is only ever added to.
struct CacheEntry {
  static constexpr std::uint32_t kLargestExtent = 64 << 10;  // what must be read to check one byte of it
  static constexpr std::size_t kMostExtents = 1 << 17;

  std::string key;
  std::uint64_t data = 0;
  CachedHead head;
  std::vector<CacheExtent> extents;  // sorted; no two overlap

  [[nodiscard]] RangeSet present() const;
  /// Adds one that overlaps none; others are left out. Joins it with its neighbour where that stays small. False when
  /// there are too many.
  bool add(CacheExtent extent);
};

[[nodiscard]] std::vector<std::byte> write_cache_entry(const CacheEntry& entry);
/// Nothing for what is damaged in any way. Safe for any bytes.
[[nodiscard]] std::optional<CacheEntry> read_cache_entry(std::span<const std::byte> bytes);

[[nodiscard]] std::uint32_t cache_checksum(std::span<const std::byte> bytes, std::uint32_t before = 0);

}  // namespace gs::net
