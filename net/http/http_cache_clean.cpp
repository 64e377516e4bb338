#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "net/http/http_cache.h"

namespace gs::net {
namespace {

namespace fs = std::filesystem;

/// Age in seconds up to which a file without an entry is kept, because a process may still write it.
constexpr std::int64_t kWritingSeconds = 3600;

struct Found {
  std::string entry;  // path of the entry; empty if no entry exists
  timespec used{};
  std::vector<std::string> data;  // paths of the data files
  std::uint64_t bytes = 0;
  std::int64_t newest = 0;
};

/// Returns the files of the folder, grouped by the hash in their names. Removes old temporary files.
std::map<std::string, Found> scan(const std::string& folder, std::int64_t now) {
  constexpr std::size_t kHash = 32;
  std::map<std::string, Found> result;
  std::error_code error;
  for (fs::directory_iterator place(folder, error), end; !error && place != end; place.increment(error)) {
    const std::string path = place->path().string(), name = place->path().filename().string();
    struct stat status {};
    if (name.size() <= kHash || ::lstat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    if (name.find(".tmp-") != std::string::npos) {
      if (now - status.st_mtim.tv_sec > kWritingSeconds) ::unlink(path.c_str());
      continue;
    }
    Found& found = result[name.substr(0, kHash)];
    found.bytes += static_cast<std::uint64_t>(status.st_blocks) * 512;
    if (name.ends_with(".entry")) {
      found.entry = path;
      found.used = status.st_mtim;
    } else if (name.ends_with(".data")) {
      found.data.push_back(path);
      found.newest = std::max<std::int64_t>(found.newest, status.st_mtim.tv_sec);
    }
  }
  return result;
}

void remove(const Found& found) {
  if (!found.entry.empty()) ::unlink(found.entry.c_str());
  for (const std::string& path : found.data) ::unlink(path.c_str());
}

/// Returns the name of the data file of an entry. Returns an empty string if the entry cannot be read.
std::string named_by(const std::string& entry_path) {
  auto mapped = map_file(entry_path);
  if (!std::holds_alternative<MappedFile>(mapped)) return {};
  const auto entry = read_cache_entry(std::get<MappedFile>(mapped).bytes());
  if (!entry) return {};
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string name(16, '0');
  std::uint64_t value = entry->data;
  for (std::size_t i = 16; i-- > 0; value >>= 4) name[i] = kDigits[value & 15];
  return "-" + name + ".data";
}

}  // namespace

void HttpCache::clean(std::int64_t now) {
  const Descriptor locked = lock();
  if (!locked) return;
  written_since_clean_ = 0;
  stored_since_clean_ = 0;
  std::vector<Found> entries;
  for (auto& [hash, found] : scan(options_.folder, now)) {
    if (found.entry.empty()) {
      if (now - found.newest > kWritingSeconds) remove(found);
      continue;
    }
    if (found.data.size() > 1) {
      const std::string named = named_by(found.entry);
      for (const std::string& path : found.data) {
        struct stat status {};
        if (!named.empty() && path.ends_with(named)) continue;
        if (::lstat(path.c_str(), &status) == 0 && now - status.st_mtim.tv_sec > kWritingSeconds)
          ::unlink(path.c_str());
      }
    }
    entries.push_back(std::move(found));
  }
  std::sort(entries.begin(), entries.end(), [](const Found& a, const Found& b) {
    return a.used.tv_sec != b.used.tv_sec ? a.used.tv_sec < b.used.tv_sec : a.used.tv_nsec < b.used.tv_nsec;
  });
  usage_ = {0, entries.size()};
  for (const Found& found : entries) usage_.bytes += found.bytes;
  if (usage_.bytes <= options_.max_bytes && usage_.entries <= options_.max_entries) return;
  // Remove more than required, so that cleaning is rare.
  const std::uint64_t enough_bytes = options_.max_bytes - options_.max_bytes / 10;
  const std::size_t enough_entries = options_.max_entries - options_.max_entries / 10;
  for (const Found& found : entries) {
    if (usage_.bytes <= enough_bytes && usage_.entries <= enough_entries) break;
    remove(found);
    usage_.bytes -= found.bytes;
    --usage_.entries;
  }
}

}  // namespace gs::net
