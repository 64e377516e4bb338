#include "net/http/cache_entry.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include <zlib.h>

namespace gs::net {
namespace {

constexpr std::string_view kMark = "GSCACHE2";
constexpr std::size_t kExtentBytes = 16;
constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();

void put_number(std::vector<std::byte>& to, std::uint64_t value, unsigned bytes) {
  for (unsigned i = 0; i < bytes; ++i) to.push_back(static_cast<std::byte>(value >> (8 * i)));
}

void put_text(std::vector<std::byte>& to, std::string_view text) {
  put_number(to, text.size(), 4);
  for (const char c : text) to.push_back(static_cast<std::byte>(c));
}

/// Reads the bytes that the put_ functions wrote. Records whether any were missing.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}

  std::uint64_t number(unsigned bytes) {
    if (rest_.size() < bytes) {
      failed_ = true;
      return 0;
    }
    std::uint64_t value = 0;
    for (unsigned i = 0; i < bytes; ++i) value |= std::to_integer<std::uint64_t>(rest_[i]) << (8 * i);
    rest_ = rest_.subspan(bytes);
    return value;
  }
  std::string text() {
    const std::uint64_t size = number(4);
    if (failed_ || rest_.size() < size) {
      failed_ = true;
      return {};
    }
    std::string result(reinterpret_cast<const char*>(rest_.data()), static_cast<std::size_t>(size));
    rest_ = rest_.subspan(static_cast<std::size_t>(size));
    return result;
  }
  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }

 private:
  std::span<const std::byte> rest_;
  bool failed_ = false;
};

}  // namespace

std::uint32_t cache_checksum(std::span<const std::byte> bytes, std::uint32_t before) {
  uLong sum = before;
  constexpr std::size_t kMax = std::size_t{1} << 30;  // zlib takes lengths as unsigned int
  while (!bytes.empty()) {
    const auto part = bytes.first(std::min(kMax, bytes.size()));
    sum = ::crc32(sum, reinterpret_cast<const Bytef*>(part.data()), static_cast<uInt>(part.size()));
    bytes = bytes.subspan(part.size());
  }
  return static_cast<std::uint32_t>(sum);
}

RangeSet CacheEntry::present() const {
  RangeSet result;
  for (const CacheExtent& extent : extents) result.add({extent.begin, extent.end()});
  return result;
}

bool CacheEntry::add(CacheExtent extent) {
  if (extent.size == 0) return true;
  auto after = std::lower_bound(extents.begin(), extents.end(), extent.begin,
                                [](const CacheExtent& other, std::uint64_t begin) { return other.begin < begin; });
  if (after != extents.end() && after->begin < extent.end()) return true;
  if (after != extents.begin()) {
    CacheExtent& before = *(after - 1);
    if (before.end() > extent.begin) return true;
    if (before.end() == extent.begin && before.size <= kLargestExtent - std::min(extent.size, kLargestExtent)) {
      before.checksum = static_cast<std::uint32_t>(
          ::crc32_combine(before.checksum, extent.checksum, static_cast<z_off_t>(extent.size)));
      before.size += extent.size;
      return true;
    }
  }
  if (extents.size() >= kMaxExtents) return false;
  extents.insert(after, extent);
  return true;
}

std::vector<std::byte> write_cache_entry(const CacheEntry& entry) {
  std::vector<std::byte> result;
  result.reserve(256 + entry.extents.size() * kExtentBytes);
  for (const char c : kMark) result.push_back(static_cast<std::byte>(c));
  put_text(result, entry.key);
  put_number(result, entry.data, 8);
  put_text(result, entry.head.url);
  put_text(result, entry.head.content_type);
  put_text(result, entry.head.validator.etag);
  put_text(result, entry.head.validator.last_modified);
  put_number(result, entry.head.total.value_or(kUnknown), 8);
  put_number(result,
             (entry.head.validator.date_is_strong ? 1u : 0u) | (entry.head.accepts_ranges ? 2u : 0u) |
                 (entry.head.encoded ? 4u : 0u) | static_cast<unsigned>(entry.head.space) << 3,
             1);
  put_number(result, static_cast<std::uint64_t>(entry.head.stored_at), 8);
  put_number(result, static_cast<std::uint64_t>(entry.head.fresh_for), 8);
  put_number(result, entry.extents.size(), 4);
  for (const CacheExtent& extent : entry.extents) {
    put_number(result, extent.begin, 8);
    put_number(result, extent.size, 4);
    put_number(result, extent.checksum, 4);
  }
  put_number(result, cache_checksum(result), 4);
  return result;
}

std::optional<CacheEntry> read_cache_entry(std::span<const std::byte> bytes) {
  if (bytes.size() < kMark.size() + 4 ||
      !std::equal(kMark.begin(), kMark.end(), bytes.begin(), [](char c, std::byte b) { return std::byte(c) == b; }))
    return std::nullopt;
  if (Reader(bytes.last(4)).number(4) != cache_checksum(bytes.first(bytes.size() - 4))) return std::nullopt;
  Reader reader(bytes.subspan(kMark.size(), bytes.size() - kMark.size() - 4));
  CacheEntry entry;
  entry.key = reader.text();
  entry.data = reader.number(8);
  entry.head.url = reader.text();
  entry.head.content_type = reader.text();
  entry.head.validator.etag = reader.text();
  entry.head.validator.last_modified = reader.text();
  const std::uint64_t total = reader.number(8), flags = reader.number(1);
  if (total != kUnknown) entry.head.total = total;
  entry.head.validator.date_is_strong = flags & 1;
  entry.head.accepts_ranges = flags & 2;
  entry.head.encoded = flags & 4;
  entry.head.space = static_cast<AddressSpace>(flags >> 3 & 3);
  entry.head.stored_at = static_cast<std::int64_t>(reader.number(8));
  entry.head.fresh_for = static_cast<std::int64_t>(reader.number(8));
  const std::uint64_t count = reader.number(4);
  if (reader.failed() || count > CacheEntry::kMaxExtents || reader.left() != count * kExtentBytes) return std::nullopt;
  // Reject senseless values: the checksum proves no origin, so the values may be hostile.
  constexpr std::int64_t kSensible = std::int64_t{1} << 40;
  if (entry.head.stored_at < 0 || entry.head.stored_at > kSensible || entry.head.fresh_for < 0 ||
      entry.head.fresh_for > kSensible)
    return std::nullopt;
  std::uint64_t behind = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    CacheExtent extent;
    extent.begin = reader.number(8);
    extent.size = static_cast<std::uint32_t>(reader.number(4));
    extent.checksum = static_cast<std::uint32_t>(reader.number(4));
    const std::uint64_t bound = entry.head.total.value_or(std::uint64_t{1} << 62);
    if (extent.begin < behind || extent.size == 0 || extent.size > CacheEntry::kLargestExtent || extent.begin > bound ||
        extent.size > bound - extent.begin)
      return std::nullopt;
    behind = extent.end();
    entry.extents.push_back(extent);
  }
  return entry;
}

}  // namespace gs::net
