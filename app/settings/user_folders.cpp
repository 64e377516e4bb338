#include "app/settings/user_folders.h"

#include "base/text.h"
#include "net/files/file.h"

#include <cstdlib>
#include <filesystem>
#include <span>
#include <system_error>
#include <variant>

namespace gs::app {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kMaxBytes = std::size_t{1} << 20;
constexpr char kFolderOfOurs[] = "/ghostspace";

// Returns the folder in an environment variable. Ignores a relative path (XDG Base Directory Specification).
std::string folder_in(const char* variable) {
  const char* value = std::getenv(variable);
  return value && value[0] == '/' ? std::string(value) : std::string();
}

std::string base_folder(const char* variable, const char* below_home) {
  if (std::string folder = folder_in(variable); !folder.empty()) return folder;
  const std::string home = folder_in("HOME");
  return home.empty() ? home : home + below_home;
}

}  // namespace

UserFolders user_folders(const std::string& settings_file) {
  UserFolders folders;
  const std::string config = base_folder("XDG_CONFIG_HOME", "/.config"),
                    state = base_folder("XDG_STATE_HOME", "/.local/state");
  if (!config.empty()) {
    folders.settings_file = config + kFolderOfOurs + "/settings.conf";
    folders.bookmarks_file = config + kFolderOfOurs + "/bookmarks.json";
  }
  if (!state.empty()) folders.state = state + kFolderOfOurs;
  if (!settings_file.empty()) folders.settings_file = settings_file;
  return folders;
}

std::string with_home(std::string_view path) {
  if (path.empty() || path[0] != '~' || (path.size() > 1 && path[1] != '/')) return std::string(path);
  const std::string home = folder_in("HOME");
  return home.empty() ? std::string(path) : home + std::string(path.substr(1));
}

std::string without_home(std::string_view path) {
  const std::string home = folder_in("HOME");
  if (home.size() < 2 || !path.starts_with(home) || (path.size() > home.size() && path[home.size()] != '/'))
    return std::string(path);
  return "~" + std::string(path.substr(home.size()));
}

std::optional<std::string> read_user_file(const std::string& path, std::string& problem) {
  std::error_code error;
  if (path.empty() || fs::status(path, error).type() == fs::file_type::not_found) return std::nullopt;
  const auto opened = net::map_file(path);
  if (const auto* failed = std::get_if<net::FileError>(&opened)) {
    problem = failed->message;
    return std::nullopt;
  }
  const auto bytes = std::get<net::MappedFile>(opened).bytes();
  if (bytes.size() > kMaxBytes) {
    problem = path + ": it is longer than " + readable_size(kMaxBytes);
    return std::nullopt;
  }
  return std::string(text_of(bytes));
}

std::optional<std::string> write_user_file(const std::string& path, std::string_view text) {
  std::error_code error;
  const fs::path folder = fs::path(path).parent_path();
  if (!folder.empty() && fs::create_directories(folder, error) && !error)
    fs::permissions(folder, fs::perms::owner_all, error);
  const auto failed = net::write_file_atomically(path, std::as_bytes(std::span<const char>(text)));
  return failed ? std::optional(failed->message) : std::nullopt;
}

void keep_bad_file(const std::string& path, std::string_view text) { (void)write_user_file(path + ".bad", text); }

}  // namespace gs::app
