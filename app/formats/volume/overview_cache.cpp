#include "app/formats/volume/overview_cache.h"

#include "app/formats/volume/volume_common.h"
#include "net/files/file.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kOverviewMagic = "GSOVER01";
constexpr std::string_view kOverviewExtension = ".overview";
constexpr std::size_t kMostOverviewKey = 16'384;

/// Start of a file, before the key and the samples.
struct OverviewHead {
  std::array<char, 8> magic{};
  std::uint64_t key_bytes = 0, samples = 0;
  std::uint32_t checksum = 0, reserved = 0;  // CRC-32 of the samples
};

std::uint32_t checksum_of(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

void append_bytes(std::vector<std::byte>& to, const void* from, std::size_t size) {
  const auto* const bytes = static_cast<const std::byte*>(from);
  to.insert(to.end(), bytes, bytes + size);
}

}  // namespace

std::string OverviewCache::path_of(const std::string& key) const {
  // FNV-1a. The file has the whole key, so that equal hashes do no harm.
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : key) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  std::string name;
  for (int shift = 60; shift >= 0; shift -= 4) name += "0123456789abcdef"[hash >> shift & 15];
  return folder_ + '/' + name + std::string(kOverviewExtension);
}

std::optional<std::vector<float>> OverviewCache::find(const std::string& key) const {
  if (folder_.empty()) return std::nullopt;
  const std::string path = path_of(key);
  const auto opened = net::open_file(path);
  const auto* const file = std::get_if<net::RandomAccessFile>(&opened);
  if (!file) return std::nullopt;
  OverviewHead head;
  const auto head_bytes = std::as_writable_bytes(std::span(&head, 1));
  if (file->read(0, head_bytes) != head_bytes.size() ||
      std::string_view(head.magic.data(), head.magic.size()) != kOverviewMagic || head.key_bytes != key.size() ||
      head.samples > most_bytes_ / sizeof(float) ||
      file->size() != sizeof(head) + head.key_bytes + head.samples * sizeof(float))
    return std::nullopt;
  std::string known(key.size(), '\0');
  if (file->read(sizeof(head), std::as_writable_bytes(std::span(known))) != known.size() || known != key)
    return std::nullopt;
  std::vector<float> samples(static_cast<std::size_t>(head.samples));
  const auto bytes = std::as_writable_bytes(std::span(samples));
  if (file->read(sizeof(head) + key.size(), bytes) != bytes.size() || checksum_of(bytes) != head.checksum)
    return std::nullopt;
  std::error_code error;
  fs::last_write_time(path, fs::file_time_type::clock::now(), error);  // for remove_oldest()
  return samples;
}

void OverviewCache::keep(const std::string& key, std::span<const float> samples) const {
  if (folder_.empty() || key.size() > kMostOverviewKey || samples.size_bytes() > most_bytes_ / 4) return;
  std::error_code error;
  if (fs::create_directories(folder_, error)) fs::permissions(folder_, fs::perms::owner_all, error);
  if (error) return;
  OverviewHead head;
  std::copy(kOverviewMagic.begin(), kOverviewMagic.end(), head.magic.begin());
  head.key_bytes = key.size();
  head.samples = samples.size();
  head.checksum = checksum_of(std::as_bytes(samples));
  std::vector<std::byte> bytes;
  bytes.reserve(sizeof(head) + key.size() + samples.size_bytes());
  append_bytes(bytes, &head, sizeof(head));
  append_bytes(bytes, key.data(), key.size());
  append_bytes(bytes, samples.data(), samples.size_bytes());
  remove_oldest(bytes.size());
  (void)net::write_file_atomically(path_of(key), bytes);
}

void OverviewCache::remove_oldest(std::uint64_t coming) const {
  struct Known {
    fs::file_time_type time;
    fs::path path;
    std::uint64_t bytes = 0;
  };
  std::vector<Known> all;
  std::uint64_t bytes = coming;
  std::error_code error;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code of_file;
    if (entry->path().extension() != kOverviewExtension || !entry->is_regular_file(of_file)) continue;
    all.push_back({entry->last_write_time(of_file), entry->path(), entry->file_size(of_file)});
    if (of_file)
      all.pop_back();
    else
      bytes += all.back().bytes;
  }
  std::ranges::sort(all, {}, &Known::time);
  for (const Known& old : all) {
    if (bytes <= most_bytes_) break;
    if (fs::remove(old.path, error)) bytes -= old.bytes;
  }
}

std::string overview_folder(const std::string& http_cache) {
  if (http_cache.empty()) return {};
  return (fs::path(http_cache).parent_path() / "overviews").string();
}

std::optional<std::string> overview_key(const std::string& path, const VoxelComponent& component,
                                        const qnv::VolumeLayout& layout) {
  std::error_code error;
  if (!fs::is_regular_file(path, error) || !component.folder.empty()) return std::nullopt;
  const fs::path whole = fs::canonical(path, error);
  if (error) return std::nullopt;
  const std::uint64_t size = fs::file_size(whole, error);
  const auto time = fs::last_write_time(whole, error).time_since_epoch().count();
  // Shorter files are headers of volumes in other files, or quick to read.
  constexpr std::uint64_t kLeastFile = std::uint64_t{1} << 20;
  if (error || size < kLeastFile) return std::nullopt;
  std::string key = whole.string();
  const auto add = [&key](const auto& number) { key += '\n' + std::to_string(number); };
  add(size);
  add(time);
  key += '\n' + component.dataset;
  add(component.index);
  add(component.magnitude ? 1 : 0);
  add(component.channel ? static_cast<std::int64_t>(*component.channel) : -1);
  add(component.step ? static_cast<std::int64_t>(component.step->number) : -1);
  add(component.step && component.step->time ? *component.step->time : 0.0);
  for (const std::uint32_t n : layout.dimensions) add(n);
  add(static_cast<int>(layout.type));
  add(layout.slope);
  add(layout.intercept);
  return key;
}

}  // namespace gs::app
