#pragma once

#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <string>

namespace gs::vrml {

/// Limits of memory and work for the events of a world. If a limit is reached, `problem` gets a message.
class EventBudget {
 public:
  static constexpr std::size_t kDelivery = 16;  // work elements of one delivered event

  explicit EventBudget(const SceneGraph& root) : root_(root), share_(root.budget(), Resource::nodes) {}

  /// Draws memory from the world's budget. Returns false if the budget has too little left.
  [[nodiscard]] bool afford(std::size_t bytes);
  /// Keeps `bytes` of the drawn memory for later calls of afford().
  void give_back(std::size_t bytes) { afforded_ -= bytes; }
  /// Counts work that grows with the content of files, in elements. Returns false if the limit per timestamp is
  /// reached; the caller must then omit the work.
  [[nodiscard]] bool spend(std::size_t elements);
  [[nodiscard]] bool has_room_for(std::size_t elements) const;
  /// Ends the events of the world for ever if the user wants its work to end (Budget::stopped()). Long loops without
  /// spend() call it. Returns is_halted().
  bool look();
  void halt() { halted_ = true; }
  /// Reports whether the events of the world have ended. spend() then always returns false.
  [[nodiscard]] bool is_halted() const { return halted_; }
  /// Begins a timestamp: the counted work becomes 0.
  void begin_timestamp() { work_ = 0; }
  /// Returns a message about what was omitted because of the limits; empty if nothing was omitted.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  const SceneGraph& root_;
  Share share_;
  std::size_t afforded_ = 0;
  std::size_t work_ = 0, unlooked_ = 0;  // elements; in this timestamp, and since the last look()
  bool halted_ = false;
  std::string problem_;
};

}  // namespace gs::vrml
