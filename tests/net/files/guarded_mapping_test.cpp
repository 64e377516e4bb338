#include "net/files/guarded_mapping.h"
#include "base/noncopyable.h"

#include "net/files/file.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;
using namespace gs::net;

constexpr std::size_t kMappedLarge = 3 * MappedFile::kMappedSize;

// Temporary file of x's.
class LargeFile : gs::NonCopyable {
 public:
  explicit LargeFile(std::size_t size = kMappedLarge) {
    std::string name = (fs::temp_directory_path() / "ghostspace-mapping-test-XXXXXX").string();
    const Descriptor file(::mkstemp(name.data()));
    REQUIRE(file);
    path = name;
    std::ofstream(path, std::ios::binary) << std::string(size, 'x');
  }
  ~LargeFile() {
    std::error_code error;
    fs::remove(path, error);
  }
  std::string path;
};

MappedFile mapped_file_of(const std::string& path) {
  auto opened = map_file(path);
  REQUIRE(std::holds_alternative<MappedFile>(opened));
  return std::move(std::get<MappedFile>(opened));
}

std::size_t count_of_bytes(std::span<const std::byte> bytes, char c) {
  return static_cast<std::size_t>(std::count(bytes.begin(), bytes.end(), static_cast<std::byte>(c)));
}

}  // namespace

TEST_CASE("reads zeros and reports it when a mapped file is truncated") {
  const LargeFile file;
  const MappedFile whole = mapped_file_of(file.path);
  REQUIRE(whole.bytes().size() == kMappedLarge);
  CHECK(whole.bytes()[kMappedLarge - 1] == std::byte{'x'});
  CHECK_FALSE(whole.changed());
  fs::resize_file(file.path, 10'000);
  CHECK(count_of_bytes(whole.bytes(), 'x') == 10'000);
  CHECK(count_of_bytes(whole.bytes(), '\0') == kMappedLarge - 10'000);
  REQUIRE(whole.changed());
  CHECK(whole.changed()->starts_with("the file changed while it was read"));
  fs::resize_file(file.path, 0);
  CHECK(whole.bytes()[5] == std::byte{0});
  // A new mapping shows the present content, and other files are unaffected.
  std::ofstream(file.path, std::ios::binary) << std::string(kMappedLarge, 'y');
  const MappedFile again = mapped_file_of(file.path);
  CHECK(count_of_bytes(again.bytes(), 'y') == kMappedLarge);
  CHECK_FALSE(again.changed());
}

TEST_CASE("reports that a mapped file was written to or shortened by a byte") {
  const LargeFile file;
  // The clock of a file system is coarse, so the old time is set far back.
  fs::last_write_time(file.path, fs::file_time_type::clock::now() - std::chrono::hours(1));
  MappedFile first = mapped_file_of(file.path);
  const MappedFile one = std::move(first);
  CHECK(first.bytes().empty());
  CHECK_FALSE(first.changed());
  CHECK_FALSE(one.changed());
  {
    std::fstream edit(file.path, std::ios::in | std::ios::out | std::ios::binary);
    edit.seekp(5);
    edit << "other";
  }
  CHECK(one.changed());
  const LargeFile shorter(kMappedLarge - 1);
  const MappedFile two = mapped_file_of(shorter.path);
  fs::resize_file(shorter.path, kMappedLarge - 2);
  CHECK(two.bytes()[kMappedLarge - 2] == std::byte{0});
  CHECK(two.changed());
  fs::remove(shorter.path);
  CHECK(two.bytes()[0] == std::byte{'x'});
}

TEST_CASE("keeps threads running that read a mapped file while it is truncated") {
  const LargeFile file, other;
  const MappedFile shrinking = mapped_file_of(file.path), kept = mapped_file_of(other.path);
  std::atomic<bool> cut{false};
  std::vector<std::size_t> seen(4), untouched(4);
  {
    std::vector<std::jthread> readers;
    for (std::size_t i = 0; i < seen.size(); ++i)
      readers.emplace_back([&, i] {
        while (!cut) (void)count_of_bytes(shrinking.bytes(), 'x');
        seen[i] = count_of_bytes(shrinking.bytes(), 'x');
        untouched[i] = count_of_bytes(kept.bytes(), 'x');
      });
    fs::resize_file(file.path, 4096);
    cut = true;
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    CHECK(seen[i] == 4096);
    CHECK(untouched[i] == kMappedLarge);
  }
  CHECK(shrinking.changed());
  CHECK_FALSE(kept.changed());
}

TEST_CASE("guards each of many short-lived mappings") {
  const LargeFile file;
  for (int round = 0; round < 100; ++round) {
    const Descriptor open(::open(file.path.c_str(), O_RDONLY | O_CLOEXEC));
    auto one = GuardedMapping::of(open.get(), kMappedLarge), two = GuardedMapping::of(open.get(), 100);
    REQUIRE(one);
    REQUIRE(two);
    *one = std::move(*two);
    CHECK(one->bytes().size() == 100);
    CHECK(count_of_bytes(one->bytes(), 'x') == 100);
    CHECK_FALSE(one->lost());
  }
  const Descriptor open(::open(file.path.c_str(), O_RDONLY | O_CLOEXEC));
  CHECK_FALSE(GuardedMapping::of(open.get(), 0));
  CHECK_FALSE(GuardedMapping::of(-1, 100));
}

TEST_CASE("ends the program on a bus error outside all guarded mappings") {
  const LargeFile file;
  const MappedFile guarded = mapped_file_of(file.path);  // the handler is installed
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const Descriptor open(::open(file.path.c_str(), O_RDWR | O_CLOEXEC));
    const Descriptor nothing(::open("/dev/null", O_WRONLY | O_CLOEXEC));
    (void)::dup2(nothing.get(), STDERR_FILENO);  // hides AddressSanitizer's report
    void* const bare = ::mmap(nullptr, kMappedLarge, PROT_READ, MAP_SHARED, open.get(), 0);
    if (bare == MAP_FAILED || ::ftruncate(open.get(), 0) != 0) ::_exit(0);
    const char last = static_cast<const volatile char*>(bare)[kMappedLarge - 1];
    ::_exit(last == 0 ? 0 : 0);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK_FALSE((WIFEXITED(status) && WEXITSTATUS(status) == 0));
}
