#pragma once

#include "app/loading/updates/resource_updates.h"
#include "app/script/script_runner.h"

#include <cstddef>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

namespace gs::app {

/// Question to the user whether the Scripts of a world may use the network, although they have read a private file.
struct NetworkQuestion {
  std::string file;  // URL of a private file that a Script has read
  std::string url;   // first URL that the gate held back
};

/// Gate for network requests of a world's Scripts. It closes when a Script has read a private file, and holds requests
/// back until the user decides (docs/security.md, "What Scripts may read"). One thread.
class NetworkGate {
 public:
  void allow() { decision_ = Decision::allowed; }
  void refuse();
  /// Closes the gate: requests are held back from now on, unless the user has already decided. `file` is the URL of the
  /// private file.
  void close(const std::string& file);

  /// Moves the requests that need permission from `requests` into the gate. Returns one message for each host that is
  /// new.
  [[nodiscard]] std::vector<std::string> hold_back(std::vector<UrlRequest>& requests);
  [[nodiscard]] std::vector<std::string> hold_back(std::vector<ScriptRequest>& requests);
  /// Returns the question; nullopt if no request is held back or the user has decided.
  [[nodiscard]] std::optional<NetworkQuestion> question() const;
  /// Returns the requests that were held back, after the user has allowed them.
  [[nodiscard]] std::vector<UrlRequest> take_url_requests();
  [[nodiscard]] std::vector<ScriptRequest> take_script_requests();
  /// Drops requests that refer to a scene. Call before the scene is removed.
  void forget_scene(const vrml::SceneGraph& scene);

 private:
  template <class Request, class Needs, class UrlsOf>
  std::vector<std::string> move_held(std::vector<Request>& from, std::vector<Request>& to, const Needs& needs,
                                     const UrlsOf& urls_of);

  enum class Decision : std::uint8_t { open, asks, allowed, refused };
  Decision decision_ = Decision::open;
  std::string file_, first_url_;
  std::vector<UrlRequest> urls_;
  std::vector<ScriptRequest> scripts_;
  std::unordered_set<std::string> told_;  // hosts for which a message was already returned
};

}  // namespace gs::app
