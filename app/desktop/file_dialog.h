#pragma once

#include "base/noncopyable.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Program of a desktop that shows a file dialog.
struct DialogProgram {
  std::string name;                    // file name; searched in $PATH unless it contains a /
  std::vector<std::string> arguments;  // make it print the chosen files, one per line; may contain kFolderArgument
  /// Arguments that make the program ask for a file to save. It must ask before an existing file is replaced. May
  /// contain kFileArgument. Empty if the program cannot do this.
  std::vector<std::string> save_arguments = {};
};
/// Placeholder in an argument for the folder that the dialog shows first.
inline constexpr const char kFolderArgument[] = "{folder}";
/// Placeholder in an argument for the path that the dialog proposes.
inline constexpr const char kFileArgument[] = "{file}";
/// Returns the known programs, best first.
[[nodiscard]] std::span<const DialogProgram> dialog_programs();

/// File dialog of the desktop. It runs as a child process, so that the window stays responsive. Only one is shown at a
/// time.
class FileDialog : NonCopyable {
 public:
  /// Prepares the dialog without showing it. Another thread calls `wake` when take() has an answer.
  explicit FileDialog(std::function<void()> wake, std::span<const DialogProgram> programs = dialog_programs());
  ~FileDialog();

  /// Shows the dialog with the contents of `folder`. Does nothing if a dialog is already shown. Returns false if there
  /// is no desktop, or none of the programs.
  [[nodiscard]] bool show(const std::string& folder = ".");
  /// Shows the dialog for saving a file, with a proposed path. Returns false like show().
  [[nodiscard]] bool show_saving(const std::string& path);
  [[nodiscard]] bool is_shown() const { return running_ != nullptr; }
  /// Result of the dialog.
  struct Answer {
    std::vector<std::string> files;  // empty if the user cancelled
    bool failed = false;             // the program failed before the user could choose
    bool saves = false;              // answer of show_saving(); the user agreed to replace the file if it exists
  };
  /// Returns the answer of the user. Returns nullopt while the dialog is shown, and if it was not shown.
  [[nodiscard]] std::optional<Answer> take();

 private:
  struct Running;
  bool start(bool saves, const char* placeholder, const std::string& place);

  std::function<void()> wake_;
  std::span<const DialogProgram> programs_;
  std::unique_ptr<Running> running_;
};

}  // namespace gs::app
