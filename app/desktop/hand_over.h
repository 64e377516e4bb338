#pragma once

#include "base/noncopyable.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace gs::net {
class ControlServer;
}

namespace gs::app {

/// Returns the folder with the socket at which a window receives files from other processes. It is in $XDG_RUNTIME_DIR,
/// to which only the user has access. Returns "" if there is no such folder, or if others can access it.
[[nodiscard]] std::string hand_over_folder();

/// Returns a path or URL in a form that does not depend on the working directory.
[[nodiscard]] std::string absolute_place(const std::string& place);

/// Sends files and URLs to a window that is already open. Returns false if no window took them. Relative paths refer to
/// the working directory of this process.
[[nodiscard]] bool hand_over(const std::string& folder, const std::vector<std::string>& files);

/// Receiver of files from other processes for this window. Only the first window of a desktop session has a receiver.
class HandOver : NonCopyable {
 public:
  /// Starts to listen in `folder`. Another thread calls `wake` when take() has files. Returns null if there is no
  /// folder, or if another window listens already.
  [[nodiscard]] static std::unique_ptr<HandOver> listen(const std::string& folder, std::function<void()> wake);
  ~HandOver();

  /// Files that were received since the previous call. `asked` is true if there was a request, even one without files;
  /// then the window should come to the front.
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
