#pragma once

#include "base/budget.h"

#include <cstddef>
#include <memory>

namespace gs::vrml {

/// Amounts that one text of a scene has drawn.
struct TextAccount {
  std::size_t charged = 0;  // bytes drawn, except indices and values of nodes, which are used again
  std::size_t expanded_nodes = 0, expanded_bytes = 0;
};

/// Memory and copies of PROTO instances that a scene draws from the budget of its world. One thread.
class SceneMemory {
 public:
  explicit SceneMemory(std::shared_ptr<Budget> budget);

  /// Draws memory for names, lists and similar data from the budget. Returns false if the budget is exhausted. After
  /// that, the scene never draws more.
  [[nodiscard]] bool charge(std::size_t bytes) {
    if (!draw(bytes)) return false;
    if (account_) account_->charged += bytes;
    return true;
  }
  /// Draws memory that is used again and stays drawn: indices and values of nodes.
  [[nodiscard]] bool draw(std::size_t bytes);
  /// Counts `count` more nodes with `bytes` bytes as copies for PROTO instances. Returns false if the limit is reached.
  [[nodiscard]] bool reserve_expansion(std::size_t count, std::size_t bytes);
  /// Returns the bytes drawn from the budget.
  [[nodiscard]] std::size_t charged() const { return charged_; }
  /// Reports whether something was omitted because the budget for nodes was exhausted.
  [[nodiscard]] bool exhausted() const { return exhausted_; }

  /// Sets the account of the text for which nodes are made; null for the file, which has none.
  void set_account(TextAccount* account) { account_ = account; }
  /// Gives back everything that a text has drawn.
  void give_back(const TextAccount& account);
  [[nodiscard]] const std::shared_ptr<Budget>& budget() const { return budget_; }

 private:
  std::shared_ptr<Budget> budget_;
  Share nodes_share_, instances_share_;
  TextAccount* account_ = nullptr;
  std::size_t charged_ = 0;  // used part of nodes_share_
  std::size_t expanded_nodes_ = 0;
  bool exhausted_ = false;
};

}  // namespace gs::vrml
