#pragma once

#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <string>

namespace gs::vrml {

/// Memory and work that the events of a world may take. Both end with a message in `problem`.
class EventBudget {
 public:
  static constexpr std::size_t kDelivery = 16;  // work elements counted per delivered event

  explicit EventBudget(const SceneGraph& root) : root_(root), share_(root.budget(), Resource::nodes) {}

  /// Draws memory from the world's budget.
  [[nodiscard]] bool afford(std::size_t bytes);
  /// Keeps `bytes` of the drawn memory for later use.
  void give_back(std::size_t bytes) { afforded_ -= bytes; }
  /// Counts work that grows with file content, in elements. Returns false if the limit per timestamp is reached; the
  /// caller must then skip the work.
  [[nodiscard]] bool spend(std::size_t elements);
  [[nodiscard]] bool has_room_for(std::size_t elements) const;
  /// Begins a timestamp, with no work done.
  void begin_timestamp() { work_ = 0; }
  /// Returns a message about what the limits excluded; empty if nothing was.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  const SceneGraph& root_;
  Share share_;
  std::size_t afforded_ = 0;
  std::size_t work_ = 0;
  std::string problem_;
};

}  // namespace gs::vrml
