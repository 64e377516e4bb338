#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Contents of a folder for the file dialogs. The folder is read again if another folder was requested in between, or
/// after forget().
class FolderListing {
 public:
  struct Entry {
    std::string name;
    bool is_folder = false;
    bool is_known = false;  // a content type has the extension of this file
  };
  static constexpr std::size_t kMaxEntries = 5000;

  /// Returns the entries sorted by name, folders first. If the folder is unreadable, problem() returns the error
  /// message.
  [[nodiscard]] const std::vector<Entry>& entries_of(const std::string& folder);
  [[nodiscard]] const std::string& problem() const { return problem_; }
  void forget() { folder_.clear(); }

 private:
  std::string folder_, problem_;
  std::vector<Entry> entries_;
};

/// Partially typed path, split into its folder and its last component.
struct TypedPath {
  std::string before;  // as typed, up to and including the last /
  std::string folder;  // `before` with ~ expanded; empty means the current folder
  std::string part;    // last component
};
[[nodiscard]] TypedPath typed_path(std::string_view typed);
/// Reports whether the text can only be a path: it contains / or begins with ~, and is no URL.
[[nodiscard]] bool looks_like_path(std::string_view typed);
/// Reports whether the text is a URL.
[[nodiscard]] bool looks_like_url(std::string_view typed);

/// Completes a path as Tab does: up to the common prefix of all matches. A single matching folder gets a trailing /.
[[nodiscard]] std::string completed_path(const std::string& typed, FolderListing& listing);
/// Returns up to `most` completions of a typed path. Omits files of unknown types.
[[nodiscard]] std::vector<std::string> suggested_paths(std::string_view typed, FolderListing& listing,
                                                       std::size_t most);
/// Returns the path that the typed text denotes: expands ~ and trims blanks.
[[nodiscard]] std::string opened_path(std::string_view typed);

}  // namespace gs::app
