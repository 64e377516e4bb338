#include "qnv/codecs/octree/lod/lod_cutter.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <tuple>
#include <unordered_set>
#include <utility>

namespace gs::qnv {
namespace {

constexpr std::size_t kMaxWanted = 4096;
// Hysteresis: the screen size of clusters in the last cut is divided by this, which prefers them to new clusters.
constexpr float kGivenUp = 0.7f;
// Increase of the priority of clusters in the last cut, if the view is identical.
constexpr float kStays = 1e30f;
// Maximum number of decoding rounds in a cut. Each round goes one level deeper, if the decoded clusters change the
// choice.
constexpr int kMaxRounds = 24;
// Angles in radians, for culling. The first is the assumed maximum turn of a cluster's normals relative to its
// parent's, because the cluster is not decoded yet. The second is a margin for rounding errors.
constexpr float kFinerTurn = 0.3f, kTurnMargin = 0.01f;

/// Enlarges a box by one voxel edge, because splats extend beyond their voxels.
Box grown(const Box& box, float edge) { return {box.lower - edge, box.upper + edge}; }

float distance_to(const Box& box, const glm::vec3& p) {
  glm::vec3 d(0);
  for (int i = 0; i < 3; ++i) d[i] = std::max({box.lower[i] - p[i], p[i] - box.upper[i], 0.0f});
  return std::sqrt(glm::dot(d, d));
}

// Reports whether `eye` is behind every splat in the box: dot(normal, position - eye) > 0 for all normals in the cone.
// Normals may turn by `margin` more, in radians.
bool faces_away(const NormalCone& cone, const Box& box, const glm::vec3& eye, float margin) {
  if (!(cone.cosine > 0)) return false;
  const glm::vec3 to = box.lower * 0.5f + box.upper * 0.5f - eye, half = box.size() * 0.5f;
  const float radius = std::sqrt(glm::dot(half, half)), distance = std::sqrt(glm::dot(to, to));
  if (!(distance > radius)) return false;
  const float along = glm::dot(cone.axis, to) / distance;
  if (!(along > 0)) return false;
  const float turned =
      std::acos(std::min(along, 1.0f)) + std::acos(std::min(cone.cosine, 1.0f)) + std::asin(radius / distance) + margin;
  return turned < std::numbers::pi_v<float> / 2;
}

struct Candidate {
  float key;  // priority: size on the screen, pixels
  std::uint32_t node;
  bool operator<(const Candidate& other) const { return key != other.key ? key < other.key : node > other.node; }
};

bool same_view(LodView a, LodView b) {
  a.most_decoded = b.most_decoded;
  a.each_chunk = b.each_chunk;
  return a == b;
}

// Returns the approximate cost of decoding a cluster. Its bytes give a lower bound, so that a directory cannot claim
// too few voxels.
std::size_t cost(const LodNode& node) { return std::max<std::size_t>(node.voxels, node.bytes / 8); }

}  // namespace

std::vector<Piece> LodCutter::cut(const LodView& view) {
  ++cuts_;
  decoded_ = 0;
  pending_ = false;
  lacking_.clear();
  order_.clear();
  if (tree_.root() == kNoNode) return {};
  const std::size_t slot = viewport_of(view.viewport);
  const auto bit = static_cast<std::uint16_t>(1u << slot);
  Viewport& viewport = viewports_[slot];
  for (int round = 0; round < kMaxRounds; ++round) {
    select(view, viewport, bit);
    std::vector<std::uint32_t> nodes = to_decode(view);
    if (nodes.empty()) break;
    cache_.decode(std::move(nodes), cuts_);
    if (pending_) break;
  }
  choose(view, viewport, bit);
  for (const std::uint32_t node : viewport.lacking) lacking_.push_back({tree_[node].offset, tree_[node].bytes});
  viewport.view = view;
  viewport.last_cut = cuts_;
  viewport.revision = chunks_.revision();
  const std::vector<Run> drawn = runs(viewport, bit);
  std::vector<std::uint32_t> missing;
  for (const std::uint32_t node : viewport.shown)
    if (!cache_.has_discs(node)) missing.push_back(node);
  for (const std::uint32_t node : viewport.chosen) cache_.use_voxels(node, cuts_);
  cache_.make_discs(std::move(missing), cuts_);
  for (const std::uint32_t node : viewport.shown) cache_.use_discs(node, cuts_);
  std::vector<Piece> out = pieces(view, drawn);
  keep_cuts();
  return out;
}

// Frees decoded data that no viewport's last cut needs, down to the limit.
void LodCutter::keep_cuts() {
  for (const Viewport& each : viewports_) {
    for (const std::uint32_t node : each.shown) cache_.pin_discs(node, cuts_);
    for (const std::uint32_t node : each.chosen) cache_.pin(node, cuts_);
  }
  cache_.shrink(cuts_);
}

// Returns the slot of a viewport. A new viewport gets the slot that was unused for longest.
std::size_t LodCutter::viewport_of(std::uint32_t id) {
  std::size_t oldest = 0;
  for (std::size_t i = 0; i < kViewports; ++i) {
    if (viewports_[i].last_cut != 0 && viewports_[i].view.viewport == id) return i;
    if (viewports_[i].last_cut < viewports_[oldest].last_cut) oldest = i;
  }
  forget_slot(oldest);
  return oldest;
}

void LodCutter::forget_slot(std::size_t slot) {
  const auto others = static_cast<std::uint16_t>(~(1u << slot));
  for (const std::uint32_t node : viewports_[slot].chosen) tree_.marks(node).chosen_by &= others;
  viewports_[slot] = {};
}

void LodCutter::forget(std::uint32_t viewport) {
  for (std::size_t i = 0; i < kViewports; ++i)
    if (viewports_[i].last_cut != 0 && viewports_[i].view.viewport == viewport) forget_slot(i);
}

std::vector<ChunkRange> LodCutter::lacking_for_all() const {
  std::vector<ChunkRange> all;
  std::unordered_set<std::uint32_t> seen;
  for (std::size_t i = 0, most = 1; i < most; ++i)
    for (const Viewport& viewport : viewports_) {
      most = std::max(most, viewport.lacking.size());
      if (i >= viewport.lacking.size()) continue;
      const LodNode& node = tree_[viewport.lacking[i]];
      if (!node.present && seen.insert(viewport.lacking[i]).second) all.push_back({node.offset, node.bytes});
    }
  return all;
}

std::vector<LodView> LodCutter::views() const {
  std::vector<LodView> all;
  for (const Viewport& viewport : viewports_)
    if (viewport.last_cut != 0) all.push_back(viewport.view);
  return all;
}

// Returns the change of a cut's number of splats if this node is added.
std::int64_t LodCutter::discs_gained(std::uint32_t index) const {
  const LodNode& node = tree_[index];
  std::int64_t gained = node.marks.visible ? (node.known ? node.discs : node.voxels) : 0;
  if (node.parent != kNoNode && tree_[node.parent].marks.visible)
    gained -= node.known ? node.replaced : (node.count > 0 ? node.count : node.voxels / kTypicalChildren);
  return gained;
}

// Selects the clusters that the view needs, even clusters that are not decoded or not received yet. Sorts the clusters
// by size on the screen; a parent precedes its children.
void LodCutter::select(const LodView& view, const Viewport& last, std::uint16_t bit) {
  const bool same = last.last_cut != 0 && last.revision == chunks_.revision() && same_view(last.view, view);
  const bool backs_left_out = view.leave_backs && !chunks_.header().description.two_sided;
  const auto budget = static_cast<std::int64_t>(view.budget == 0 ? most_discs_ : std::min(view.budget, most_discs_));
  std::priority_queue<Candidate> candidates;
  candidates.push({std::numeric_limits<float>::infinity(), tree_.root()});
  order_.clear();
  std::int64_t discs = 0;
  while (!candidates.empty()) {
    const std::uint32_t index = candidates.top().node;
    if (!order_.empty() && !(candidates.top().key > view.error_pixels)) break;
    candidates.pop();
    const LodNode& node = tree_[index];
    if (node.broken) continue;
    CutMarks& marks = tree_.marks(index);
    const float edge = chunks_.header().cube.edge / static_cast<float>(1 << node.level);
    const Box reach = grown(node.box, edge);
    marks.visible = node.box.empty() || !outside(reach, view);
    if (marks.visible && backs_left_out && node.known)
      marks.visible = !faces_away(node.cone, reach, view.eye, kTurnMargin);
    const std::int64_t more = discs_gained(index);
    if (!order_.empty() && discs + more > budget) break;
    discs += more;
    marks.ready = false;
    order_.push_back(index);
    for (std::uint32_t child = node.first_child; child != kNoNode; child = tree_[child].next_sibling) {
      const LodNode& c = tree_[child];
      if (c.broken || (!c.boxed && !node.known)) continue;
      const Box around = grown(c.box, edge);
      if (outside(around, view)) continue;
      if (backs_left_out && node.known && faces_away(node.cone, around, view.eye, kFinerTurn)) continue;
      float key = edge * view.pixels / std::max(distance_to(c.box, view.eye), edge);
      if (!std::isfinite(key)) key = 0;
      if ((c.marks.chosen_by & bit) != 0) key = same ? key + kStays : key / kGivenUp;
      candidates.push({key, child});
    }
  }
}

// Returns the clusters to decode next, most important first, within the view's limits. Marks clusters as ready if they
// are decoded or in the result.
std::vector<std::uint32_t> LodCutter::to_decode(const LodView& view) {
  std::vector<std::uint32_t> nodes, chain;
  std::vector<bool> marked;
  bool more = true;
  const auto is_marked = [&](std::uint32_t node) { return node < marked.size() && marked[node]; };
  for (const std::uint32_t index : order_) {
    const LodNode& node = tree_[index];
    if (!node.present || (node.parent != kNoNode && !tree_[node.parent].marks.ready)) continue;
    bool& ready = tree_.marks(index).ready;
    ready = cache_.has(index);
    if (ready || !more) continue;
    // Includes ancestors if the cache has freed their voxels.
    chain.assign(1, index);
    std::size_t sum = cost(node);
    for (std::uint32_t above = node.parent; above != kNoNode && !cache_.has_voxels(above) && !is_marked(above);
         above = tree_[above].parent) {
      chain.push_back(above);
      sum += cost(tree_[above]);
    }
    if (view.most_decoded != 0 && decoded_ > 0 && decoded_ + sum > view.most_decoded) {
      more = false;
      pending_ = true;
      continue;
    }
    decoded_ += sum;
    ready = true;
    marked.resize(tree_.size());
    for (const std::uint32_t i : chain) marked[i] = true;
    nodes.insert(nodes.end(), chain.begin(), chain.end());
  }
  return nodes;
}

// Chooses the selected clusters that are decoded, within the budget of splats.
void LodCutter::choose(const LodView& view, Viewport& viewport, std::uint16_t bit) {
  for (const std::uint32_t node : viewport.chosen) tree_.marks(node).chosen_by &= static_cast<std::uint16_t>(~bit);
  viewport.chosen.clear();
  viewport.lacking.clear();
  std::int64_t discs = 0;
  for (const std::uint32_t index : order_) {
    const LodNode& node = tree_[index];
    const bool above = node.parent == kNoNode || (tree_[node.parent].marks.chosen_by & bit) != 0;
    if (!node.present && !node.broken && viewport.lacking.size() < kMaxWanted) viewport.lacking.push_back(index);
    if (node.present && above && !node.broken && !cache_.has(index)) pending_ = true;
    if (!node.present || !above || node.broken || !cache_.has(index)) continue;
    tree_.marks(index).chosen_by |= bit;
    viewport.chosen.push_back(index);
    discs += discs_gained(index);
  }
  const auto budget = static_cast<std::int64_t>(view.budget == 0 ? most_discs_ : std::min(view.budget, most_discs_));
  // Drops clusters from the end if estimates were too low. The last cluster has no chosen children.
  while (discs > budget && viewport.chosen.size() > 1) {
    const std::uint32_t last = viewport.chosen.back();
    discs -= discs_gained(last);
    tree_.marks(last).chosen_by &= static_cast<std::uint16_t>(~bit);
    viewport.chosen.pop_back();
  }
}

// Returns the runs of voxels that no chosen child of their cluster replaces.
std::vector<LodCutter::Run> LodCutter::runs(Viewport& viewport, std::uint16_t bit) const {
  std::vector<Run> out;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> taken;
  viewport.shown.clear();
  for (const std::uint32_t index : viewport.chosen) {
    const LodNode& node = tree_[index];
    if (!node.marks.visible) continue;
    taken.clear();
    for (std::uint32_t child = node.first_child; child != kNoNode; child = tree_[child].next_sibling) {
      const LodNode& c = tree_[child];
      if ((c.marks.chosen_by & bit) != 0) taken.emplace_back(c.first, std::uint32_t{c.first} + c.count);
    }
    std::sort(taken.begin(), taken.end());
    taken.emplace_back(node.voxels, node.voxels);
    const std::size_t before = out.size();
    std::uint32_t next = 0;
    for (const auto& [first, last] : taken) {
      if (next < first) out.push_back({index, next, first});
      next = std::max(next, last);
    }
    if (out.size() > before) viewport.shown.push_back(index);
  }
  return out;
}

std::vector<Piece> LodCutter::pieces(const LodView& view, std::span<const Run> drawn) const {
  std::vector<std::pair<LodCache::Discs, std::uint32_t>> places;
  places.reserve(drawn.size());
  for (const Run& run : drawn) places.emplace_back(cache_.discs(run.node, run.first, run.last), run.node);
  // Sorts the runs by position in their shared splats, to join adjacent runs.
  std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.first.order, a.first.first) < std::tuple(b.first.order, b.first.first);
  });
  std::vector<Piece> out;
  for (const auto& [discs, node] : places) {
    const std::size_t count = discs.last - discs.first;
    const bool joins = !out.empty() && out.back().splats == discs.splats &&
                       out.back().first + out.back().count == discs.first &&
                       (!view.each_chunk || out.back().chunk == node);
    if (joins)
      out.back().count += count;
    else if (count > 0)
      out.push_back({discs.splats, discs.first, count, tree_[node].level, node, tree_.age(node)});
  }
  return out;
}

}  // namespace gs::qnv
