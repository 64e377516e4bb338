#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace gs::net {
class ControlServer;
}

namespace gs::app {

/// Where a window takes what the user opens elsewhere, and who opens something asks for a window: in the folder of the
/// user's session ($XDG_RUNTIME_DIR), which nobody else can read. Empty: there is none, or it is not the user's alone.
[[nodiscard]] std::string hand_over_folder();

/// A path or URL as another process would find it, or this one in another folder.
[[nodiscard]] std::string absolute_place(const std::string& place);

/// Gives files and URLs to the window that is there already. True: it has taken them; false: there is none. Relative
/// paths are those of this process.
[[nodiscard]] bool hand_over(const std::string& folder, const std::vector<std::string>& files);

/// A window to which files are handed over. One in a session; the first has the place.
class HandOver {
 public:
  /// `wake` is called on another thread when `take` has something. Null: another window has the place, or there is
  /// none.
  [[nodiscard]] static std::unique_ptr<HandOver> listen(const std::string& folder, std::function<void()> wake);
  ~HandOver();
  HandOver(const HandOver&) = delete;
  HandOver& operator=(const HandOver&) = delete;

  /// What was handed over since the last time; `asked`: somebody did, if only for the window to come to the front.
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
