#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Program of a desktop that lets the user choose files.
struct DialogProgram {
  std::string name;                    // searched in $PATH unless it contains a /
  std::vector<std::string> arguments;  // make it print the chosen files, one per line; see kFolderArgument
};
/// Placeholder in an argument for the initial folder.
inline constexpr const char kFolderArgument[] = "{folder}";
/// Returns the known programs, best first.
[[nodiscard]] std::span<const DialogProgram> dialog_programs();

/// File dialog of the desktop, as a child process, so that the window keeps running. Only one at a time.
class FileDialog {
 public:
  /// Creates the dialog without showing it. `wake` is called on another thread when `take` has an answer.
  explicit FileDialog(std::function<void()> wake, std::span<const DialogProgram> programs = dialog_programs());
  ~FileDialog();
  FileDialog(const FileDialog&) = delete;
  FileDialog& operator=(const FileDialog&) = delete;

  /// Shows the dialog in `folder`, unless it is already shown. Returns false if no desktop or none of the programs is
  /// available.
  [[nodiscard]] bool show(const std::string& folder = ".");
  [[nodiscard]] bool is_shown() const { return running_ != nullptr; }
  /// Result of the dialog.
  struct Answer {
    std::vector<std::string> files;  // empty if the user cancelled
    bool failed = false;             // the program failed before it asked
  };
  /// Returns the answer, or nullopt if the dialog is still shown or was not shown.
  [[nodiscard]] std::optional<Answer> take();

 private:
  struct Running;
  std::function<void()> wake_;
  std::span<const DialogProgram> programs_;
  std::unique_ptr<Running> running_;
};

}  // namespace gs::app
