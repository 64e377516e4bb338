#include "app/inspect/scene_index.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

constexpr double kBetween = 2;                         // min seconds between two rebuilds of the index
constexpr std::size_t kMaxTreeDepth = 100'000;             // max depth of the tree; texts have a far lower limit
constexpr std::size_t kMaxScenes = 0xffff;             // max number of scenes, because an entry stores 16 bits
constexpr std::size_t kDrawn = std::size_t{64} << 10;  // number of entries for which memory is charged at a time

char small(char letter) { return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter + 32) : letter; }

bool has_in_it(std::string_view text, std::string_view part) {
  return std::search(text.begin(), text.end(), part.begin(), part.end(),
                     [](char one, char sought) { return small(one) == sought; }) != text.end();
}

}  // namespace

void SceneIndex::set_world(const vrml::Execution* world) {
  world_ = world;
  begun_ = false;
  begin();
}

void SceneIndex::begin() {
  entries_ = {};
  scenes_.clear();
  scene_numbers_.clear();
  share_ = world_ ? Share(world_->scenes().root().budget(), Resource::nodes) : Share();
  way_.clear();
  depth_ = 0;
  walked_ = world_ == nullptr;
  cut_short_ = false;
  matches_.clear();
  fitting_types_.clear();
  scanned_ = 0;
  if (!world_) return;
  way_.resize(1);
  depth_ = 1;
}

std::uint64_t SceneIndex::revision() const {
  std::vector<const vrml::SceneGraph*> scenes{&world_->scenes().root()};
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    sum = sum * 31 + scenes[i]->nodes().revision();
    for (const auto& [place, content] : scenes[i]->inlines().all())
      if (content && world_->scenes().has(content.get())) scenes.push_back(content.get());
  }
  return sum;
}

bool SceneIndex::go_on(std::size_t work, double now) {
  if (!world_) return false;
  const std::uint64_t made_of = revision();
  const bool anew = begun_ && (made_of != made_of_ || stale_);
  if (!begun_ || (anew && now - begun_at_ >= kBetween)) {
    begin();
    begun_ = true;
    stale_ = false;
    begun_at_ = now;
    made_of_ = made_of;
  }
  if (!walked_) {
    // Values may have changed since the last call. Nodes of the path that no longer exist have no children.
    for (std::size_t i = 0; i < depth_; ++i)
      held_nodes(*world_, way_[i].entry == kNone ? NodeAt{} : node_of(way_[i].entry), way_[i].held);
    work -= std::min(work, walk(work));
  }
  work -= std::min(work, scan(work));
  return !walked_ || !searched();
}

std::uint32_t SceneIndex::entry_of(const NodeAt& node) const {
  const auto scene = scene_numbers_.find(node.scene);
  if (scene == scene_numbers_.end()) return kNone;
  const std::vector<std::uint32_t>& known = scenes_[scene->second].entries;
  const std::uint32_t found = node.id.index < known.size() ? known[node.id.index] : kNone;
  return found != kNone && entries_[found].id == node.id ? found : kNone;
}

// Adds a node to the index. Returns false if the node is in the index already, or if the budget is exhausted.
bool SceneIndex::enter(const NodeAt& node, std::uint32_t parent, std::uint16_t place, std::uint32_t element) {
  if (!is_in(*world_, node) || entry_of(node) != kNone) return false;
  if (entries_.size() % kDrawn == 0) {
    const std::size_t bytes = kDrawn * (2 * sizeof(Entry) + 2 * sizeof(std::uint32_t));
    if (!share_.grow(bytes)) cut_short_ = true;
  }
  const auto [number, fresh] =
      scene_numbers_.try_emplace(node.scene, static_cast<std::uint16_t>(std::min(scenes_.size(), kMaxScenes)));
  if (fresh && scenes_.size() < kMaxScenes) scenes_.push_back({node.scene, {}});
  if (number->second >= scenes_.size()) cut_short_ = true;
  if (cut_short_) return false;
  std::vector<std::uint32_t>& known = scenes_[number->second].entries;
  if (known.size() <= node.id.index)
    known.resize(std::max<std::size_t>(node.scene->nodes().count() + 1, node.id.index + 1), kNone);
  known[node.id.index] = static_cast<std::uint32_t>(entries_.size());
  entries_.push_back({node.id, parent, element, place, number->second});
  return true;
}

// Continues to visit the nodes in the order of the text. Returns the amount of work that was done.
std::size_t SceneIndex::walk(std::size_t work) {
  std::size_t done = 0;
  while (depth_ > 0 && done < work && !cut_short_) {
    ++done;
    Standing& top = way_[depth_ - 1];
    if (top.group >= top.held.size()) {
      --depth_;
      continue;
    }
    const HeldNodes& group = top.held[top.group];
    if (top.element >= group.nodes.size()) {
      ++top.group;
      top.element = 0;
      continue;
    }
    const auto element = static_cast<std::uint32_t>(top.element++);
    const NodeAt node{group.scene, group.nodes[element]};
    if (!node.id || !enter(node, top.entry, group.place, element) || depth_ >= kMaxTreeDepth) continue;
    const auto entry = static_cast<std::uint32_t>(entries_.size() - 1);
    if (way_.size() <= depth_) way_.resize(depth_ + 1);
    Standing& below = way_[depth_++];
    below.entry = entry;
    below.group = below.element = 0;
    held_nodes(*world_, node, below.held);
  }
  walked_ = depth_ == 0 || cut_short_;
  work_done_ += done;
  return done;
}

bool SceneIndex::fits(const NodeAt& at) {
  if (!is_in(*world_, at)) return false;
  const vrml::Node& node = at.scene->node(at.id);
  const auto [known, fresh] = fitting_types_.try_emplace(node.type, false);
  if (fresh) known->second = has_in_it(node.type->name, sought_);
  return known->second || has_in_it(node.name, sought_);
}

std::size_t SceneIndex::scan(std::size_t work) {
  if (sought_.empty()) scanned_ = entries_.size();
  std::size_t done = 0;
  for (; scanned_ < entries_.size() && done < work && matches_.size() < kMaxMatches; ++scanned_, ++done)
    if (fits(node_of(static_cast<std::uint32_t>(scanned_)))) matches_.push_back(static_cast<std::uint32_t>(scanned_));
  work_done_ += done;
  return done;
}

void SceneIndex::find(std::string_view text) {
  std::string wanted;
  for (const char letter : text) wanted += small(letter);
  if (wanted == sought_) return;
  sought_ = std::move(wanted);
  matches_.clear();
  fitting_types_.clear();
  scanned_ = 0;
}

bool SceneIndex::is_use(const NodeAt& node, const NodeAt& holder, std::uint16_t place, std::uint32_t element) const {
  const std::uint32_t found = entry_of(node);
  if (found == kNone) return false;
  const Entry& entry = entries_[found];
  const NodeAt first = entry.parent == kNone ? NodeAt{} : node_of(entry.parent);
  if (first == holder && entry.place == place && entry.element == element) return false;
  // A list can change although no node was added or removed.
  const bool stands = holds(first, entry, node);
  stale_ = stale_ || !stands;
  return stands;
}

bool SceneIndex::holds(const NodeAt& holder, const Entry& entry, const NodeAt& node) const {
  if (holder && !is_in(*world_, holder)) return false;
  held_nodes(*world_, holder, looked_at_);
  for (const HeldNodes& one : looked_at_)
    if (one.place == entry.place)
      return one.scene == node.scene && entry.element < one.nodes.size() && one.nodes[entry.element] == node.id;
  return false;
}

std::vector<HeldStep> SceneIndex::way_to(const NodeAt& node) const {
  std::vector<HeldStep> way;
  for (std::uint32_t at = entry_of(node); at != kNone; at = entries_[at].parent)
    way.push_back({entries_[at].place, entries_[at].element, node_of(at)});
  if (!std::all_of(way.begin(), way.end(), [&](const HeldStep& step) { return is_in(*world_, step.node); })) return {};
  std::reverse(way.begin(), way.end());
  return way;
}

}  // namespace gs::app
