#include "vrml/scene/scene_memory.h"

#include <algorithm>
#include <utility>

namespace gs::vrml {

SceneMemory::SceneMemory(std::shared_ptr<Budget> budget)
    : budget_(std::move(budget)),
      nodes_share_(budget_, Resource::nodes),
      instances_share_(budget_, Resource::instances) {}

bool SceneMemory::draw(std::size_t bytes) {
  constexpr std::size_t kStep = std::size_t{64} << 10;  // bytes drawn at a time, because threads share the counter
  if (exhausted_) return false;
  const std::size_t wanted = charged_ + bytes;
  if (wanted > nodes_share_.amount()) {
    const std::size_t missing = wanted - nodes_share_.amount();
    exhausted_ = !nodes_share_.grow(std::max(missing, kStep)) && !nodes_share_.grow(missing);
    if (exhausted_) return false;
  }
  charged_ = wanted;
  return true;
}

bool SceneMemory::reserve_expansion(std::size_t count, std::size_t bytes) {
  if (count > budget_->limits().expanded_nodes - expanded_nodes_ || !instances_share_.grow(bytes)) return false;
  expanded_nodes_ += count;
  if (account_) {
    account_->expanded_nodes += count;
    account_->expanded_bytes += bytes;
  }
  return true;
}

void SceneMemory::give_back(const TextAccount& account) {
  charged_ -= account.charged;
  expanded_nodes_ -= account.expanded_nodes;
  instances_share_.shrink_to(instances_share_.amount() - account.expanded_bytes);
  constexpr std::size_t kSpare = std::size_t{1} << 20;
  if (nodes_share_.amount() > charged_ + kSpare) nodes_share_.shrink_to(charged_);
  exhausted_ = false;
}

}  // namespace gs::vrml
