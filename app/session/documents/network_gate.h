#pragma once

#include "app/loading/updates/resource_updates.h"
#include "app/script/script_runner.h"

#include <cstddef>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

namespace gs::app {

/// Question to the user: may Scripts that have read a private file use the network?
struct NetworkQuestion {
  std::string file;  // URL of the text that a Script has read
  std::string url;   // first URL that was held back
};

/// Gate for the network requests of a world's Scripts. After one of them has read a private file, it holds the requests
/// back until the user decides (docs/security.md, "What Scripts may read"). One thread.
class NetworkGate {
 public:
  void allow() { decision_ = Decision::allowed; }
  void refuse();
  /// Starts to hold back requests, unless the user has already decided. `file` is the URL of the private file.
  void close(const std::string& file);

  /// Moves the requests that need permission from a list into this object. Returns a message for each new host.
  [[nodiscard]] std::vector<std::string> hold_back(std::vector<UrlRequest>& requests);
  [[nodiscard]] std::vector<std::string> hold_back(std::vector<ScriptRequest>& requests);
  /// Returns the question, or nullopt if nothing waits for an answer.
  [[nodiscard]] std::optional<NetworkQuestion> question() const;
  /// Returns the requests that were held back, once the user allows them.
  [[nodiscard]] std::vector<UrlRequest> take_url_requests();
  [[nodiscard]] std::vector<ScriptRequest> take_script_requests();
  /// Drops requests that refer to a scene that is about to be removed.
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
  std::unordered_set<std::string> told_;  // hosts that a message was returned for
};

}  // namespace gs::app
