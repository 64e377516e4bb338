#include "net/files/part_files.h"

#include "base/bytes.h"
#include "net/files/file.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <functional>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

namespace gs::net {
namespace {

// A list has records. Each record has a mark, length of the name, begin and end of the bytes, checksum of the bytes,
// length of the result, name, result, and checksum of the record.
constexpr std::uint32_t kWorkMark = 0x4b575347;
constexpr std::size_t kWorkHead = 32;
constexpr std::size_t kMostKey = std::size_t{64} << 20;  // a key has a line per input file
constexpr std::size_t kMostWorkName = 256;
constexpr std::size_t kMostWorkResult = std::size_t{1} << 30;
constexpr std::string_view kDataEnding = ".data", kListEnding = ".done", kKeyFile = "key", kStreamFile = "stream",
                           kEndedFile = "stream.ended", kNewKeyFile = ".ghostspace-key";

std::uint32_t sum_of(std::uint32_t from, std::span<const std::byte> bytes) {
  if (bytes.empty()) return from;
  return static_cast<std::uint32_t>(crc32_z(from, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::string part_reason() { return std::generic_category().message(errno); }

bool read_at(int file, std::uint64_t offset, std::span<std::byte> to) {
  while (!to.empty()) {
    const ssize_t got = ::pread(file, to.data(), to.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    offset += static_cast<std::uint64_t>(got);
    to = to.subspan(static_cast<std::size_t>(got));
  }
  return true;
}

// Returns the number in the name of a part file. Returns nullopt for other names.
std::optional<std::uint32_t> part_number(const std::string& name) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  const std::string_view ending(end, static_cast<std::size_t>(name.data() + name.size() - end));
  const bool good = error == std::errc() && number < PartFiles::kMostParts && name.front() != '0' &&
                    (ending == kDataEnding || ending == kListEnding);
  return good ? std::optional(number) : std::nullopt;
}

// Calls visit(path, name) for each entry of a folder.
template <class Visit>
void each_entry(const std::string& folder, const Visit& visit) {
  std::error_code error;
  std::vector<std::filesystem::path> paths;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    paths.push_back(it->path());
  for (const std::filesystem::path& path : paths) visit(path.string(), path.filename().string());
}

std::optional<std::string> key_of(const std::string& folder) {
  const Descriptor file(::open((folder + "/" + std::string(kKeyFile)).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  struct stat status {};
  if (!file || ::fstat(file.get(), &status) != 0 || status.st_size > static_cast<off_t>(kMostKey)) return std::nullopt;
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  return read_at(file.get(), 0, std::as_writable_bytes(std::span(text))) ? std::optional(text) : std::nullopt;
}

}  // namespace

void remove_part_folder(const std::string& folder) {
  if (!key_of(folder)) return;
  each_entry(folder, [&](const std::string& path, const std::string& name) {
    if (part_number(name) || name == kStreamFile || name == kEndedFile) ::unlink(path.c_str());
  });
  ::unlink((folder + "/" + std::string(kKeyFile)).c_str());
  ::rmdir(folder.c_str());
}

std::optional<FileError> prepare_part_folder(const std::string& folder, const std::string& key, bool resume) {
  if (const auto found = resume ? key_of(folder) : std::nullopt) {
    if (*found == key) return std::nullopt;
    return FileError{folder + " belongs to another input or other options; use those, or omit --resume"};
  }
  remove_part_folder(folder);
  // The key gets its name when it is complete. A run that ended before this leaves a folder without a key.
  const std::string path = folder + "/" + std::string(kKeyFile), fresh = folder + "/" + std::string(kNewKeyFile);
  ::unlink(fresh.c_str());
  ::rmdir(folder.c_str());
  if (::mkdir(folder.c_str(), 0777) != 0) return FileError{"cannot create the folder " + folder + ": " + part_reason()};
  const Descriptor file(::open(fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file || !write_all(file.get(), std::as_bytes(std::span(key))) || ::rename(fresh.c_str(), path.c_str()) != 0)
    return FileError{"cannot write into the folder " + folder + ": " + part_reason()};
  return std::nullopt;
}

std::string part_stream(const std::string& folder) { return folder + "/" + std::string(kStreamFile); }

std::string part_end_mark(const std::string& stream) {
  return stream.substr(0, stream.size() - kStreamFile.size()) + std::string(kEndedFile);
}

std::optional<FileError> publish_part_stream(const std::string& folder, const std::string& path) {
  const std::string stream = part_stream(folder);
  const Descriptor file(::open(stream.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!file || ::fsync(file.get()) != 0 || ::rename(stream.c_str(), path.c_str()) != 0)
    return FileError{"cannot write " + path + ": " + part_reason()};
  remove_part_folder(folder);
  return std::nullopt;
}

std::uint32_t free_part_number(const std::string& folder) {
  std::uint32_t free = 1;
  each_entry(folder, [&](const std::string&, const std::string& name) {
    if (const auto number = part_number(name)) free = std::max(free, *number + 1);
  });
  return free;
}

std::variant<PartFiles, FileError> PartFiles::create(const std::string& folder, std::uint32_t number) {
  PartFiles made;
  made.folder_ = folder;
  made.number_ = number;
  made.readers_ = std::make_unique<Readers>();
  if (number == 0 || number >= kMostParts) return FileError{"there are too many part files in " + folder};
  each_entry(folder, [&](const std::string&, const std::string& name) {
    const auto other = part_number(name);
    if (other && name.ends_with(kListEnding)) made.read_list(*other);
  });
  for (const auto& [ending, file] : {std::pair(kDataEnding, &made.data_), std::pair(kListEnding, &made.list_)}) {
    *file = Descriptor(::open(made.path_of(number, ending).c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (!*file) return FileError{"cannot create " + made.path_of(number, ending) + ": " + part_reason()};
  }
  return made;
}

std::string PartFiles::path_of(std::uint32_t number, std::string_view ending) const {
  return folder_ + "/" + std::to_string(number) + std::string(ending);
}

bool PartFiles::fail(const std::string& what) {
  problem_ = what + " " + path_of(number_, kDataEnding) + ": " + part_reason();
  return false;
}

bool PartFiles::append(std::span<const std::byte> bytes) {
  if (!write_all(data_.get(), bytes)) return fail("cannot write " + std::to_string(bytes.size()) + " bytes to");
  bytes_ += bytes.size();
  checksum_ = sum_of(checksum_, bytes);
  return true;
}

bool PartFiles::read(std::uint64_t offset, std::span<std::byte> to) const {
  const auto number = static_cast<std::uint32_t>(offset >> kPartBits);
  const std::uint64_t at = offset & ((std::uint64_t{1} << kPartBits) - 1);
  if (number == number_) return read_at(data_.get(), at, to);
  int file = -1;
  {
    const std::lock_guard lock(readers_->mutex);
    Descriptor& reader = readers_->files[number];
    if (!reader) reader = Descriptor(::open(path_of(number, kDataEnding).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
    file = reader.get();
  }
  return file >= 0 && read_at(file, at, to);
}

std::optional<std::uint32_t> PartFiles::checksum_of(std::uint64_t first, std::uint64_t end) const {
  std::vector<std::byte> piece;
  std::uint32_t sum = 0;
  for (std::uint64_t at = first; at < end; at += piece.size()) {
    piece.resize(static_cast<std::size_t>(std::min<std::uint64_t>(end - at, std::uint64_t{1} << 20)));
    if (!read(at, piece)) return std::nullopt;
    sum = sum_of(sum, piece);
  }
  return sum;
}

bool PartFiles::finish(std::string_view work, std::uint64_t first, std::span<const std::byte> result) {
  const std::uint64_t base = std::uint64_t{number_} << kPartBits;
  const auto sum = first - base == summed_from_ ? std::optional(checksum_) : checksum_of(first, size());
  if (!sum || work.size() > kMostWorkName || result.size() > kMostWorkResult) return fail("cannot read again");
  std::vector<std::byte> record;
  ByteWriter writer(record);
  writer.integer(kWorkMark);
  writer.integer(static_cast<std::uint32_t>(work.size()));
  writer.integer(first);
  writer.integer(size());
  writer.integer(*sum);
  writer.integer(static_cast<std::uint32_t>(result.size()));
  for (const std::span<const std::byte> part : {std::as_bytes(std::span(work)), result})
    record.insert(record.end(), part.begin(), part.end());
  writer.integer(sum_of(0, record));
  summed_from_ = bytes_;
  checksum_ = 0;
  return write_all(list_.get(), record) || fail("cannot record the work in");
}

// Reads the list of a file up to the first damaged record, because the process may have ended while it wrote a record.
void PartFiles::read_list(std::uint32_t number) {
  const Descriptor file(::open(path_of(number, kListEnding).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  struct stat status {};
  if (!file || ::fstat(file.get(), &status) != 0) return;
  const auto all = static_cast<std::uint64_t>(status.st_size);
  for (std::uint64_t at = 0; at + kWorkHead < all;) {
    std::vector<std::byte> head(kWorkHead);
    if (!read_at(file.get(), at, head)) return;
    ByteReader reader(head);
    const auto mark = reader.integer<std::uint32_t>(), name_bytes = reader.integer<std::uint32_t>();
    Work work;
    work.first = reader.integer<std::uint64_t>();
    work.end = reader.integer<std::uint64_t>();
    work.checksum = reader.integer<std::uint32_t>();
    work.result_bytes = reader.integer<std::uint32_t>();
    work.list = number;
    const std::uint64_t bytes = kWorkHead + name_bytes + std::uint64_t{work.result_bytes};
    if (mark != kWorkMark || name_bytes > kMostWorkName || work.result_bytes > kMostWorkResult ||
        bytes + sizeof(std::uint32_t) > all - at || work.end < work.first)
      return;
    std::vector<std::byte> record(static_cast<std::size_t>(bytes) + sizeof(std::uint32_t));
    if (!read_at(file.get(), at, record)) return;
    ByteReader last(std::span<const std::byte>(record).subspan(static_cast<std::size_t>(bytes)));
    if (last.integer<std::uint32_t>() != sum_of(0, std::span(record).first(static_cast<std::size_t>(bytes)))) return;
    work.result = at + kWorkHead + name_bytes;
    finished_.insert_or_assign(std::string(reinterpret_cast<const char*>(record.data()) + kWorkHead, name_bytes), work);
    at += record.size();
  }
}

std::optional<std::vector<std::byte>> PartFiles::finished(std::string_view name) const {
  const auto found = finished_.find(name);
  if (found == finished_.end()) return std::nullopt;
  const Work& work = found->second;
  const auto sum = checksum_of(work.first, work.end);
  const Descriptor file(::open(path_of(work.list, kListEnding).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  std::vector<std::byte> result(work.result_bytes);
  if (!sum || *sum != work.checksum || !file || !read_at(file.get(), work.result, result)) return std::nullopt;
  return result;
}

}  // namespace gs::net
