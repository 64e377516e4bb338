#include "qnv/codecs/octree/lod/lod_cache.h"

#include "base/parallel.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace gs::qnv {
namespace {

// Minimum number of clusters for which decoding on several threads pays.
constexpr std::size_t kMinForThreads = 4;
// Maximum splats of shared arrays; larger arrays deserve their own buffer and draw call.
constexpr std::size_t kMaxShared = std::size_t{1} << 16;

std::size_t bytes_of(const PackedVoxels& voxels) {
  constexpr std::size_t kAVoxel = 3 * sizeof(std::uint16_t) + 2 * sizeof(std::int16_t) + 2, kColor = 6, kArrays = 512;
  return voxels.size() * (kAVoxel + (voxels.luma.empty() ? 0 : kColor)) + kArrays;
}

std::size_t bytes_of(const Splats& splats) {
  return splats.positions.capacity() * sizeof(glm::vec3) + splats.normals.capacity() * sizeof(glm::vec3) +
         splats.weights.capacity() * sizeof(float) + splats.cells.capacity() * sizeof(Cell) +
         splats.colors.capacity() * sizeof(Rgb8) + sizeof(Splats);
}

}  // namespace

// Clusters with the same parent. Their splats will share arrays.
struct LodCache::Family {
  std::span<const std::uint32_t> nodes;
  std::size_t discs = 0;
};

LodCache::Entry& LodCache::made_entry(std::uint32_t node) {
  if (entries_.size() < tree_.size()) entries_.resize(tree_.size());
  if (!entries_[node]) entries_[node] = std::make_unique<Entry>();
  return *entries_[node];
}

// Adds a decoded cluster to the tree. Returns the reason if it is rejected; otherwise an empty string.
std::string LodCache::take(std::uint32_t index, DecodedCluster decoded, std::uint64_t now) {
  if (!decoded.cluster) return std::move(decoded.problem);
  const LodNode& node = tree_[index];
  const ClusterHeader header = decoded.cluster->header;
  const PackedVoxels& voxels = decoded.cluster->voxels;
  if (!node.known) {
    if (node.parent != kNoNode) {
      std::vector<bool>& divided = entries_[node.parent]->divided;
      divided.resize(entries_[node.parent]->voxels->voxels.size());
      for (std::size_t i = header.first; i < std::size_t{header.first} + header.count; ++i)
        if (divided[i]) return "a cluster divides voxels of another cluster";
      std::fill_n(divided.begin() + header.first, header.count, true);
    }
    tree_.settle(index, {header.first, header.count, static_cast<std::uint32_t>(voxels.size()), decoded.discs,
                         decoded.replaced, decoded.cone});
    if (!node.boxed) tree_.set_box(index, box_of_run(voxels, node.level, 0, voxels.size(), header_.cube), true);
  } else if (voxels.size() != node.voxels || header.first != node.first || header.count != node.count) {
    return "a cluster differs from its earlier version";
  }
  Entry& entry = made_entry(index);
  entry.voxels = std::move(decoded.cluster);
  entry.used = now;
  entry.divided.clear();
  bytes_ += bytes_of(entry.voxels->voxels);
  for (std::uint32_t child = node.first_child; child != kNoNode; child = tree_[child].next_sibling) {
    const LodNode& c = tree_[child];
    if (c.known) {
      entry.divided.resize(entry.voxels->voxels.size());
      std::fill_n(entry.divided.begin() + c.first, c.count, true);
    }
    find_box(child);
  }
  return {};
}

void LodCache::find_box(std::uint32_t index) {
  const LodNode& node = tree_[index];
  if (node.boxed || node.parent == kNoNode || node.count == 0) return;
  const LodNode& parent = tree_[node.parent];
  if (!parent.known) return;
  const Entry* of = entry(node.parent);
  if (of && of->voxels && std::size_t{node.first} + node.count <= of->voxels->voxels.size())
    tree_.set_box(index, box_of_run(of->voxels->voxels, parent.level, node.first, node.count, header_.cube), true);
  else if (node.box.empty())
    tree_.set_box(index, parent.box, false);
}

void LodCache::decode(std::vector<std::uint32_t> nodes, std::uint64_t now) {
  std::stable_sort(nodes.begin(), nodes.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return tree_[a].level < tree_[b].level; });
  std::vector<DecodedCluster> decoded;
  const auto parent_of = [&](std::uint32_t node) -> const Cluster* {
    return tree_[node].parent == kNoNode ? nullptr : entries_[tree_[node].parent]->voxels.get();
  };
  for (std::size_t first = 0, last = 0; first < nodes.size(); first = last) {
    while (last < nodes.size() && tree_[nodes[last]].level == tree_[nodes[first]].level) ++last;
    // Decodes level by level. Skips clusters that lost their parent in the meantime.
    std::vector<std::uint32_t> wave;
    for (std::size_t i = first; i < last; ++i)
      if (tree_[nodes[i]].parent == kNoNode || has_voxels(tree_[nodes[i]].parent)) wave.push_back(nodes[i]);
    decoded.clear();
    decoded.resize(wave.size());
    (void)parallel_for(
        wave.size(), [&](std::size_t i) { decoded[i] = chunks_.decode(wave[i], parent_of(wave[i])); },
        wave.size() < kMinForThreads ? 1 : 0);
    for (std::size_t i = 0; i < wave.size(); ++i) {
      std::string problem = take(wave[i], std::move(decoded[i]), now);
      if (!problem.empty()) chunks_.reject(wave[i], std::move(problem));
    }
  }
}

std::unique_ptr<LodCache::Group> LodCache::make_group(const Family& family) const {
  auto group = std::make_unique<Group>();
  auto splats = std::make_shared<Splats>();
  splats->description.two_sided = header_.description.two_sided;
  splats->color = header_.color;
  splats->positions.reserve(family.discs);
  splats->normals.reserve(family.discs);
  splats->weights.reserve(family.discs);
  splats->cells.reserve(family.discs);
  for (const std::uint32_t node : family.nodes) {
    Entry& entry = *entries_[node];
    const PackedVoxels& voxels = entry.voxels->voxels;
    if (!voxels.luma.empty()) splats->colors.reserve(family.discs);
    entry.first_disc = splats->size();
    entry.disc_of.clear();
    if (tree_[node].discs != voxels.size()) {
      std::uint32_t next = 0;
      for (std::size_t i = 0; i < voxels.size(); ++i) {
        entry.disc_of.push_back(next);
        next += discs_of(voxels, i, 1);
      }
      entry.disc_of.push_back(next);
    }
    append_discs(*entry.voxels, 0, voxels.size(), header_.cube, *splats);
    group->members.push_back(node);
  }
  group->bytes = bytes_of(*splats);
  group->splats = std::move(splats);
  return group;
}

void LodCache::make_discs(std::vector<std::uint32_t> nodes, std::uint64_t now) {
  const auto place = [&](std::uint32_t i) { return std::tuple(tree_[i].parent, tree_[i].level, tree_[i].first, i); };
  std::sort(nodes.begin(), nodes.end(), [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
  std::vector<Family> families;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const LodNode& node = tree_[nodes[i]];
    const bool with_last = i > 0 && tree_[nodes[i - 1]].parent == node.parent &&
                           tree_[nodes[i - 1]].level == node.level && families.back().discs + node.discs <= kMaxShared;
    if (!with_last) families.push_back({std::span(nodes).subspan(i, 0), 0});
    Family& family = families.back();
    family.nodes = {family.nodes.data(), family.nodes.size() + 1};
    family.discs += node.discs;
  }
  std::vector<std::unique_ptr<Group>> made(families.size());
  (void)parallel_for(
      families.size(), [&](std::size_t i) { made[i] = make_group(families[i]); },
      families.size() < kMinForThreads ? 1 : 0);
  for (std::unique_ptr<Group>& group : made) {
    group->order = groups_made_++;
    group->used = now;
    bytes_ += group->bytes;
    disc_count_ += group->splats->size();
    for (const std::uint32_t node : group->members) {
      entries_[node]->discs = group.get();
      if (tree_[node].first_child == kNoNode && !chunks_.grows()) forget_voxels(node);
    }
    groups_.push_back(std::move(group));
  }
}

LodCache::Discs LodCache::discs(std::uint32_t node, std::size_t first_voxel, std::size_t last_voxel) const {
  const Entry& e = *entries_[node];
  const auto disc = [&](std::size_t voxel) { return e.first_disc + (e.disc_of.empty() ? voxel : e.disc_of[voxel]); };
  return {e.discs->order, e.discs->splats, disc(first_voxel), disc(last_voxel)};
}

void LodCache::use_voxels(std::uint32_t node, std::uint64_t now) {
  if (has_voxels(node)) entries_[node]->used = now;
}

void LodCache::use_discs(std::uint32_t node, std::uint64_t now) {
  if (has_discs(node)) entries_[node]->discs->used = now;
}

void LodCache::pin_discs(std::uint32_t node, std::uint64_t now) {
  if (has_discs(node)) entries_[node]->discs->pinned = now;
}

void LodCache::pin(std::uint32_t node, std::uint64_t now) {
  if (has_discs(node) && entries_[node]->discs->pinned == now) return;
  if (has_voxels(node))
    entries_[node]->pinned = now;
  else
    pin_discs(node, now);
}

void LodCache::forget_voxels(std::uint32_t node) {
  Entry& entry = *entries_[node];
  bytes_ -= bytes_of(entry.voxels->voxels);
  entry.voxels.reset();
  entry.divided = {};
  if (!entry.discs) entries_[node].reset();
}

void LodCache::forget_group(std::size_t index) {
  const std::unique_ptr<Group> group = std::move(groups_[index]);
  bytes_ -= group->bytes;
  disc_count_ -= group->splats->size();
  for (const std::uint32_t node : group->members) {
    // Skips a member that has newer splats in another group.
    if (!entries_[node] || entries_[node]->discs != group.get()) continue;
    entries_[node]->discs = nullptr;
    entries_[node]->disc_of = {};
    if (!entries_[node]->voxels) entries_[node].reset();
  }
}

void LodCache::shrink(std::uint64_t now) {
  if (bytes_ <= most_bytes_) return;
  struct Old {
    std::uint64_t used;
    bool is_group;
    std::size_t index;
  };
  std::vector<Old> old;
  for (std::size_t i = 0; i < groups_.size(); ++i)
    if (groups_[i]->pinned != now) old.push_back({groups_[i]->used, true, i});
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (entries_[i] && entries_[i]->voxels && entries_[i]->pinned != now) old.push_back({entries_[i]->used, false, i});
  std::sort(old.begin(), old.end(), [](const Old& a, const Old& b) { return a.used < b.used; });
  // Frees more than necessary, so that not every cut must free memory.
  const std::size_t enough = most_bytes_ - most_bytes_ / 8;
  for (const Old& item : old) {
    if (bytes_ <= enough) break;
    if (item.is_group)
      forget_group(item.index);
    else
      forget_voxels(static_cast<std::uint32_t>(item.index));
  }
  std::erase_if(groups_, [](const std::unique_ptr<Group>& group) { return !group; });
}

}  // namespace gs::qnv
