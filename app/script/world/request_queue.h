#pragma once

#include "app/script/script_runner.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace gs::app::script {

/// Requests of programs that wait for the session. Bounded. One thread.
class RequestQueue {
 public:
  /// Adds a request. Drops it if too many requests, or too much text, are already waiting.
  void add(ScriptRequest request);
  /// Adds the request of a Script for its program. The number of Scripts bounds these requests.
  void add_program(ScriptRequest request) { requests_.push_back(std::move(request)); }
  [[nodiscard]] std::vector<ScriptRequest> take() {
    bytes_ = 0;
    return std::exchange(requests_, {});
  }
  /// Drops requests of or for a scene that is about to be removed.
  void forget_scene(const vrml::SceneGraph& scene);

 private:
  std::vector<ScriptRequest> requests_;
  std::size_t bytes_ = 0;  // bytes of texts in requests_
};

}  // namespace gs::app::script
