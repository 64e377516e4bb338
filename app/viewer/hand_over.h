#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace gs::net {
class ControlServer;
}

namespace gs::app {

/// Returns the folder in which a window listens for files that other processes open. It lies in $XDG_RUNTIME_DIR, which
/// only the user can read. Returns an empty string if there is none, or if others can access it.
[[nodiscard]] std::string hand_over_folder();

/// Returns a path or URL in a form that is independent of the working directory.
[[nodiscard]] std::string absolute_place(const std::string& place);

/// Sends files and URLs to the window that is already open. Returns false if there is none. Relative paths are relative
/// to this process.
[[nodiscard]] bool hand_over(const std::string& folder, const std::vector<std::string>& files);

/// Receiver of files that other processes hand over to this window. Only the first window of a desktop session has one.
class HandOver {
 public:
  /// Starts to listen. `wake` is called on another thread when `take` has files. Returns null if another window listens
  /// already or there is no folder.
  [[nodiscard]] static std::unique_ptr<HandOver> listen(const std::string& folder, std::function<void()> wake);
  ~HandOver();
  HandOver(const HandOver&) = delete;
  HandOver& operator=(const HandOver&) = delete;

  /// Requests since the last call. `asked` is true if there was one, even without files, so that the window comes to
  /// the front.
  struct Taken {
    std::vector<std::string> files;
    bool asked = false;
  };
  [[nodiscard]] Taken take();

 private:
  explicit HandOver(std::unique_ptr<net::ControlServer> server);
  std::unique_ptr<net::ControlServer> server_;
};

}  // namespace gs::app
