#include "app/settings/log_file.h"

#include "app/base/console.h"
#include "net/base/descriptor.h"

#include <ctime>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gs::app {
namespace {

std::string time_of_day() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  char text[32] = "";
  if (gmtime_r(&now, &parts)) (void)std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace

void LogFile::add(std::string_view text, std::size_t most) {
  if (path_.empty()) return;
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::path(path_).parent_path();
  if (std::filesystem::create_directories(folder, error) && !error)
    std::filesystem::permissions(folder, std::filesystem::perms::owner_all, error);
  struct stat about {};
  if (::lstat(path_.c_str(), &about) == 0) {
    if (!S_ISREG(about.st_mode)) return;
    if (static_cast<std::size_t>(about.st_size) >= most) (void)::rename(path_.c_str(), (path_ + ".old").c_str());
  }
  const net::Descriptor file(::open(path_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (file.get() < 0) return;
  // Write the line with one call, so that the lines of concurrent programs do not mix.
  const std::string line = time_of_day() + " " + printable(text) + "\n";
  [[maybe_unused]] const ssize_t written = ::write(file.get(), line.data(), line.size());
}

}  // namespace gs::app
