#include "app/interface/base/places.h"

#include "app/formats/content_types.h"
#include "app/session/documents/link_file.h"
#include "app/settings/user_folders.h"
#include "base/text.h"
#include "net/base/schemes.h"
#include "net/base/url.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace gs::app {
namespace {

namespace fs = std::filesystem;

bool begins(const std::string& name, const std::string& part) {
  return lower_case(std::string_view(name).substr(0, part.size())) == lower_case(part);
}

std::vector<FolderListing::Entry> fitting(const TypedPath& path, FolderListing& listing) {
  std::vector<FolderListing::Entry> result;
  for (const FolderListing::Entry& entry : listing.entries_of(path.folder))
    if ((entry.is_folder || entry.is_known) && (entry.name[0] != '.' || path.part.starts_with('.')) &&
        begins(entry.name, path.part))
      result.push_back(entry);
  return result;
}

}  // namespace

const std::vector<FolderListing::Entry>& FolderListing::entries_of(const std::string& wanted) {
  std::error_code error;
  const std::string folder = wanted.empty() ? fs::current_path(error).string() : wanted;
  if (folder == folder_) return entries_;
  folder_ = folder;
  entries_.clear();
  problem_.clear();
  error.clear();
  fs::directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && entry != fs::directory_iterator() && entries_.size() < kMaxEntries; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.empty()) continue;
    std::error_code ignored;  // an error of a dangling symbolic link
    if (entry->is_directory(ignored))
      entries_.push_back({name, true, false});
    else if (entry->is_regular_file(ignored))
      entries_.push_back({name, false, content_type_by_name(name) != nullptr});
  }
  if (error) problem_ = "Cannot read this folder: " + error.message();
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return a.is_folder != b.is_folder ? a.is_folder : lower_case(a.name) < lower_case(b.name);
  });
  return entries_;
}

TypedPath typed_path(std::string_view typed) {
  TypedPath path;
  const std::size_t slash = typed.rfind('/');
  if (typed == "~") return {"~/", with_home("~"), ""};
  if (slash != std::string_view::npos) path.before = typed.substr(0, slash + 1);
  path.part = typed.substr(path.before.size());
  path.folder = with_home(path.before);
  return path;
}

bool looks_like_url(std::string_view typed) {
  const net::Url url = net::parse_url(typed);
  return net::has_scheme(typed, kLinkScheme) || (!url.scheme.empty() && net::find_scheme(url.scheme));
}

bool looks_like_path(std::string_view typed) {
  return !looks_like_url(typed) &&
         (typed.starts_with('/') || typed.starts_with('~') || typed.find('/') != std::string_view::npos);
}

std::string completed_path(const std::string& typed, FolderListing& listing) {
  if (typed.empty() || looks_like_url(typed)) return typed;
  const TypedPath path = typed_path(typed);
  const std::vector<FolderListing::Entry> fit = fitting(path, listing);
  if (fit.empty()) return typed;
  std::string common = fit.front().name;
  for (const FolderListing::Entry& entry : fit)
    while (!begins(entry.name, common)) common.pop_back();
  if (fit.size() == 1 && fit.front().is_folder) common += '/';
  if (common.size() < path.part.size()) return typed;
  // Do not cut in the middle of a UTF-8 character.
  while (!common.empty() && fit.size() > 1 && (static_cast<unsigned char>(common.back()) & 0x80) != 0 &&
         common.size() > path.part.size())
    common.pop_back();
  return path.before + common;
}

std::vector<std::string> suggested_paths(std::string_view typed, FolderListing& listing, std::size_t most) {
  std::vector<std::string> result;
  if (typed.empty() || looks_like_url(typed)) return result;
  const TypedPath path = typed_path(typed);
  for (const FolderListing::Entry& entry : fitting(path, listing)) {
    if (result.size() >= most) break;
    result.push_back(path.before + entry.name + (entry.is_folder ? "/" : ""));
  }
  return result;
}

std::string opened_path(std::string_view typed) {
  while (!typed.empty() && (typed.front() == ' ' || typed.front() == '\t')) typed.remove_prefix(1);
  while (!typed.empty() && (typed.back() == ' ' || typed.back() == '\t')) typed.remove_suffix(1);
  return with_home(typed);
}

}  // namespace gs::app
