#pragma once

#include "app/base/need_bytes.h"
#include "app/base/read_files.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

// Requests of a child for several files at once, for parts of its own file, and for lists of folders. The channel sends
// them as texts in place of the name of a single file (child_channel.h), one text per request. The answer to the last
// request of a batch has all files.
namespace gs::app {

/// Returns true for the text of such a request. References of files do not look like it.
[[nodiscard]] bool is_file_request(const std::string& text);

/// Child: makes functions that ask its parent. A parent that gives impossible answers ends the process.
[[nodiscard]] ReadFiles files_by_asking(const ReadFile& ask);
[[nodiscard]] ListFolder folders_by_asking(const ReadFile& ask);
/// Child: makes a function that requests parts of its own file. The function requests no part twice.
[[nodiscard]] NeedBytes parts_by_asking(const ReadFile& ask);

/// Parent: collects the requests of a batch and reads their files. One thread at a time.
class FileBatches {
 public:
  /// `read` and `list` may be null; then files or folders are not read. `need` receives parts of the child's own file,
  /// and may be null.
  FileBatches(ReadFiles read, ListFolder list, NeedBytes need = {})
      : read_(std::move(read)), list_(std::move(list)), need_(std::move(need)) {}

  /// Forgets the batch that an earlier child did not complete.
  void begin_child() { batch_.clear(); }
  /// Returns the answer to a text of is_file_request(). Trusts nothing: returns nullopt for texts that no honest child
  /// sends.
  [[nodiscard]] std::optional<BytesResult> answer(const std::string& text);

 private:
  [[nodiscard]] BytesResult answer_parts(const std::vector<FileRequest>& batch) const;

  ReadFiles read_;
  ListFolder list_;
  NeedBytes need_;
  std::vector<FileRequest> batch_;
};

}  // namespace gs::app
