#include "qnv/codecs/gaussians/lod/splat_cache.h"

#include "base/parallel.h"
#include "qnv/codecs/gaussians/splat_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

namespace gs::qnv::gaussians {
namespace {

// Maximum number of clusters of a task, and usual number of tasks in a loop.
constexpr std::size_t kClustersPerTask = 8, kUsualTasks = 16;
// States of clusters may use 1 / kStatePart of the memory.
constexpr std::size_t kStatePart = 2;
// shrink() leaves 1 / kLeastStatePart of the memory to states, because views that become finer need them.
constexpr std::size_t kLeastStatePart = 4;
// Typical size of a state, in bytes.
constexpr std::size_t kTypicalState = 12'000;

std::size_t bytes_of(const Gaussians& all) {
  return sizeof(Gaussians) + all.size() * (3 * sizeof(glm::vec3) + sizeof(glm::vec4) + sizeof(float)) +
         all.harmonics.size() * sizeof(glm::vec3);
}

/// Returns the decoded form of a Gaussian of a block: computes the codes from the values.
SplatNode node_of_block(const Gaussians& all, std::size_t i, bool leaf) {
  SplatNode node;
  for (std::size_t k = 0; k < 3; ++k)
    node.scales[k] = static_cast<std::int16_t>(scale_code(double{all.scales[i][static_cast<int>(k)]}));
  node.opacity = static_cast<std::uint8_t>(opacity_code(double{all.opacities[i]}));
  node.leaf = leaf;
  return node;
}

/// Writes a decoded Gaussian, without the harmonics, normal and weight, which views do not need.
void put_splat(const SplatNode& node, const Precision& precision, Gaussians& all, std::size_t place) {
  const SplatLook look = look_of(node, precision);
  for (int k = 0; k < 3; ++k) all.scales[place][k] = static_cast<float>(look.scales[static_cast<std::size_t>(k)]);
  all.positions[place] = node.position;
  all.rotations[place] = node.rotation;
  all.opacities[place] = static_cast<float>(look.opacity);
  all.bases[place] = node.color;
}

}  // namespace

std::uint32_t SplatCache::received_harmonics(std::uint32_t cluster) const {
  std::uint32_t count = 0;
  for (std::uint32_t at = cluster; at != kNoCluster; at = tree_[at].parent)
    for (std::uint32_t i = tree_[at].harmonics; i != kNoCluster; i = tree_.harmonics(i).next)
      count += tree_.harmonics(i).present ? 1 : 0;
  return count;
}

void SplatCache::put_harmonics(std::uint32_t cluster, const Entry& own, Gaussians& splats) {
  const int degree = chunks_.header().gaussians.degree;
  const std::size_t per = harmonic_count(degree), inner = own.block.inner;
  std::vector<SplatNode> leaves, merged;
  for (std::size_t i = 0; i < splats.size(); ++i)
    if (i >= inner)
      leaves.push_back(node_of_block(splats, i, true));
    else if (!own.origins[i].unchanged)
      merged.push_back(node_of_block(splats, i, false));
  const ClusterHarmonics found = chunks_.decode_harmonics(cluster, leaves, merged);
  if (found.damaged) damaged_ = true;
  const Entry* const parent = entry(tree_[cluster].parent);
  const Gaussians* const above =
      parent && parent->block.splats && parent->block.splats->degree > 0 ? parent->block.splats.get() : nullptr;
  if (found.known_leaves.empty() && found.known_merged.empty() && !above) return;
  splats.degree = degree;
  splats.harmonics.assign(per * splats.size(), glm::vec3(0));
  std::size_t next_merged = 0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const bool leaf = i >= inner;
    const bool stays = !leaf && own.origins[i].unchanged;
    const std::size_t number = leaf ? i - inner : next_merged;
    if (!leaf && !stays) ++next_merged;
    const std::vector<bool>& known = leaf ? found.known_leaves : found.known_merged;
    const glm::vec3* from = nullptr;
    if (!stays && !known.empty() && known[number])
      from = (leaf ? found.leaves : found.merged).data() + per * number;
    else if (above)
      from = above->harmonics.data() + per * own.origins[i].parent;
    if (from) std::copy_n(from, per, splats.harmonics.begin() + static_cast<std::ptrdiff_t>(per * i));
  }
}

std::unique_ptr<SplatCache::Entry> SplatCache::made(std::uint32_t cluster, const DecodedCluster& decoded) {
  auto entry = std::make_unique<Entry>();
  const std::size_t count = decoded.nodes.size();
  const auto inner = static_cast<std::size_t>(std::ranges::count(decoded.nodes, false, &SplatNode::leaf));
  auto splats = std::make_shared<Gaussians>();
  splats->description.box = chunks_.header().description.box;  // renderers compare the distance to it
  splats->antialiased = chunks_.header().gaussians.antialiased;
  splats->positions.resize(count);
  splats->scales.resize(count);
  splats->rotations.resize(count);
  splats->opacities.resize(count);
  splats->bases.resize(count);
  entry->origins.resize(decoded.origins.size());
  if (inner > 0) entry->ranks.resize(count + 1);
  std::array<std::size_t, 2> next{0, inner};  // places of the next inner Gaussian and of the next leaf
  for (std::size_t i = 0; i < count; ++i) {
    const SplatNode& node = decoded.nodes[i];
    const std::size_t place = next[node.leaf ? 1 : 0]++;
    put_splat(node, chunks_.precision(), *splats, place);
    if (inner > 0) entry->ranks[i + 1] = static_cast<std::uint16_t>(next[0]);
    if (!decoded.origins.empty()) entry->origins[place] = decoded.origins[i];
  }
  entry->block.inner = static_cast<std::uint32_t>(inner);
  if (chunks_.header().gaussians.degree > 0) {
    entry->harmonics = received_harmonics(cluster);
    if (entry->harmonics > 0) put_harmonics(cluster, *entry, *splats);
  }
  entry->bytes = bytes_of(*splats) + sizeof(Entry) + entry->origins.size() * sizeof(NodeOrigin);
  entry->block.splats = std::move(splats);
  if (inner > 0) {
    entry->bytes += 2 * entry->ranks.size();
    std::vector<SplatNode> nodes;
    nodes.reserve(inner);
    std::ranges::copy_if(decoded.nodes, std::back_inserter(nodes), [](const SplatNode& node) { return !node.leaf; });
    entry->state = std::make_unique<const SplatState>(SplatState{std::move(nodes), StoredModels(decoded.models)});
    entry->state_bytes = entry->state->bytes();
  }
  return entry;
}

// Adds new harmonics to the decoded ancestors of clusters, because the clusters may inherit them.
void SplatCache::update_parents(std::span<const std::uint32_t> clusters) {
  if (chunks_.header().gaussians.degree == 0) return;
  std::vector<std::uint32_t> above;
  for (const std::uint32_t cluster : clusters)
    for (std::uint32_t i = tree_[cluster].parent; i != kNoCluster && has(i); i = tree_[i].parent) above.push_back(i);
  std::ranges::sort(above, [&](std::uint32_t a, std::uint32_t b) {
    return tree_[a].level != tree_[b].level ? tree_[a].level < tree_[b].level : a < b;
  });
  above.erase(std::unique(above.begin(), above.end()), above.end());
  add_harmonics(above);
}

void SplatCache::decode(std::vector<std::uint32_t> clusters, std::uint64_t now) {
  if (entries_.size() < tree_.size()) entries_.resize(tree_.size());
  std::ranges::sort(clusters, [&](std::uint32_t a, std::uint32_t b) {
    return tree_[a].level != tree_[b].level ? tree_[a].level < tree_[b].level : a < b;
  });
  update_parents(clusters);
  std::vector<std::unique_ptr<Entry>> results(clusters.size());
  const auto decode_one = [&](std::size_t i, DecodedCluster& decoded) {
    const SplatCluster& cluster = tree_[clusters[i]];
    const Entry* const parent = cluster.parent == kNoCluster ? nullptr : entry(cluster.parent);
    if (cluster.broken || (cluster.parent != kNoCluster && (!parent || !parent->state))) return;
    const auto above = parent ? std::optional(SplatParent{*parent->state, parent->ranks}) : std::nullopt;
    if (!chunks_.decode(clusters[i], above ? &*above : nullptr, decoded)) return;
    // The decoded children refer to Gaussians by index. Another chunk may have replaced the one from before.
    if (cluster.known && cluster.splats != decoded.nodes.size()) return;
    results[i] = made(clusters[i], decoded);
  };
  for (std::size_t first = 0, last = 0; first < clusters.size(); first = last) {
    while (last < clusters.size() && tree_[clusters[last]].level == tree_[clusters[first]].level) ++last;
    const std::size_t each = std::clamp<std::size_t>((last - first) / kUsualTasks, 1, kClustersPerTask);
    parallel_for((last - first + each - 1) / each, [&](std::size_t task) {
      const std::size_t begin = first + task * each, end = std::min(last, begin + each);
      const auto decoded = std::make_unique<DecodedCluster>();
      for (std::size_t i = begin; i < end; ++i) decode_one(i, *decoded);
    });
    const bool lacks = std::any_of(results.begin() + static_cast<std::ptrdiff_t>(first),
                                   results.begin() + static_cast<std::ptrdiff_t>(last), std::logical_not());
    if (lacks && chunks_.restore()) {
      const auto decoded = std::make_unique<DecodedCluster>();
      for (std::size_t i = first; i < last; ++i)
        if (!results[i]) decode_one(i, *decoded);
    }
    for (std::size_t i = first; i < last; ++i) {
      const bool orphan = tree_[clusters[i]].parent != kNoCluster && tree_[tree_[clusters[i]].parent].broken;
      if (results[i])
        keep(clusters[i], std::move(results[i]), now);
      else if (chunks_.repairing())
        chunks_.postpone(clusters[i]);
      else if (!tree_[clusters[i]].broken && !orphan)
        chunks_.reject(clusters[i], "a cluster of Gaussians is damaged and left out");
    }
  }
  if (damaged_.exchange(false)) (void)chunks_.restore();
}

// Stores a decoded cluster. Notes its bounds and sizes in the tree, which keeps them after the data is dropped.
void SplatCache::keep(std::uint32_t index, std::unique_ptr<Entry> made, std::uint64_t now) {
  drop(index);
  made->used = made->state_used = now;
  bytes_ += made->bytes + made->state_bytes;
  state_bytes_ += made->state_bytes;
  splats_ += made->block.splats->size();
  SplatCluster& cluster = tree_.at(index);
  if (!cluster.known) {
    const Gaussians& own = *made->block.splats;
    Box box;
    for (std::size_t i = 0; i < own.size(); ++i) {
      constexpr float kReach = 3.4f;  // standard deviations, up to an opacity of 1/255
      box.add(own.positions[i] - kReach * own.scales[i].x);
      box.add(own.positions[i] + kReach * own.scales[i].x);
      if (i >= made->block.inner) continue;
      cluster.inner_reach = std::max(cluster.inner_reach, own.scales[i].x);
      cluster.inner_size = std::max(cluster.inner_size, own.scales[i].x * std::sqrt(own.opacities[i]));
    }
    tree_.add_box(index, box);
    cluster.splats = static_cast<std::uint32_t>(own.size());
    cluster.known = true;
  }
  entries_[index] = std::move(made);
}

void SplatCache::size_up(std::uint32_t index) {
  SplatCluster& cluster = tree_.at(index);
  if (cluster.sized || cluster.parent == kNoCluster || !has(cluster.parent)) return;
  if (cluster.count == 0 && !(cluster.present && chunks_.read_head(index))) return;
  const Entry& parent = *entry(cluster.parent);
  const std::size_t first = cluster.first, last = first + cluster.count;
  const bool fits = last < parent.ranks.size();
  cluster.replaced_from = fits ? parent.ranks[first] : 0;
  cluster.replaced_to = fits ? parent.ranks[last] : 0;
  cluster.sized = true;
  const Gaussians& all = *parent.block.splats;
  // Rejects overlaps first. Then each Gaussian belongs to at most one child, so the loops below are short in total.
  if (!cover(cluster.parent, cluster.replaced_from, cluster.replaced_to)) {
    if (!cluster.broken) chunks_.reject(index, "a cluster replaces Gaussians of another one, or none");
    return;
  }
  for (std::size_t i = cluster.replaced_from; i < cluster.replaced_to; ++i) {
    cluster.reach = std::max(cluster.reach, all.scales[i].x);
    cluster.size = std::max(cluster.size, all.scales[i].x * std::sqrt(all.opacities[i]));
  }
}

bool SplatCache::cover(std::uint32_t parent, std::uint32_t from, std::uint32_t to) {
  if (from == to) return false;
  std::map<std::uint32_t, std::uint32_t>& ranges = covered_[parent];
  const auto next = ranges.lower_bound(to);  // the first range after this one
  if (next != ranges.begin() && std::prev(next)->second > from) return false;
  ranges.emplace_hint(next, from, to);
  return true;
}

void SplatCache::add_harmonics(std::span<const std::uint32_t> clusters) {
  if (chunks_.header().gaussians.degree == 0) return;
  std::vector<std::uint32_t> changed;
  for (const std::uint32_t i : clusters)
    if (has(i) && entries_[i]->harmonics < received_harmonics(i)) changed.push_back(i);
  // Gaussians inherit harmonics of their parents, so each level must be complete before the next one.
  for (std::size_t first = 0, last = 0; first < changed.size(); first = last) {
    while (last < changed.size() && tree_[changed[last]].level == tree_[changed[first]].level) ++last;
    std::vector<std::shared_ptr<Gaussians>> results(last - first);
    parallel_for((results.size() + kClustersPerTask - 1) / kClustersPerTask, [&](std::size_t task) {
      const std::size_t end = std::min(results.size(), (task + 1) * kClustersPerTask);
      for (std::size_t i = task * kClustersPerTask; i < end; ++i) {
        const std::uint32_t cluster = changed[first + i];
        results[i] = std::make_shared<Gaussians>(*block(cluster).splats);
        put_harmonics(cluster, *entries_[cluster], *results[i]);
      }
    });
    for (std::size_t i = 0; i < results.size(); ++i) {
      Entry& own = *entries_[changed[first + i]];
      own.harmonics = received_harmonics(changed[first + i]);
      const std::size_t more = bytes_of(*results[i]) - bytes_of(*own.block.splats);
      own.bytes += more;
      bytes_ += more;
      own.block.splats = std::move(results[i]);
    }
  }
}

std::size_t SplatCache::most_at_once() const {
  return std::max<std::size_t>(most_bytes_ / kStatePart / kTypicalState, 64);
}

void SplatCache::pin(std::uint32_t cluster, std::uint64_t now) {
  if (has(cluster)) entries_[cluster]->used = now;
}

void SplatCache::use_state(std::uint32_t cluster, std::uint64_t now) {
  if (has(cluster)) entries_[cluster]->state_used = now;
}

void SplatCache::drop_state(std::uint32_t cluster) {
  Entry& own = *entries_[cluster];
  bytes_ -= own.state_bytes;
  state_bytes_ -= std::exchange(own.state_bytes, 0);
  own.state = nullptr;
}

void SplatCache::drop(std::uint32_t cluster) {
  if (!has(cluster)) return;
  drop_state(cluster);
  bytes_ -= entries_[cluster]->bytes;
  splats_ -= entries_[cluster]->block.splats->size();
  entries_[cluster] = nullptr;
}

bool SplatCache::is_state_needed(std::uint32_t cluster) const {
  for (std::uint32_t child = tree_[cluster].first_child; child != kNoCluster; child = tree_[child].next_sibling)
    if (!has(child) && !tree_[child].broken) return true;
  return false;
}

void SplatCache::drop_states(std::size_t bytes) {
  const std::size_t most = state_bytes_ - std::min(bytes, state_bytes_);
  for (const bool needed : {false, true}) {
    if (state_bytes_ <= most) return;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> old;
    for (std::uint32_t i = 0; i < entries_.size(); ++i)
      if (has_state(i) && is_state_needed(i) == needed) old.emplace_back(entries_[i]->state_used, i);
    std::ranges::sort(old);
    for (const auto& [used, i] : old) {
      if (state_bytes_ <= most) return;
      drop_state(i);
    }
  }
}

void SplatCache::shrink_states() {
  const std::size_t most = most_bytes_ / kStatePart;
  // Frees more than necessary, so that the next cuts need not search again.
  if (state_bytes_ > most) drop_states(state_bytes_ - most / 4 * 3);
}

void SplatCache::shrink(std::uint64_t now) {
  shrink_states();
  if (bytes_ <= most_bytes_) return;
  // Frees states first: one has about twice the bytes of its cluster's Gaussians, and one decoding restores both.
  const std::size_t most = most_bytes_ / 8 * 7, least_states = most_bytes_ / kLeastStatePart;
  if (state_bytes_ > least_states) drop_states(std::min(bytes_ - most, state_bytes_ - least_states));
  if (bytes_ <= most_bytes_) return;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> old;
  for (std::uint32_t i = 0; i < entries_.size(); ++i)
    if (has(i) && entries_[i]->used != now) old.emplace_back(entries_[i]->used, i);
  std::ranges::sort(old);
  for (const auto& [used, i] : old) {
    if (bytes_ <= most) break;
    drop(i);
  }
}

}  // namespace gs::qnv::gaussians
