#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// What is in a folder, for those who choose files. Read again when another folder is asked for, or on demand.
class FolderListing {
 public:
  struct Entry {
    std::string name;
    bool is_folder = false;
    bool is_known = false;  // some content type calls files of this name its own
  };
  static constexpr std::size_t kMostEntries = 5000;

  /// Folders first, by name. `problem` says why it cannot be read.
  [[nodiscard]] const std::vector<Entry>& entries_of(const std::string& folder);
  [[nodiscard]] const std::string& problem() const { return problem_; }
  void forget() { folder_.clear(); }

 private:
  std::string folder_, problem_;
  std::vector<Entry> entries_;
};

/// A path as it is typed: the folder that its last part is in, as typed and as the system knows it.
struct TypedPath {
  std::string before;  // up to the last /, with it; as typed
  std::string folder;  // for the system; of nothing: the current one
  std::string part;    // behind it
};
[[nodiscard]] TypedPath typed_path(std::string_view typed);
/// True for what is a path for sure: it begins at the root, at home or in a folder.
[[nodiscard]] bool looks_like_path(std::string_view typed);
/// True for URLs.
[[nodiscard]] bool looks_like_url(std::string_view typed);

/// What Tab makes of a typed path: as far as all that fit agree; behind a folder that is the only one comes a /.
[[nodiscard]] std::string completed_path(const std::string& typed, FolderListing& listing);
/// Paths that a typed one may become, at most `most`; files that nothing can open are left out.
[[nodiscard]] std::vector<std::string> suggested_paths(std::string_view typed, FolderListing& listing,
                                                       std::size_t most);
/// A path as it is opened: with the user's home in the place of ~, without blanks around it.
[[nodiscard]] std::string opened_path(std::string_view typed);

}  // namespace gs::app
