#include "app/formats/archive/zip_archive.h"

#include <minizip/unzip.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kNameOffset = 30, kMostName = 256, kMostPath = 4096;
constexpr std::uint64_t kMostFiles = 65536;  // that are looked at for a name

/// Position in the bytes of an archive, for minizip.
struct ZipCursor {
  std::span<const std::byte> bytes;
  std::uint64_t at = 0;
};

ZipCursor& cursor_of(voidpf stream) { return *static_cast<ZipCursor*>(stream); }

voidpf open_bytes(voidpf opaque, const void*, int) { return opaque; }
uLong read_bytes(voidpf, voidpf stream, void* to, uLong size) {
  ZipCursor& cursor = cursor_of(stream);
  const std::uint64_t left = cursor.bytes.size() - std::min<std::uint64_t>(cursor.at, cursor.bytes.size());
  const std::uint64_t given = std::min<std::uint64_t>(size, left);
  if (given > 0) std::memcpy(to, cursor.bytes.data() + cursor.at, static_cast<std::size_t>(given));
  cursor.at += given;
  return static_cast<uLong>(given);
}
uLong write_bytes(voidpf, voidpf, const void*, uLong) { return 0; }
ZPOS64_T tell_bytes(voidpf, voidpf stream) { return cursor_of(stream).at; }
long seek_bytes(voidpf, voidpf stream, ZPOS64_T offset, int origin) {
  ZipCursor& cursor = cursor_of(stream);
  const std::uint64_t from = origin == ZLIB_FILEFUNC_SEEK_CUR   ? cursor.at
                             : origin == ZLIB_FILEFUNC_SEEK_END ? cursor.bytes.size()
                                                                : 0;
  if (offset > cursor.bytes.size() || from + offset > cursor.bytes.size()) return -1;
  cursor.at = from + offset;
  return 0;
}
int close_bytes(voidpf, voidpf) { return 0; }
int error_of_bytes(voidpf, voidpf) { return 0; }

std::string_view without_folder(std::string_view name) {
  const std::size_t slash = name.find_last_of('/');
  return slash == std::string_view::npos ? name : name.substr(slash + 1);
}

/// Unpacks the current file of an archive.
std::variant<std::vector<std::byte>, std::string> unpacked_current(unzFile file, const std::string& name,
                                                                   const WorldBudget& budget) {
  if (unzOpenCurrentFile(file) != UNZ_OK) return name + " in the archive is damaged or encrypted";
  std::vector<std::byte> bytes;
  Share share(budget, Resource::files);
  constexpr std::size_t kPiece = std::size_t{256} << 10;
  int read = 0;
  while (true) {
    const std::size_t before = bytes.size();
    if (!share.grow(2 * kPiece)) {
      (void)unzCloseCurrentFile(file);
      return name + " in the archive needs " + budget->refusal(Resource::files);
    }
    bytes.resize(before + kPiece);
    read = unzReadCurrentFile(file, bytes.data() + before, static_cast<unsigned>(kPiece));
    bytes.resize(before + static_cast<std::size_t>(std::max(read, 0)));
    if (read <= 0) break;
  }
  const bool whole = unzCloseCurrentFile(file) == UNZ_OK && read == 0;
  if (!whole) return name + " in the archive is damaged";
  return bytes;
}

}  // namespace

bool is_zip(std::span<const std::byte> bytes) {
  constexpr std::array<std::byte, 4> kMark{std::byte{'P'}, std::byte{'K'}, std::byte{3}, std::byte{4}};
  return bytes.size() >= kMark.size() && std::equal(kMark.begin(), kMark.end(), bytes.begin());
}

std::string_view first_name_in_zip(std::span<const std::byte> bytes) {
  if (!is_zip(bytes) || bytes.size() < kNameOffset) return {};
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto length = std::to_integer<std::size_t>(bytes[26]) + 256 * std::to_integer<std::size_t>(bytes[27]);
  constexpr std::size_t kShown = 32;  // letters to look at if the archive does not state a length
  return text.substr(kNameOffset, length > 0 ? length : kShown);
}

struct ZipArchive::Opened {
  ZipCursor cursor;
  unzFile file = nullptr;
  std::map<std::string, unz64_file_pos, std::less<>> places;  // of all files, by path; empty until it is needed

  /// Fills `places`.
  void find_all() {
    if (!places.empty()) return;
    for (int status = unzGoToFirstFile(file); status == UNZ_OK && places.size() < kMostFiles;
         status = unzGoToNextFile(file)) {
      unz_file_info64 info{};
      std::array<char, kMostPath + 1> found{};
      unz64_file_pos place{};
      if (unzGetCurrentFileInfo64(file, &info, found.data(), kMostPath, nullptr, 0, nullptr, 0) != UNZ_OK) break;
      if (unzGetFilePos64(file, &place) == UNZ_OK) places.emplace(found.data(), place);
    }
  }

  Opened() = default;
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;
  ~Opened() {
    if (file) unzClose(file);
  }
};

std::variant<ZipArchive, std::string> ZipArchive::open(std::span<const std::byte> bytes) {
  auto opened = std::make_shared<Opened>();
  opened->cursor.bytes = bytes;
  zlib_filefunc64_def functions{open_bytes, read_bytes,  write_bytes,    tell_bytes,
                                seek_bytes, close_bytes, error_of_bytes, &opened->cursor};
  opened->file = unzOpen2_64("archive", &functions);
  if (!opened->file) return "the ZIP archive is damaged: its directory is missing";
  return ZipArchive(std::move(opened));
}

std::variant<std::vector<std::byte>, std::string> ZipArchive::read(const std::string& name,
                                                                   const WorldBudget& budget) const {
  const unzFile file = opened_->file;
  std::uint64_t seen = 0;
  for (int status = unzGoToFirstFile(file); status == UNZ_OK && seen < kMostFiles;
       status = unzGoToNextFile(file), ++seen) {
    unz_file_info64 info{};
    std::array<char, kMostName + 1> found{};
    if (unzGetCurrentFileInfo64(file, &info, found.data(), kMostName, nullptr, 0, nullptr, 0) != UNZ_OK) break;
    if (without_folder(found.data()) != name) continue;
    return unpacked_current(file, name, budget);
  }
  return name + " is missing in the archive";
}

std::vector<std::string> ZipArchive::paths() const {
  opened_->find_all();
  std::vector<std::string> paths;
  for (const auto& [path, place] : opened_->places) paths.push_back(path);
  return paths;
}

std::optional<std::variant<std::vector<std::byte>, std::string>> ZipArchive::read_path(
    const std::string& path, const WorldBudget& budget) const {
  opened_->find_all();
  const auto found = opened_->places.find(path);
  if (found == opened_->places.end()) return std::nullopt;
  unz64_file_pos place = found->second;
  if (unzGoToFilePos64(opened_->file, &place) != UNZ_OK) return path + " in the archive is damaged";
  return unpacked_current(opened_->file, path, budget);
}

}  // namespace gs::app
