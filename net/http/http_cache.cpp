#include "net/http/http_cache.h"

#include "base/text.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gs::net {
namespace {

constexpr std::size_t kLargestEntryFile = std::size_t{4} << 20;

std::string hexadecimal(std::uint64_t value) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string result(16, '0');
  for (std::size_t i = 16; i-- > 0; value >>= 4) result[i] = kDigits[value & 15];
  return result;
}

/// Computes a hash of a text. If two keys have equal hashes, their entries replace each other. Each entry
/// holds its whole key, so no wrong entry is used.
std::uint64_t hash(std::string_view text, std::uint64_t seed) {
  std::uint64_t value = stable_hash(text, seed);
  value ^= value >> 32;
  return value * 0x9e3779b97f4a7c15;
}

std::string entry_name_of(const std::string& key) {
  return hexadecimal(hash(key, 0)) + hexadecimal(hash(key, 0x5bd1e995));
}

/// Calls pread or pwrite until all bytes are transferred.
template <class Bytes, class Transfer>
bool transfer_exactly(int file, Bytes bytes, std::uint64_t offset, Transfer transfer) {
  while (!bytes.empty()) {
    const ssize_t done = transfer(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(done));
    offset += static_cast<std::uint64_t>(done);
  }
  return true;
}
bool read_exactly(int file, std::span<std::byte> to, std::uint64_t offset) {
  return transfer_exactly(file, to, offset, ::pread);
}
bool write_exactly(int file, std::span<const std::byte> bytes, std::uint64_t offset) {
  return transfer_exactly(file, bytes, offset, ::pwrite);
}

}  // namespace

std::optional<std::vector<std::byte>> CachedResource::read(std::uint64_t offset, std::size_t most) const {
  auto found = std::upper_bound(entry_.extents.begin(), entry_.extents.end(), offset,
                                [](std::uint64_t at, const CacheExtent& extent) { return at < extent.begin; });
  if (found == entry_.extents.begin() || most == 0) return std::nullopt;
  --found;
  if (offset >= found->end()) return std::nullopt;
  std::vector<std::byte> bytes(found->size);
  if (!read_exactly(file_.get(), bytes, found->begin) || cache_checksum(bytes) != found->checksum) return std::nullopt;
  const auto skip = static_cast<std::ptrdiff_t>(offset - found->begin);
  bytes.erase(bytes.begin(), bytes.begin() + skip);
  if (bytes.size() > most) bytes.resize(most);
  return bytes;
}

CacheWriter::CacheWriter(HttpCache& cache, CacheEntry entry, Descriptor file, bool own_file)
    : cache_(cache), entry_(std::move(entry)), file_(std::move(file)), own_file_(own_file) {}

CacheWriter::~CacheWriter() {
  if (own_file_) ::unlink(cache_.data_path(entry_.key, entry_.data).c_str());
}

void CacheWriter::append(std::uint64_t offset, std::span<const std::byte> bytes) {
  const RangeSet asked(std::array{ByteRange{offset, offset + bytes.size()}});
  const RangeSet missing = asked.without(present_);
  for (const ByteRange& range : missing.ranges()) {
    auto part = bytes.subspan(static_cast<std::size_t>(range.begin - offset), static_cast<std::size_t>(range.size()));
    if (failed_ || written_ + part.size() > cache_.options_.max_entry_bytes) return;
    if (!write_exactly(file_.get(), part, range.begin)) {
      failed_ = true;
      return;
    }
    written_ += part.size();
    for (std::uint64_t at = range.begin; !part.empty();) {
      const auto piece = part.first(std::min<std::size_t>(part.size(), CacheEntry::kLargestExtent));
      if (!entry_.add({at, static_cast<std::uint32_t>(piece.size()), cache_checksum(piece)})) return;
      present_.add({at, at + piece.size()});
      at += piece.size();
      part = part.subspan(piece.size());
    }
  }
}

void CacheWriter::commit(std::optional<std::uint64_t> total, std::int64_t now) {
  if (total) entry_.head.total = total;
  const bool complete = entry_.head.total && present_.contains({0, *entry_.head.total});
  const bool continuable = !entry_.head.encoded && !entry_.head.validator.strong().empty();
  if (failed_ || (!complete && (!continuable || entry_.extents.empty()))) return;
  cache_.commit(*this, now);
}

std::variant<std::unique_ptr<HttpCache>, FileError> HttpCache::open(HttpCacheOptions options, std::int64_t now) {
  namespace fs = std::filesystem;
  if (options.max_entry_bytes == 0) options.max_entry_bytes = options.max_bytes / 4;
  std::error_code error;
  fs::create_directories(options.folder, error);
  if (!error) fs::permissions(options.folder, fs::perms::owner_all, error);
  if (error) return FileError{"cannot use " + options.folder + " as cache: " + error.message()};
  if (::access(options.folder.c_str(), R_OK | W_OK | X_OK) != 0)
    return FileError{"cannot use " + options.folder + " as cache: " + std::generic_category().message(errno)};
  std::unique_ptr<HttpCache> cache(new HttpCache(std::move(options)));
  cache->clean(now);
  return cache;
}

std::string HttpCache::entry_path(const std::string& key) const {
  return options_.folder + "/" + entry_name_of(key) + ".entry";
}

std::string HttpCache::data_path(const std::string& key, std::uint64_t data) const {
  return options_.folder + "/" + entry_name_of(key) + "-" + hexadecimal(data) + ".data";
}

Descriptor HttpCache::lock() const {
  const std::string path = options_.folder + "/lock";
  Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  constexpr int kTries = 20;
  for (int i = 0; file && i < kTries; ++i) {
    if (::flock(file.get(), LOCK_EX | LOCK_NB) == 0) return file;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return {};
}

void HttpCache::touch(const std::string& path, std::int64_t now) {
  // The nanoseconds record the order of uses within one second.
  const timespec time{static_cast<time_t>(now), static_cast<long>(touches_++ % 1'000'000'000)};
  const timespec times[2] = {time, time};
  (void)::utimensat(AT_FDCWD, path.c_str(), times, AT_SYMLINK_NOFOLLOW);
}

std::optional<CacheEntry> HttpCache::load(const std::string& key) const {
  const Descriptor file(::open(entry_path(key).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct stat status {};
  if (!file || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode) || status.st_size <= 0 ||
      static_cast<std::size_t>(status.st_size) > kLargestEntryFile)
    return std::nullopt;
  std::vector<std::byte> bytes(static_cast<std::size_t>(status.st_size));
  if (!read_exactly(file.get(), bytes, 0)) return std::nullopt;
  auto entry = read_cache_entry(bytes);
  if (!entry || entry->key != key) return std::nullopt;
  return entry;
}

bool HttpCache::store(const CacheEntry& entry, std::int64_t now) {
  const std::string path = entry_path(entry.key);
  const std::string temporary = path + ".tmp-" + hexadecimal(options_.random());
  const std::vector<std::byte> bytes = write_cache_entry(entry);
  if (bytes.size() > kLargestEntryFile) return false;
  Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!file) return false;
  // The file is not synced. After a power failure, checksums reveal damage.
  if (!write_exactly(file.get(), bytes, 0) || ::rename(temporary.c_str(), path.c_str()) != 0) {
    ::unlink(temporary.c_str());
    return false;
  }
  touch(path, now);
  return true;
}

std::optional<CachedResource> HttpCache::find(const std::string& key, std::int64_t now) {
  auto entry = load(key);
  if (!entry) return std::nullopt;
  CachedResource result;
  result.file_ =
      Descriptor(::open(data_path(key, entry->data).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (!result.file_) {
    // The data file is missing, so drop the entry. If another process has just replaced the entry, this only loses a
    // newer entry.
    drop(key);
    return std::nullopt;
  }
  result.present_ = entry->present();
  result.entry_ = std::move(*entry);
  touch(entry_path(key), now);
  return result;
}

std::unique_ptr<CacheWriter> HttpCache::write(const std::string& key, const CachedHead& head) {
  CacheEntry entry;
  entry.key = key;
  entry.head = head;
  if (const auto found = load(key);
      found && !head.encoded && !found->head.encoded && !head.validator.strong().empty() &&
      head.validator.strong() == found->head.validator.strong() && head.total == found->head.total) {
    Descriptor file(::open(data_path(key, found->data).c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
    if (file) {
      entry.data = found->data;
      std::unique_ptr<CacheWriter> writer(new CacheWriter(*this, std::move(entry), std::move(file), false));
      writer->present_ = found->present();
      return writer;
    }
  }
  entry.data = options_.random();
  Descriptor file(::open(data_path(key, entry.data).c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!file) return nullptr;
  return std::unique_ptr<CacheWriter>(new CacheWriter(*this, std::move(entry), std::move(file), true));
}

void HttpCache::commit(CacheWriter& writer, std::int64_t now) {
  CacheEntry& entry = writer.entry_;
  {
    const Descriptor locked = lock();
    if (!locked) return;
    auto current = load(entry.key);
    const bool same_file = current && current->data == entry.data;
    // This writer continued an older version, which another process has replaced.
    if (!same_file && !writer.own_file_) return;
    if (same_file) {
      CacheEntry merged = *current;
      for (const CacheExtent& extent : entry.extents)
        if (!merged.add(extent)) return;
      entry.extents = std::move(merged.extents);
    } else if (current && !entry.head.encoded && !current->head.encoded && !entry.head.validator.strong().empty() &&
               entry.head.validator.strong() == current->head.validator.strong() &&
               current->present().size() > writer.present_.size()) {
      return;  // another process has stored more bytes of this version
    }
    if (!store(entry, now)) return;
    if (current && !same_file) ::unlink(data_path(entry.key, current->data).c_str());
    if (!current) ++usage_.entries;
    writer.own_file_ = false;
  }
  usage_.bytes += writer.written_;
  written_since_clean_ += writer.written_;
  writer.written_ = 0;
  ++stored_since_clean_;
  if (usage_.bytes > options_.max_bytes || usage_.entries > options_.max_entries ||
      written_since_clean_ > options_.max_bytes / 8 || stored_since_clean_ > options_.max_entries / 8 + 1)
    clean(now);
}

void HttpCache::confirm(const std::string& key, const Validator& version, std::int64_t fresh_for, std::int64_t now) {
  const Descriptor locked = lock();
  if (!locked) return;
  auto entry = load(key);
  if (!entry || !entry->head.validator.agrees(version)) return;
  entry->head.stored_at = now;
  entry->head.fresh_for = fresh_for;
  (void)store(*entry, now);
}

void HttpCache::drop(const std::string& key) {
  const Descriptor locked = lock();
  if (!locked) return;
  if (const auto entry = load(key)) ::unlink(data_path(key, entry->data).c_str());
  ::unlink(entry_path(key).c_str());
}

}  // namespace gs::net
