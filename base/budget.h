#pragma once

#include "base/limits.h"
#include "base/noncopyable.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace gs {

/// Limits of a world, the amounts used of them, and the world's cancellation check. Before each allocation with a size
/// that a file determines, code must charge the memory to the budget. Thread-safe, except for `stop_when`.
class Budget : NonCopyable {
 public:
  explicit Budget(const Limits& limits = {}) : limits_(limits) {}

  [[nodiscard]] const Limits& limits() const { return limits_; }
  /// Charges `amount` units. Returns false and charges nothing if fewer are left.
  [[nodiscard]] bool take(Resource resource, std::uint64_t amount);
  void give_back(Resource resource, std::uint64_t amount);
  /// Returns the unused units of a resource. limit() returns all units, used() the used ones.
  [[nodiscard]] std::uint64_t left(Resource resource) const;
  [[nodiscard]] std::uint64_t limit(Resource resource) const;
  [[nodiscard]] std::uint64_t used(Resource resource) const;
  /// Returns the reason for a refusal: "more than the limit for meshes, 1024 MiB of one world (--memory raises it)".
  /// Names the limit for all held memory instead if that limit is the tighter one.
  [[nodiscard]] std::string refusal(Resource resource) const;

  /// Reserves `count` generations for NodeIds, unique in the world, and returns the first. The numbers start again
  /// after 2^32 generations. Only an id that is stored for so long could name a wrong node.
  [[nodiscard]] std::uint32_t draw_generations(std::uint32_t count) {
    return generations_.fetch_add(count, std::memory_order_relaxed);
  }

  /// Sets the check that cancels work for the world, for example on timeout; null means that work is never cancelled.
  /// Call it only while no other thread works for the world. Long loops call `stopped` at least ten times a second.
  void stop_when(std::function<bool()> stop) { stop_ = std::move(stop); }
  [[nodiscard]] bool stopped() const { return stop_ && stop_(); }

 private:
  Limits limits_;
  std::array<std::atomic<std::uint64_t>, kResources.size()> used_{};
  std::atomic<std::uint64_t> held_ = 0;
  std::atomic<std::uint32_t> generations_ = 1;
  std::function<bool()> stop_;
};

/// Amount charged to a budget for one object, given back on destruction.
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

  /// Charges more to the budget. Returns false and charges nothing if the budget has less left. Without a budget,
  /// always returns true.
  [[nodiscard]] bool grow(std::uint64_t amount) {
    if (budget_ && !budget_->take(resource_, amount)) return false;
    amount_ += amount;
    return true;
  }
  /// Gives back the excess over `amount`.
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

/// Budget that all parts of one world share; never null.
using WorldBudget = std::shared_ptr<Budget>;

/// Returns a budget for a file that is read alone.
[[nodiscard]] inline WorldBudget own_budget() { return std::make_shared<Budget>(); }

}  // namespace gs
