#include "base/budget.h"

#include <algorithm>

namespace gs {
namespace {

const ResourceRow& row_of(Resource resource) { return kResources[static_cast<std::size_t>(resource)]; }

// Checks that the table has the order of the enumeration.
static_assert([] {
  for (std::size_t i = 0; i < kResources.size(); ++i)
    if (static_cast<std::size_t>(kResources[i].resource) != i) return false;
  return true;
}());

std::uint64_t rest(std::uint64_t of, std::uint64_t spent) { return of > spent ? of - spent : 0; }

std::uint64_t part_of(std::size_t memory, unsigned share) { return memory / 32 * share; }

bool draw(std::atomic<std::uint64_t>& from, std::uint64_t amount, std::uint64_t limit) {
  std::uint64_t used = from.load(std::memory_order_relaxed);
  do {
    if (amount > limit || used > limit - amount) return false;
  } while (!from.compare_exchange_weak(used, used + amount, std::memory_order_relaxed));
  return true;
}

}  // namespace

std::uint64_t Budget::limit(Resource resource) const {
  return part_of(limits_.memory, row_of(resource).share) / row_of(resource).cost;
}

std::uint64_t Budget::used(Resource resource) const {
  return used_[static_cast<std::size_t>(resource)].load(std::memory_order_relaxed);
}

bool Budget::take(Resource resource, std::uint64_t amount) {
  auto& used = used_[static_cast<std::size_t>(resource)];
  if (!draw(used, amount, limit(resource))) return false;
  if (!row_of(resource).held || draw(held_, amount, part_of(limits_.memory, kHeldShare))) return true;
  used.fetch_sub(amount, std::memory_order_relaxed);
  return false;
}

void Budget::give_back(Resource resource, std::uint64_t amount) {
  used_[static_cast<std::size_t>(resource)].fetch_sub(amount, std::memory_order_relaxed);
  if (row_of(resource).held) held_.fetch_sub(amount, std::memory_order_relaxed);
}

std::uint64_t Budget::left(Resource resource) const {
  const std::uint64_t own = rest(limit(resource), used(resource));
  if (!row_of(resource).held) return own;
  return std::min(own, rest(part_of(limits_.memory, kHeldShare), held_.load(std::memory_order_relaxed)));
}

std::string Budget::refusal(Resource resource) const {
  constexpr std::uint64_t kMebi = std::uint64_t{1} << 20;
  const ResourceRow& row = row_of(resource);
  const std::uint64_t own = limit(resource), sum = part_of(limits_.memory, kHeldShare);
  // Selects the tighter limit: the limit for all held memory, or the limit of the resource.
  const bool all = row.held && left(resource) < rest(own, used(resource));
  const std::uint64_t most = all ? sum : own;
  const std::string name(all ? "memory in use" : row.name);
  const std::string size = row.cost > 1   ? std::to_string(most)
                           : most < kMebi ? std::to_string(most) + " bytes"
                                          : std::to_string(most / kMebi) + " MiB";
  return "more than the limit for " + name + ", " + size + " of one world (--memory raises it)";
}

}  // namespace gs
