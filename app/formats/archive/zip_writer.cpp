#include "app/formats/archive/zip_writer.h"

#include "app/formats/common/byte_order.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

namespace gs::app {
namespace {

constexpr std::uint32_t kZipLocalHeader = 0x04034b50, kZipDirectoryHeader = 0x02014b50, kZipDirectoryEnd = 0x06054b50;
constexpr std::uint16_t kZipVersion = 10;
constexpr std::uint16_t kZipFirstDay = 1 << 5 | 1;  // 1980-01-01

std::uint32_t zip_checksum(std::span<const std::byte> bytes) {
  uLong sum = crc32(0, nullptr, 0);
  while (!bytes.empty()) {
    const std::size_t count = std::min<std::size_t>(bytes.size(), std::numeric_limits<uInt>::max());
    sum = crc32(sum, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(count));
    bytes = bytes.subspan(count);
  }
  return static_cast<std::uint32_t>(sum);
}

void put_zip_bytes(std::vector<std::byte>& to, std::span<const std::byte> bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

}  // namespace

void ZipWriter::add(const std::string& name, std::span<const std::byte> bytes) {
  const std::uint32_t sum = zip_checksum(bytes), size = static_cast<std::uint32_t>(bytes.size()),
                      offset = static_cast<std::uint32_t>(archive_.size());
  const auto put_facts = [&](std::vector<std::byte>& to) {
    put_little(to, kZipVersion);
    for (const std::uint16_t field : {0, 0, 0}) put_little(to, field);  // flags, method, time
    put_little(to, kZipFirstDay);
    for (const std::uint32_t field : {sum, size, size}) put_little(to, field);
    put_little(to, static_cast<std::uint16_t>(name.size()));
    put_little(to, std::uint16_t{0});
  };
  put_little(archive_, kZipLocalHeader);
  put_facts(archive_);
  put_zip_bytes(archive_, std::as_bytes(std::span(name)));
  put_zip_bytes(archive_, bytes);
  put_little(directory_, kZipDirectoryHeader);
  put_little(directory_, kZipVersion);
  put_facts(directory_);
  for (int i = 0; i < 3; ++i) put_little(directory_, std::uint16_t{0});  // comment, disk, internal attributes
  put_little(directory_, std::uint32_t{0});
  put_little(directory_, offset);
  put_zip_bytes(directory_, std::as_bytes(std::span(name)));
  ++files_;
}

std::vector<std::byte> ZipWriter::take() {
  const auto start = static_cast<std::uint32_t>(archive_.size());
  put_zip_bytes(archive_, directory_);
  put_little(archive_, kZipDirectoryEnd);
  put_little(archive_, std::uint32_t{0});
  for (int i = 0; i < 2; ++i) put_little(archive_, static_cast<std::uint16_t>(files_));
  put_little(archive_, static_cast<std::uint32_t>(directory_.size()));
  put_little(archive_, start);
  put_little(archive_, std::uint16_t{0});
  return std::move(archive_);
}

}  // namespace gs::app
