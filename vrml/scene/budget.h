#pragma once

#include "vrml/scene/limits.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace gs::vrml {

/// What one world has spent of its limits, and whether work for it should go on. Every allocation whose size a file
/// chooses is drawn from here first. Any thread, but for `stop_when`.
class Budget {
 public:
  explicit Budget(const Limits& limits = {}) : limits_(limits) {}
  Budget(const Budget&) = delete;
  Budget& operator=(const Budget&) = delete;

  [[nodiscard]] const Limits& limits() const { return limits_; }
  /// Draws `amount` units; false, and nothing is drawn, where there are not so many left.
  [[nodiscard]] bool take(Resource resource, std::uint64_t amount);
  void give_back(Resource resource, std::uint64_t amount);
  /// Units that can still be drawn; of all, and so far.
  [[nodiscard]] std::uint64_t left(Resource resource) const;
  [[nodiscard]] std::uint64_t limit(Resource resource) const;
  [[nodiscard]] std::uint64_t used(Resource resource) const;
  /// Why more cannot be drawn: "more than the limit for meshes, 1024 MiB of one world (--memory raises it)"; where
  /// there is enough of that, the limit for all that is held.
  [[nodiscard]] std::string refusal(Resource resource) const;

  /// The first of `count` numbers that no other node of the world has got, for the generations of NodeIds. They begin
  /// anew behind 2^32, where only an id that was kept all the while could be taken for another.
  [[nodiscard]] std::uint32_t take_generations(std::uint32_t count) {
    return generations_.fetch_add(count, std::memory_order_relaxed);
  }

  /// Work for the world is given up when this says so: the time is over, or somebody has cancelled it. Null: never.
  /// Not while other threads work for the world. Long loops ask `stopped` at least ten times a second.
  void stop_when(std::function<bool()> stop) { stop_ = std::move(stop); }
  [[nodiscard]] bool stopped() const { return stop_ && stop_(); }

 private:
  Limits limits_;
  std::array<std::atomic<std::uint64_t>, kResources.size()> used_{};
  std::atomic<std::uint64_t> held_ = 0;
  std::atomic<std::uint32_t> generations_ = 1;
  std::function<bool()> stop_;
};

/// What was drawn from a budget for something, given back with it.
class Share {
 public:
  Share() = default;
  Share(std::shared_ptr<Budget> budget, Resource resource) : budget_(std::move(budget)), resource_(resource) {}
  Share(Share&& other) noexcept
      : budget_(std::move(other.budget_)), resource_(other.resource_), amount_(std::exchange(other.amount_, 0)) {}
  Share& operator=(Share&& other) noexcept {
    std::swap(budget_, other.budget_);
    std::swap(resource_, other.resource_);
    std::swap(amount_, other.amount_);
    return *this;
  }
  ~Share() {
    if (budget_ && amount_ > 0) budget_->give_back(resource_, amount_);
  }

  /// Draws more; false, and nothing is drawn, where there is not so much left. True where there is no budget.
  [[nodiscard]] bool grow(std::uint64_t amount) {
    if (budget_ && !budget_->take(resource_, amount)) return false;
    amount_ += amount;
    return true;
  }
  /// Gives back all but `amount`.
  void shrink_to(std::uint64_t amount) {
    if (amount >= amount_) return;
    if (budget_) budget_->give_back(resource_, amount_ - amount);
    amount_ = amount;
  }
  [[nodiscard]] std::uint64_t amount() const { return amount_; }

 private:
  std::shared_ptr<Budget> budget_;
  Resource resource_ = Resource::files;
  std::uint64_t amount_ = 0;
};

}  // namespace gs::vrml
