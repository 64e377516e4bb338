#include "app/inspect/scene_outline.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMoved = 64;  // max shift of an expanded line after children were added or removed before it

}  // namespace

void SceneOutline::set_world(const vrml::Execution* world, const SceneIndex* index) {
  world_ = world;
  index_ = index;
  top_ = {};
  refresh();
}

std::size_t SceneOutline::count_held(const NodeAt& node) const {
  held_nodes(*world_, node, held_);
  std::size_t sum = 0;
  for (const HeldNodes& one : held_) sum += one.nodes.size();
  work_done_ += 1 + held_.size();
  return sum;
}

// Returns the child at `number` among all children of a branch, as its group and its index there. Returns false if
// there are fewer children.
bool SceneOutline::held(const Branch& branch, std::size_t number, HeldNodes& group, std::size_t& element) const {
  held_nodes(*world_, branch.node, held_);
  work_done_ += 1 + held_.size();
  for (const HeldNodes& one : held_) {
    if (number < one.nodes.size()) {
      group = one;
      element = number;
      return true;
    }
    number -= one.nodes.size();
  }
  return false;
}

void SceneOutline::refresh() {
  if (world_)
    refresh(top_);
  else
    top_ = {};
}

// Updates a branch and, recursively, its expanded lines.
void SceneOutline::refresh(Branch& branch) {
  branch.own = branch.rows = count_held(branch.node);
  HeldNodes group;
  std::size_t element = 0;
  const auto stands_at = [&](std::size_t number, const Branch& one) {
    return number < branch.own && held(branch, number, group, element) &&
           NodeAt{group.scene, group.nodes[element]} == one.node;
  };
  for (auto one = branch.open.begin(); one != branch.open.end();) {
    const std::size_t before = one->first;
    std::optional<std::size_t> now;
    for (std::size_t by = 0; by <= kMoved && !now; ++by) {
      if (stands_at(before + by, *one->second))
        now = before + by;
      else if (by > 0 && by <= before && stands_at(before - by, *one->second))
        now = before - by;
    }
    if (now == before) {
      ++one;
      continue;
    }
    std::unique_ptr<Branch> moved = std::move(one->second);
    one = branch.open.erase(one);
    if (now) branch.open.try_emplace(*now, std::move(moved));
  }
  for (auto one = branch.open.begin(); one != branch.open.end();) {
    refresh(*one->second);
    branch.rows += one->second->rows;
    one = one->second->own == 0 ? branch.open.erase(one) : std::next(one);
  }
}

SceneOutline::Found SceneOutline::find(std::size_t index) const {
  Found found;
  Branch* at = &top_;
  std::size_t rest = index;
  found.way.push_back(at);
  while (true) {
    std::size_t before = 0;  // number of lines below the expanded siblings so far
    Branch* below = nullptr;
    for (auto& [number, one] : at->open) {
      ++work_done_;
      const std::size_t line = number + before;
      if (rest <= line) break;
      if (rest <= line + one->rows) {
        found.lines.push_back(index - rest + line);
        rest -= line + 1;
        below = one.get();
        break;
      }
      before += one->rows;
    }
    if (!below) {
      found.number = rest - before;
      break;
    }
    found.way.push_back(below);
    at = below;
  }
  if (!held(*at, found.number, found.group, found.element)) found.group = {};
  return found;
}

bool SceneOutline::is_use(const Found& found, const NodeAt& node) const {
  // A node inside itself must count as a USE, or the tree would be infinite.
  for (const Branch* const one : found.way)
    if (one->node == node) return true;
  return index_ &&
         index_->is_use(node, found.way.back()->node, found.group.place, static_cast<std::uint32_t>(found.element));
}

OutlineRow SceneOutline::row(std::size_t index) const {
  OutlineRow row;
  if (!world_ || index >= top_.rows) return row;
  const Found found = find(index);
  if (!found.group.scene) return row;
  row.node = {found.group.scene, found.group.nodes[found.element]};
  row.field = found.group.field;
  if (found.group.list) row.element = found.element;
  row.depth = found.way.size() - 1;
  if (!row.node) return row;
  row.use = is_use(found, row.node);
  row.open = found.way.back()->open.contains(found.number);
  row.can_open = row.open || (!row.use && row.depth < kMaxDepth && count_held(row.node) > 0);
  return row;
}

void SceneOutline::set_open(std::size_t index, bool open) {
  if (!world_ || index >= top_.rows) return;
  const Found found = find(index);
  if (!found.group.scene) return;
  Branch& at = *found.way.back();
  if (open == at.open.contains(found.number)) return;
  std::size_t rows = 0;
  if (open) {
    const OutlineRow line = row(index);
    if (!line.can_open) return;
    auto made = std::make_unique<Branch>();
    made->node = line.node;
    made->own = made->rows = rows = count_held(line.node);
    at.open[found.number] = std::move(made);
  } else {
    rows = at.open.at(found.number)->rows;
    at.open.erase(found.number);
  }
  for (Branch* const one : found.way) one->rows = open ? one->rows + rows : one->rows - rows;
}

std::optional<std::size_t> SceneOutline::holder(std::size_t index) const {
  if (!world_ || index >= top_.rows) return std::nullopt;
  const Found found = find(index);
  return found.lines.empty() ? std::nullopt : std::optional(found.lines.back());
}

std::optional<std::size_t> SceneOutline::reveal(std::span<const HeldStep> way) {
  if (!world_ || way.empty()) return std::nullopt;
  Branch* at = &top_;
  std::size_t line = 0;  // number of the first line below `at`
  for (std::size_t i = 0; i < way.size(); ++i) {
    held_nodes(*world_, at->node, held_);
    work_done_ += 1 + held_.size();
    std::optional<std::size_t> number;
    std::size_t before = 0;
    for (const HeldNodes& one : held_) {
      if (one.place == way[i].place && !number) {
        const auto stands_at = [&](std::size_t element) {
          return element < one.nodes.size() && NodeAt{one.scene, one.nodes[element]} == way[i].node;
        };
        for (std::size_t by = 0; by <= kMoved && !number; ++by) {
          if (stands_at(way[i].element + by))
            number = before + way[i].element + by;
          else if (by <= way[i].element && stands_at(way[i].element - by))
            number = before + way[i].element - by;
        }
      }
      before += one.nodes.size();
    }
    if (!number) return std::nullopt;
    line += *number;
    for (const auto& [open, one] : at->open) {
      if (open >= *number) break;
      line += one->rows;
    }
    if (i + 1 == way.size()) return line;
    if (!at->open.contains(*number)) set_open(line, true);
    const auto below = at->open.find(*number);
    if (below == at->open.end()) return std::nullopt;
    at = below->second.get();
    ++line;
  }
  return std::nullopt;
}

}  // namespace gs::app
