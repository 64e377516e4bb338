#include "app/base/temporary_file.h"

#include "net/files/file.h"
#include "net/files/unfinished_file.h"

#include <filesystem>
#include <mutex>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTemporaryFolders = "ghostspace-temporary";

/// Paths of the existing temporary folders of this process. Never destroyed, because static objects may use them.
struct LiveFolders {
  std::mutex mutex;
  std::set<std::string> paths;
};
LiveFolders& live_folders() {
  static LiveFolders& folders = *new LiveFolders;
  return folders;
}

std::string file_name_part(const std::string& name) {
  std::string result;
  for (const char c : name.substr(0, 100))
    result += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ? c : '_';
  return result;
}

}  // namespace

TemporaryFile::TemporaryFile(const std::string& name, std::span<const std::byte> bytes) {
  std::error_code error;
  const fs::path base = fs::temp_directory_path(error);
  auto folder = net::LockedFolder::make(base.string(), kTemporaryFolders);
  if (const auto* problem = std::get_if<std::string>(&folder)) {
    problem_ = *problem;
    return;
  }
  folder_ = std::move(std::get<net::LockedFolder>(folder));
  {
    const std::lock_guard lock(live_folders().mutex);
    live_folders().paths.insert(folder_.path());
  }
  path_ = folder_.path() + "/x" + file_name_part(name);
  if (const auto failed = net::write_file_atomically(path_, bytes)) problem_ = failed->message;
}

TemporaryFile::~TemporaryFile() {
  const std::lock_guard lock(live_folders().mutex);
  live_folders().paths.erase(folder_.path());
}

void remove_temporary_files() {
  const std::lock_guard lock(live_folders().mutex);
  std::error_code ignored;
  for (const std::string& path : live_folders().paths) fs::remove_all(path, ignored);
  live_folders().paths.clear();
}

void remove_abandoned_files() {
  std::error_code error;
  const fs::path base = fs::temp_directory_path(error);
  if (!error) (void)net::remove_abandoned_folders(base.string(), kTemporaryFolders);
}

void remove_unfinished_beside(const std::string& file) {
  if (file.empty()) return;
  std::error_code error;
  const fs::path target = fs::weakly_canonical(file, error);  // writing resolves symbolic links, too
  const std::string folder = (error ? fs::path(file) : target).parent_path().string();
  (void)net::remove_unfinished_files(folder.empty() ? "." : folder);
}

}  // namespace gs::app
