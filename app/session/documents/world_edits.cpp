#include "app/session/documents/world_edits.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace gs::app {
namespace {

bool is_same_field(const WorldEdit& one, const WorldEdit& other) {
  return one.scene == other.scene && one.node == other.node && one.field == other.field;
}

void put(std::vector<WorldEdit>& edits, const WorldEdit& edit) {
  const auto known =
      std::find_if(edits.begin(), edits.end(), [&](const WorldEdit& one) { return is_same_field(one, edit); });
  if (known == edits.end())
    edits.push_back(edit);
  else
    known->after = edit.after;
}

constexpr std::size_t kLost = std::numeric_limits<std::size_t>::max();

}  // namespace

void WorldEdits::note(WorldEdit edit) {
  undone_.clear();
  const bool continues = !done_.empty() && edit.gesture != 0 && done_.back().gesture == edit.gesture &&
                         is_same_field(done_.back(), edit) && saved_ != done_.size();
  if (continues) {
    done_.back().after = std::move(edit.after);
    return;
  }
  if (saved_ != kLost && saved_ > done_.size()) saved_ = kLost;
  if (done_.size() >= kMaxUndone) {
    put(settled_, done_.front());
    done_.erase(done_.begin());
    saved_ = saved_ == 0 || saved_ == kLost ? kLost : saved_ - 1;
  }
  done_.push_back(std::move(edit));
}

std::optional<WorldEdit> WorldEdits::go(int direction) {
  std::vector<WorldEdit>&from = direction < 0 ? done_ : undone_, &to = direction < 0 ? undone_ : done_;
  if (from.empty()) return std::nullopt;
  to.push_back(std::move(from.back()));
  from.pop_back();
  return to.back();
}

std::optional<double> WorldEdits::time_of(int direction) const {
  const std::vector<WorldEdit>& edits = direction < 0 ? done_ : undone_;
  return edits.empty() ? std::nullopt : std::optional(edits.back().time);
}

std::vector<WorldEdit> WorldEdits::latest() const {
  std::vector<WorldEdit> edits = settled_;
  for (const WorldEdit& one : done_) put(edits, one);
  return edits;
}

}  // namespace gs::app
