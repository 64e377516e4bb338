#include "app/base/local_file.h"
#include "base/text.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::string existing_path(const std::string& wanted_path) {
  const fs::path path(wanted_path);
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

LocalFile open_local_file(const net::Url& url, const net::ReferencePolicy& policy, const net::Origin& from,
                          const std::string& given, const net::CheckFirstBytes& check) {
  LocalFile result;
  result.path = given.empty() ? net::path_of_url(url) : given;
  // Sets `result`. Returns false if the file does not exist.
  const auto open = [&](const std::string& path) {
    if (const auto refused = policy.refuse_file(from, path)) {
      result.problem = path + ": " + refused->message;
      result.folder = refused->folder;
      return true;
    }
    auto opened = net::map_file(path, check);
    if (auto* file = std::get_if<net::MappedFile>(&opened)) {
      result.file = std::move(*file);
      return true;
    }
    if (result.problem.empty()) result.problem = std::get<net::FileError>(opened).message;
    return false;
  };
  if (result.path.empty() || open(result.path) || !given.empty()) return result;
  std::string other = existing_path(result.path);
  if (!other.empty() && open(other)) result.path = std::move(other);
  return result;
}

net::ReferencePolicy policy_of_world(const std::string& path, const std::vector<std::string>& allowed) {
  net::ReferencePolicy policy;
  std::error_code error;
  policy.allow(fs::absolute(path, error).parent_path().string());
  for (const std::string& one : allowed) policy.allow(one);
  return policy;
}

ReadFile reader_beside(const std::string& path, const std::vector<std::string>& allowed) {
  const net::Url base = net::url_of_path(path);
  return [base, from = net::Origin{base.text()},
          policy = policy_of_world(path, allowed)](const std::string& reference) -> BytesResult {
    const net::Url url = net::resolve(base, net::parse_url(reference));
    if (const auto refused = policy.refuse(from, url)) return reference + ": " + refused->message;
    if (url.scheme != "file") return reference + ": not a local file";
    LocalFile found = open_local_file(url, policy, from);
    if (!found.file) return found.problem;
    return shared_bytes(std::move(*found.file));
  };
}

std::vector<std::string> files_below(const std::string& folder, std::size_t most) {
  constexpr int kMostDepth = 8;
  std::vector<std::string> files;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error), end;
  for (; !error && entry != end && files.size() < most; entry.increment(error)) {
    const bool hidden = entry->path().filename().string().starts_with('.');
    std::error_code ignored;
    if (entry->is_directory(ignored)) {
      if (hidden || entry.depth() >= kMostDepth) entry.disable_recursion_pending();
    } else if (!hidden && entry->is_regular_file(ignored)) {
      files.push_back(entry->path().lexically_relative(folder).generic_string());
    }
  }
  std::ranges::sort(files);
  return files;
}

ReadFile folder_reader(const std::string& folder) {
  return [folder, read = reader_beside(folder + "/list", {})](const std::string& reference) -> BytesResult {
    if (reference != kFolderReference) return read(reference);
    constexpr std::size_t kMostFiles = 100'000;
    std::string names;
    for (const std::string& name : files_below(folder, kMostFiles))
      if (name.find('\n') == std::string::npos) names += name + '\n';
    return shared_bytes(copied_bytes(names));
  };
}

ReadFiles files_beside(const std::string& path, const std::vector<std::string>& allowed) {
  const net::Url base = net::url_of_path(path);
  return [base, from = net::Origin{base.text()},
          policy = policy_of_world(path, allowed)](std::span<const FileRequest> requests) {
    std::vector<FileResult> results;
    for (const FileRequest& request : requests)
      results.push_back(read_local_part(net::resolve(base, net::parse_url(request.reference)), policy, from, request));
    return results;
  };
}

ListFolder lister_beside(const std::string& path) {
  const net::Url base = net::url_of_path(path);
  return [base, policy = policy_of_world(path, {}),
          from = net::Origin{base.text()}](const std::string& reference) -> std::optional<std::vector<std::string>> {
    const std::string folder = net::path_of_url(net::resolve(base, net::parse_url(reference)));
    if (folder.empty() || policy.refuse_file(from, folder)) return std::nullopt;
    constexpr std::size_t kMostNames = 1'000'000;
    std::vector<std::string> names;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end && names.size() < kMostNames;
         entry.increment(error))
      if (std::string name = entry->path().filename().string(); !name.starts_with('.'))
        names.push_back(std::move(name));
    if (error) return std::nullopt;
    return names;
  };
}

FileResult read_local_part(const net::Url& url, const net::ReferencePolicy& policy, const net::Origin& from,
                           const FileRequest& request) {
  if (const auto refused = policy.refuse(from, url)) return request.reference + ": " + refused->message;
  if (url.scheme != "file") return request.reference + ": not a local file";
  const std::string path = net::path_of_url(url);
  if (const auto refused = policy.refuse_file(from, path)) return path + ": " + refused->message;
  auto opened = net::map_file(path);
  if (auto* const file = std::get_if<net::MappedFile>(&opened))
    return part_of(shared_bytes(std::move(*file)), request.part);
  std::error_code error;
  if (fs::symlink_status(path, error).type() == fs::file_type::not_found) return NoFile();
  // A chunk that is a folder does not exist.
  if (fs::is_directory(path, error)) return NoFile();
  return std::get<net::FileError>(opened).message;
}

SharedBytes shared_bytes(net::MappedFile file) {
  auto owner = std::make_shared<const net::MappedFile>(std::move(file));
  return {owner, owner->bytes(), owner.get()};
}

}  // namespace gs::app
