#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// A program of a desktop that asks the user for files.
struct DialogProgram {
  std::string name;                    // looked for in $PATH, unless it has a /
  std::vector<std::string> arguments;  // so that it prints the chosen ones, a line each; see kFolderArgument
};
/// Stands in an argument for the folder where the dialog begins.
inline constexpr const char kFolderArgument[] = "{folder}";
/// Those that are known, best first.
[[nodiscard]] std::span<const DialogProgram> dialog_programs();

/// The dialog of the desktop, as a child process: the window goes on meanwhile. One at a time.
class FileDialog {
 public:
  /// `wake` is called on another thread when `take` has something.
  explicit FileDialog(std::function<void()> wake, std::span<const DialogProgram> programs = dialog_programs());
  ~FileDialog();
  FileDialog(const FileDialog&) = delete;
  FileDialog& operator=(const FileDialog&) = delete;

  /// `folder`: where it begins. False: no desktop is there, or none of the programs. True: it is shown, or was already.
  [[nodiscard]] bool show(const std::string& folder = ".");
  [[nodiscard]] bool is_shown() const { return running_ != nullptr; }
  /// How it ended.
  struct Answer {
    std::vector<std::string> files;  // empty: the user chose none
    bool failed = false;             // it ended without asking
  };
  /// Nothing: it is still shown, or was not.
  [[nodiscard]] std::optional<Answer> take();

 private:
  struct Running;
  std::function<void()> wake_;
  std::span<const DialogProgram> programs_;
  std::unique_ptr<Running> running_;
};

}  // namespace gs::app
