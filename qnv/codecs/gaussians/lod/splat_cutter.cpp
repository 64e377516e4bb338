#include "qnv/codecs/gaussians/lod/splat_cutter.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <unordered_set>
#include <utility>

namespace gs::qnv::gaussians {
namespace {

constexpr std::size_t kMaxWanted = 4096;
// Gaussians are fine enough if their deviation in the picture, times the root of the opacity, is at most this. Applies
// to an error of one pixel. The renderer widens all Gaussians by about half a pixel.
constexpr float kSmallPixels = 0.5f;
// Hysteresis: dividing the size of clusters in the last cut by this factor prefers them to new clusters.
constexpr float kGivenUp = 0.7f;
// Increase of the priority of clusters in the last cut, if the view is identical.
constexpr float kStays = 1e30f;
// Maximum number of clusters that are decoded before their Gaussians are counted.
constexpr std::size_t kMostClustersAtOnce = 512;
// Maximum number of Gaussians that a cut decodes: kMostBudgets times its largest budget, at least
// kLeastDecodedSplats.
constexpr std::size_t kMostBudgets = 4, kLeastDecodedSplats = std::size_t{1} << 22;
// Maximum number of decoding rounds in a cut. Each round goes one level deeper.
constexpr int kMaxRounds = 64;
// Duration of a change of the cut, in seconds.
constexpr double kFadeSeconds = 0.25;
// At most 1 / kFadingPart of the cut may fade at the same time. Other changes are immediate.
constexpr std::size_t kFadingPart = 2;
constexpr std::size_t kLeastFading = 20'000;
// Estimated size of the inner Gaussians of a missing cluster, relative to those that it replaces. Usually too low.
constexpr float kAheadSize = 0.3f;
// Reach of a Gaussian, in standard deviations.
constexpr float kSeenReach = 3.5f;

float distance_to(const Box& box, const glm::vec3& p) {
  glm::vec3 d(0);
  for (int i = 0; i < 3; ++i) d[i] = std::max({box.lower[i] - p[i], p[i] - box.upper[i], 0.0f});
  return std::sqrt(glm::dot(d, d));
}

// Enlarges a box at the faces where the box of the stream clips it, because that box bounds centres only.
Box unclipped(Box box, float reach, const Box& stream) {
  const glm::vec3 margin = stream.size() * 1e-4f;
  for (int i = 0; i < 3; ++i) {
    if (box.lower[i] <= stream.lower[i] + margin[i]) box.lower[i] -= reach;
    if (box.upper[i] >= stream.upper[i] - margin[i]) box.upper[i] += reach;
  }
  return box;
}

struct SplatCandidate {
  float key;  // priority: size in the picture, pixels
  std::uint32_t cluster;
  bool operator<(const SplatCandidate& other) const {
    return key != other.key ? key < other.key : cluster > other.cluster;
  }
};

/// Cluster with a missing parent, and the estimated size and reach of the Gaussians that it replaces.
struct SplatGuess {
  SplatCandidate candidate;
  float size, reach;
  bool operator<(const SplatGuess& other) const { return candidate < other.candidate; }
};

// Reports whether Gaussians of a cluster may be visible. The box of a cluster is exact after decoding.
bool is_visible(const SplatCluster& cluster, const LodView& view) {
  return !cluster.known || !cluster.boxed || !outside(cluster.box, view);
}

bool same_view(LodView a, LodView b) {
  a.most_decoded = b.most_decoded;
  a.each_chunk = b.each_chunk;
  return a == b;
}

}  // namespace

const std::vector<SplatRun>& SplatCutter::cut(const LodView& view, std::optional<double> time, bool fades) {
  ++cuts_;
  decoded_ = 0;
  pending_ = fading_ = false;
  // Cuts with a time must not block until a file is read.
  chunks_.set_waiting(!time);
  if (chunks_.repairing()) (void)chunks_.restore();
  const std::size_t slot = viewport_of(view.viewport);
  const auto bit = static_cast<std::uint16_t>(1u << slot);
  Viewport& viewport = viewports_[slot];
  const bool same = viewport.last_cut != 0 && viewport.complete && viewport.revision == chunks_.revision() &&
                    viewport.fading.empty() && same_view(viewport.view, view);
  if (same || tree_.root() == kNoCluster) {
    viewport.view = view;
    viewport.last_cut = cuts_;
    if (time) viewport.time = *time;
    return viewport.runs;
  }
  const std::vector<std::uint32_t> before = viewport.chosen;
  const std::size_t most_held = cache_.splats() + std::max(kMostBudgets * most_splats_, kLeastDecodedSplats);
  for (int round = 0; round < kMaxRounds && !pending_; ++round) {
    select(view, viewport, bit);
    bool any = false;
    for (bool limited = true; limited && !pending_;) {
      std::vector<std::uint32_t> clusters = to_decode(view, limited);
      if (clusters.empty()) break;
      any = true;
      cache_.decode(std::move(clusters), cuts_);
      cache_.shrink_states();
      // Small chunks may claim few Gaussians and have many. Later cuts know their numbers, and decode the others.
      pending_ = pending_ || cache_.splats() > most_held;
    }
    if (!any) break;
  }
  choose(view, viewport, bit);
  fade(view, viewport, before, bit, time, fades);
  make_runs(view, viewport);
  viewport.view = view;
  viewport.complete = !pending_;
  viewport.last_cut = cuts_;
  viewport.revision = chunks_.revision();
  keep_cuts();
  return viewport.runs;
}

// Frees decoded data until the limit is met. Keeps the data of the last cut of each viewport.
void SplatCutter::keep_cuts() {
  for (const Viewport& each : viewports_) {
    for (const std::uint32_t cluster : each.chosen) cache_.pin(cluster, cuts_);
    for (const auto& [cluster, weight] : each.fading) cache_.pin(cluster, cuts_);
  }
  cache_.shrink(cuts_);
}

// Returns the slot of a viewport. A new viewport gets the least recently used slot.
std::size_t SplatCutter::viewport_of(std::uint32_t id) {
  std::size_t oldest = 0;
  for (std::size_t i = 0; i < kViewports; ++i) {
    if (viewports_[i].last_cut != 0 && viewports_[i].view.viewport == id) return i;
    if (viewports_[i].last_cut < viewports_[oldest].last_cut) oldest = i;
  }
  forget_slot(oldest);
  return oldest;
}

void SplatCutter::forget_slot(std::size_t slot) {
  const auto others = static_cast<std::uint16_t>(~(1u << slot));
  for (const std::uint32_t cluster : viewports_[slot].chosen) tree_.at(cluster).marks.chosen_by &= others;
  viewports_[slot] = {};
}

void SplatCutter::forget(std::uint32_t viewport) {
  for (std::size_t i = 0; i < kViewports; ++i)
    if (viewports_[i].last_cut != 0 && viewports_[i].view.viewport == viewport) forget_slot(i);
}

std::vector<ChunkRange> SplatCutter::lacking_for_all() const {
  std::vector<ChunkRange> all;
  std::unordered_set<std::uint64_t> seen;
  for (std::size_t i = 0, most = 1; i < most; ++i)
    for (const Viewport& viewport : viewports_) {
      most = std::max(most, viewport.lacking.size());
      if (i >= viewport.lacking.size()) continue;
      const Lack& lack = viewport.lacking[i];
      const bool present = lack.harmonics ? tree_.harmonics(lack.index).present : tree_[lack.index].present;
      const ChunkRange range = lack.harmonics
                                   ? ChunkRange{tree_.harmonics(lack.index).offset, tree_.harmonics(lack.index).bytes}
                                   : ChunkRange{tree_[lack.index].offset, tree_[lack.index].bytes};
      if (!present && seen.insert(range.offset).second) all.push_back(range);
    }
  return all;
}

std::vector<LodView> SplatCutter::views() const {
  std::vector<LodView> all;
  for (const Viewport& viewport : viewports_)
    if (viewport.last_cut != 0) all.push_back(viewport.view);
  return all;
}

std::int64_t SplatCutter::budget_of(const LodView& view) const {
  return static_cast<std::int64_t>(view.budget == 0 ? most_splats_ : std::min(view.budget, most_splats_));
}

// Returns the number of Gaussians that a cluster adds to a cut, less those that it replaces.
std::int64_t SplatCutter::gained(std::uint32_t index) const {
  const SplatCluster& cluster = tree_[index];
  std::int64_t more = cluster.marks.visible ? cluster.splats : 0;
  if (cluster.parent != kNoCluster && tree_[cluster.parent].marks.visible && cluster.sized)
    more -= cluster.replaced_to - cluster.replaced_from;
  return more;
}

// Returns the size in the picture of the Gaussians that a cluster replaces, in pixels. Until these are known,
// uses all inner Gaussians of the parent.
float SplatCutter::key_of(const SplatCluster& cluster, const LodView& view) const {
  const SplatCluster& parent = tree_[cluster.parent];
  const float size = cluster.sized ? cluster.size : parent.inner_size,
              reach = cluster.sized ? cluster.reach : parent.inner_reach;
  const float distance = cluster.boxed ? distance_to(cluster.box, view.eye) : 0.0f;
  const float key = size * view.pixels / std::max(distance, std::max(reach, 1e-30f));
  return std::isfinite(key) ? key : 0;
}

// Adds descendants of missing clusters to `lacking` if the view will probably need them. So deep levels need few round
// trips, and requested chunks are often next to each other in the stream.
void SplatCutter::look_ahead(const LodView& view, Viewport& viewport) const {
  std::priority_queue<SplatGuess> guesses;
  const auto add_children = [&](const SplatCluster& cluster, float size, float reach) {
    for (std::uint32_t child = cluster.first_child; child != kNoCluster; child = tree_[child].next_sibling) {
      const SplatCluster& c = tree_[child];
      if (c.present || c.broken || !c.boxed || outside(c.box, view)) continue;
      const float key = size * view.pixels / std::max(distance_to(c.box, view.eye), std::max(reach, 1e-30f));
      if (key > kSmallPixels * view.error_pixels) guesses.push({{key, child}, kAheadSize * size, kAheadSize * reach});
    }
  };
  std::int64_t left = budget_of(view);
  for (const std::uint32_t index : order_) {
    const SplatCluster& cluster = tree_[index];
    left -= gained(index);
    if (cluster.present || cluster.broken || cluster.parent == kNoCluster) continue;
    const SplatCluster& parent = tree_[cluster.parent];
    add_children(cluster, kAheadSize * (cluster.sized ? cluster.size : parent.inner_size),
                 kAheadSize * (cluster.sized ? cluster.reach : parent.inner_reach));
  }
  while (!guesses.empty() && viewport.lacking.size() < kMaxWanted) {
    const SplatGuess guess = guesses.top();
    guesses.pop();
    const SplatCluster& cluster = tree_[guess.candidate.cluster];
    left -= cluster.splats;
    if (left < 0) break;
    viewport.lacking.push_back({guess.candidate.cluster, false});
    add_children(cluster, guess.size, guess.reach);
  }
}

// Selects the clusters that the view needs, including those that are not yet decoded or received. Sorts the clusters
// by size in the picture; a parent precedes its children.
void SplatCutter::select(const LodView& view, const Viewport& last, std::uint16_t bit) {
  const bool same = last.last_cut != 0 && last.revision == chunks_.revision() && same_view(last.view, view);
  const std::int64_t budget = budget_of(view);
  std::priority_queue<SplatCandidate> candidates;
  candidates.push({std::numeric_limits<float>::infinity(), tree_.root()});
  order_.clear();
  std::int64_t splats = 0;
  while (!candidates.empty()) {
    const std::uint32_t index = candidates.top().cluster;
    if (!order_.empty() && !(candidates.top().key > kSmallPixels * view.error_pixels)) break;
    candidates.pop();
    SplatCluster& cluster = tree_.at(index);
    if (cluster.broken) continue;
    cluster.marks.visible = is_visible(cluster, view);
    cluster.marks.ready = false;
    const std::int64_t more = gained(index);
    if (!order_.empty() && splats + more > budget) break;
    splats += more;
    order_.push_back(index);
    if (!cluster.known) continue;
    for (std::uint32_t child = cluster.first_child; child != kNoCluster; child = tree_[child].next_sibling) {
      const SplatCluster& c = tree_[child];
      const float reach = kSeenReach * (c.sized ? c.reach : cluster.inner_reach);
      if (c.broken || (c.boxed && outside(unclipped(c.box, reach, chunks_.header().description.box), view))) continue;
      cache_.size_up(child);
      if (c.broken) continue;
      float key = key_of(c, view);
      if ((c.marks.chosen_by & bit) != 0) key = same ? key + kStays : key / kGivenUp;
      candidates.push({key, child});
    }
  }
}

// Returns the clusters to decode next, most important first, within the view's limits. Marks clusters as ready if they
// are decoded or in the result. Sets `limited` if more must wait for another call, because of their memory.
std::vector<std::uint32_t> SplatCutter::to_decode(const LodView& view, bool& limited) {
  std::vector<std::uint32_t> clusters, chain;
  std::vector<bool> marked;
  const std::size_t most_at_once = std::min(cache_.most_at_once(), kMostClustersAtOnce);
  bool more = true;
  limited = false;
  const auto is_marked = [&](std::uint32_t cluster) { return cluster < marked.size() && marked[cluster]; };
  for (const std::uint32_t index : order_) {
    const SplatCluster& cluster = tree_[index];
    bool& ready = tree_.at(index).marks.ready;
    ready = false;  // it may be broken since the previous call, so that its children cannot be decoded
    if (!cluster.present || cluster.broken || cluster.waits ||
        (cluster.parent != kNoCluster && !tree_[cluster.parent].marks.ready))
      continue;
    ready = cache_.has(index);
    if (ready) {
      cache_.use_state(index, cuts_);
      continue;
    }
    if (!more) continue;
    // Includes ancestors if the cache has freed their states.
    chain.assign(1, index);
    std::size_t sum = std::max<std::size_t>(cluster.splats, cluster.bytes / 8);
    for (std::uint32_t above = cluster.parent; above != kNoCluster && !cache_.has_state(above) && !is_marked(above);
         above = tree_[above].parent) {
      chain.push_back(above);
      sum += tree_[above].splats;
    }
    if (view.most_decoded != 0 && decoded_ > 0 && decoded_ + sum > view.most_decoded) {
      more = false;
      pending_ = true;
      continue;
    }
    if (!clusters.empty() && clusters.size() + chain.size() > most_at_once) {
      limited = true;
      more = false;
      continue;
    }
    decoded_ += sum;
    ready = true;
    marked.resize(tree_.size());
    for (const std::uint32_t i : chain) marked[i] = true;
    clusters.insert(clusters.end(), chain.begin(), chain.end());
  }
  return clusters;
}

// Chooses the selected clusters that are decoded, within the budget.
void SplatCutter::choose(const LodView& view, Viewport& viewport, std::uint16_t bit) {
  for (const std::uint32_t cluster : viewport.chosen)
    tree_.at(cluster).marks.chosen_by &= static_cast<std::uint16_t>(~bit);
  viewport.chosen.clear();
  viewport.lacking.clear();
  std::int64_t splats = 0;
  for (const std::uint32_t index : order_) {
    SplatCluster& cluster = tree_.at(index);
    const bool above = cluster.parent == kNoCluster || (tree_[cluster.parent].marks.chosen_by & bit) != 0;
    if (!cluster.present && !cluster.broken && viewport.lacking.size() < kMaxWanted)
      viewport.lacking.push_back({index, false});
    if (!cluster.present || !above || cluster.broken) continue;
    if (!cache_.has(index)) {
      pending_ = pending_ || !cluster.waits;  // the revision reports the end of a repair
      continue;
    }
    cache_.size_up(index);  // its parent may be decoded only since the selection
    if (cluster.broken) continue;
    cluster.marks.chosen_by |= bit;
    viewport.chosen.push_back(index);
    splats += gained(index);
  }
  // Drops clusters from the end if estimates were too low. The last cluster never has chosen children.
  while (splats > budget_of(view) && viewport.chosen.size() > 1) {
    const std::uint32_t last = viewport.chosen.back();
    splats -= gained(last);
    tree_.at(last).marks.chosen_by &= static_cast<std::uint16_t>(~bit);
    viewport.chosen.pop_back();
  }
  look_ahead(view, viewport);
  for (const std::uint32_t index : viewport.chosen)
    for (std::uint32_t i = tree_[index].harmonics; i != kNoCluster; i = tree_.harmonics(i).next)
      if (!tree_.harmonics(i).present && tree_[index].marks.visible && viewport.lacking.size() < kMaxWanted)
        viewport.lacking.push_back({i, true});
}

// Updates the weights of clusters that enter or leave the cut. `before` has the clusters of the previous cut. Without a
// time, or if `fades` is false, changes are immediate.
void SplatCutter::fade(const LodView& view, Viewport& viewport, std::span<const std::uint32_t> before,
                       std::uint16_t bit, std::optional<double> time, bool fades) {
  if (!time || !fades || viewport.last_cut == 0) {
    viewport.fading.clear();
    viewport.time = time.value_or(0);
    return;
  }
  const auto step = static_cast<float>(std::clamp((*time - viewport.time) / kFadeSeconds, 0.0, 1.0));
  viewport.time = *time;
  const auto is_chosen = [&](std::uint32_t cluster) { return (tree_[cluster].marks.chosen_by & bit) != 0; };
  std::unordered_map<std::uint32_t, float>& fading = viewport.fading;
  // Clusters that enter the cut start with the weight 0, and clusters that leave it with 1.
  std::unordered_set<std::uint32_t> known(before.begin(), before.end());
  for (const std::uint32_t cluster : before)
    if (!is_chosen(cluster)) fading.try_emplace(cluster, 1.0f);
  for (const std::uint32_t cluster : viewport.chosen)
    if (!known.contains(cluster)) fading.try_emplace(cluster, 0.0f);
  std::size_t count = 0;
  std::vector<std::pair<float, std::uint32_t>> moving;
  for (auto one = fading.begin(); one != fading.end();) {
    const bool in = is_chosen(one->first);
    one->second += in ? step : -step;
    const bool over = in ? one->second >= 1 : one->second <= 0;
    if (over || !cache_.has(one->first)) {
      one = fading.erase(one);
      continue;
    }
    const SplatCluster& cluster = tree_[one->first];
    count += cluster.splats;
    moving.emplace_back(cluster.parent == kNoCluster ? std::numeric_limits<float>::infinity() : key_of(cluster, view),
                        one->first);
    ++one;
  }
  // If there are too many changes, the smallest ones are immediate. Children are smaller than their parents.
  std::size_t most = 0;
  for (const std::uint32_t cluster : viewport.chosen) most += tree_[cluster].splats;
  most = std::max(most / kFadingPart, kLeastFading);
  std::ranges::sort(moving);
  for (std::size_t i = 0; i < moving.size() && count > most; ++i) {
    count -= tree_[moving[i].second].splats;
    fading.erase(moving[i].second);
  }
  fading_ = !fading.empty();
}

// Returns the clusters with Gaussians in the picture, parents before children.
std::vector<std::uint32_t> SplatCutter::drawn(const Viewport& viewport) const {
  std::vector<std::uint32_t> all = viewport.chosen;
  std::unordered_set<std::uint32_t> chosen;
  if (!viewport.fading.empty()) chosen.insert(all.begin(), all.end());
  for (const auto& [cluster, weight] : viewport.fading)
    if (!chosen.contains(cluster)) all.push_back(cluster);
  std::ranges::sort(all, [&](std::uint32_t a, std::uint32_t b) {
    return tree_[a].level != tree_[b].level ? tree_[a].level < tree_[b].level : a < b;
  });
  return all;
}

// Makes runs of the Gaussians that children do not replace completely.
void SplatCutter::make_runs(const LodView& view, Viewport& viewport) {
  const std::vector<std::uint32_t> all = drawn(viewport);
  cache_.add_harmonics(all);
  for (const std::uint32_t index : all) {
    SplatMarks& marks = tree_.at(index).marks;
    marks.visible = is_visible(tree_[index], view);
    const auto fading = viewport.fading.find(index);
    marks.weight = fading == viewport.fading.end() ? 1.0f : fading->second;
    const std::uint32_t parent = tree_[index].parent;
    marks.presence = marks.weight * (parent == kNoCluster ? 1.0f : tree_[parent].marks.presence);
  }
  struct Part {
    std::uint32_t first, last;
    float weight;
  };
  viewport.runs.clear();
  std::vector<Part> parts;
  for (const std::uint32_t index : all) {
    const SplatCluster& cluster = tree_[index];
    if (!(cluster.marks.presence > 0) || !cluster.marks.visible) continue;
    const SplatCache::Block& block = cache_.block(index);
    parts.clear();
    for (std::uint32_t child = cluster.first_child; child != kNoCluster; child = tree_[child].next_sibling)
      if (tree_[child].marks.weight > 0)
        parts.push_back({tree_[child].replaced_from, tree_[child].replaced_to, tree_[child].marks.weight});
    std::ranges::sort(parts, {}, &Part::first);
    const auto add = [&](std::uint32_t first, std::uint32_t last, float presence) {
      if (first >= last || !(presence > 0)) return;
      const bool joins = !viewport.runs.empty() && viewport.runs.back().splats == block.splats &&
                         viewport.runs.back().first + viewport.runs.back().count == first &&
                         viewport.runs.back().presence == presence;
      if (joins)
        viewport.runs.back().count += last - first;
      else
        viewport.runs.push_back({block.splats, first, last - first, presence});
    };
    std::uint32_t next = 0;
    for (const Part& part : parts) {
      add(next, part.first, cluster.marks.presence);
      add(part.first, part.last, cluster.marks.presence * (1 - part.weight));
      next = std::max(next, part.last);
    }
    add(next, static_cast<std::uint32_t>(block.splats->size()), cluster.marks.presence);
  }
  for (const std::uint32_t index : all) tree_.at(index).marks.weight = tree_.at(index).marks.presence = 0;
}

}  // namespace gs::qnv::gaussians
