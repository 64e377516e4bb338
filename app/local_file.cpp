#include "app/local_file.h"
#include "app/text.h"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

namespace fs = std::filesystem;

// The path of an existing file that differs from `path` in upper and lower case only; empty for none.
std::string find_ignoring_case(const fs::path& path) {
  std::error_code error;
  fs::path found = path.is_absolute() ? path.root_path() : fs::path(".");
  for (const fs::path& part : path.relative_path()) {
    fs::path next = found / part;
    if (!fs::exists(next, error)) {
      const std::string wanted = lower_case(part.string());
      next.clear();
      for (fs::directory_iterator entry(found, error), end; !error && entry != end; entry.increment(error))
        if (lower_case(entry->path().filename().string()) == wanted) next = entry->path();
      if (next.empty()) return {};
    }
    found = next;
  }
  return found.string();
}

}  // namespace

LocalFile open_local_file(const net::Url& url, const std::string& given) {
  LocalFile result;
  result.path = given.empty() ? net::path_of_url(url) : given;
  if (result.path.empty()) return result;
  auto opened = net::map_file(result.path);
  if (const auto* error = std::get_if<net::FileError>(&opened)) {
    result.problem = error->message;
    std::string other = given.empty() ? find_ignoring_case(result.path) : std::string();
    if (other.empty()) return result;
    opened = net::map_file(other);
    result.path = std::move(other);
  }
  if (auto* file = std::get_if<net::MappedFile>(&opened)) result.file = std::move(*file);
  return result;
}

}  // namespace gs::app
