#include "qnv/codecs/gaussians/decode/splat_forest.h"

#include "qnv/codecs/gaussians/harmonics_code.h"

#include <algorithm>
#include <array>
#include <deque>
#include <utility>

namespace gs::qnv::gaussians {
namespace {

// Approximate memory of a waiting chunk besides its payload.
constexpr std::size_t kWaitingBytes = 128;

}  // namespace

void SplatForest::wait(Waiting& waiting, std::uint32_t cluster, std::span<const std::byte> payload) {
  if (waiting_bytes_ + payload.size() + kWaitingBytes > kMostWaitingBytes) {
    ++count_.refused;
    return;
  }
  waiting_bytes_ += payload.size() + kWaitingBytes;
  waiting.emplace(cluster, std::vector<std::byte>(payload.begin(), payload.end()));
}

std::vector<std::vector<std::byte>> SplatForest::take_waiting(Waiting& waiting, std::uint32_t cluster) {
  std::vector<std::vector<std::byte>> ready;
  const auto [first, last] = waiting.equal_range(cluster);
  for (auto i = first; i != last; ++i) {
    waiting_bytes_ -= i->second.size() + kWaitingBytes;
    ready.push_back(std::move(i->second));
  }
  waiting.erase(first, last);
  return ready;
}

std::vector<SplatNode> SplatForest::parents_of(const ClusterHead& head, const HeldCluster* parent) const {
  if (!parent) return rooted_ ? std::vector<SplatNode>{} : std::vector<SplatNode>{root_node(precision_.box)};
  if (head.level != parent->level + 1 || std::size_t{head.first} + head.count > parent->nodes.size()) return {};
  for (std::size_t i = 0; i < head.count; ++i)
    if (parent->replaced[head.first + i]) return {};
  const auto first = parent->nodes.begin() + head.first;
  return {first, first + head.count};
}

void SplatForest::add_cluster(std::span<const std::byte> payload) {
  std::deque<std::vector<std::byte>> ready;  // clusters that waited, and then those that wait for them
  std::vector<std::byte> current;
  for (std::span<const std::byte> next = payload;;) {
    const auto packed = parse_cluster(next);
    HeldCluster* parent = nullptr;
    bool usable = packed && !clusters_.contains(packed->head.id), early = false;
    if (usable && packed->head.parent != ClusterHead::kNoParent) {
      const auto found = clusters_.find(packed->head.parent);
      early = found == clusters_.end();
      if (!early) parent = &found->second;
    }
    if (usable && early) {
      wait(waiting_, packed->head.parent, next);
    } else if (usable) {
      const std::vector<SplatNode> parents = parents_of(packed->head, parent);
      SplatModels models(precision_.trained());
      if (parent && parent->models) parent->models->load(models);
      std::vector<NodeOrigin> origins;
      std::vector<SplatNode> nodes;
      const bool decoded = !parents.empty() && !(parent && !parent->models) &&
                           decode_nodes(packed->bytes, parents, parent != nullptr, models, precision_, nodes,
                                        degree_ > 0 ? &origins : nullptr);
      const std::size_t size = nodes.size();
      // Replaced Gaussians stay in memory, because other clusters may replace the rest of their cluster.
      const bool full = decoded && (shown_ + size > most_ || (nodes_ + size) / 2 > most_);
      count_.full = count_.full || full;
      if (!decoded || full) {
        if (!full) ++count_.refused;
      } else {
        ++count_.taken;
        if (parent) {
          for (std::size_t i = packed->head.first; i < packed->head.first + packed->head.count; ++i) {
            if (parent->nodes[i].leaf) continue;
            parent->replaced[i] = true;
            --parent->inner;
            --shown_;
          }
          if (parent->inner == 0) parent->models.reset();
        } else {
          rooted_ = true;
        }
        HeldCluster& held = clusters_[packed->head.id];
        held.inner = static_cast<std::size_t>(std::ranges::count(nodes, false, &SplatNode::leaf));
        held.level = packed->head.level;
        held.parent = packed->head.parent;
        for (NodeOrigin& origin : origins)
          origin.parent = static_cast<std::uint16_t>(origin.parent + packed->head.first);
        held.origins = std::move(origins);
        held.nodes = std::move(nodes);
        held.replaced.resize(size);
        if (held.inner > 0) held.models.emplace(models);
        shown_ += size;
        nodes_ += size;
        for (auto& waited : take_waiting(waiting_, packed->head.id)) ready.push_back(std::move(waited));
        for (const auto& waited : take_waiting(waiting_harmonics_, packed->head.id)) add_harmonics(waited, false);
        for (const auto& waited : take_waiting(waiting_coarse_, packed->head.id)) add_harmonics(waited, true);
      }
    } else {
      ++count_.refused;
    }
    if (ready.empty()) return;
    current = std::move(ready.front());
    ready.pop_front();
    next = current;
  }
}

void SplatForest::add_harmonics(std::span<const std::byte> payload, bool coarse) {
  const auto packed = parse_harmonics(payload);
  if (!packed || degree_ == 0) {
    ++count_.refused;
    return;
  }
  const auto found = clusters_.find(packed->head.cluster);
  if (found == clusters_.end())
    return wait(coarse ? waiting_coarse_ : waiting_harmonics_, packed->head.cluster, payload);
  HeldCluster& held = found->second;
  std::vector<std::size_t> nodes;
  for (std::size_t i = 0; i < held.nodes.size(); ++i)
    if (held.nodes[i].leaf != coarse && !held.origins[i].unchanged) nodes.push_back(i);
  const std::size_t per = harmonic_count(degree_), first = packed->head.first, last = first + packed->head.count;
  if (last > nodes.size()) {
    ++count_.refused;
    return;
  }
  Reader reader{BinaryDecoder(packed->bytes)};
  HarmonicModels models;
  std::array<std::array<int, 3>, harmonic_count(Gaussians::kMaxDegree)> codes{};
  std::vector<glm::vec3> coefficients;
  std::vector<bool> own;  // other Gaussians inherit those of an ancestor
  for (std::size_t i = first; i < last; ++i) {
    own.push_back(code_harmonics(reader, models, degree_, codes) || !coarse);
    if (reader.coder.exhausted()) break;
    const double step = harmonic_step(held.nodes[nodes[i]], precision_);
    for (std::size_t k = 0; k < per; ++k) coefficients.push_back(glm::vec3(rgb_of(codes[k], step)));
  }
  if (coefficients.size() != per * packed->head.count) {
    ++count_.refused;
    return;
  }
  held.harmonics.resize(per * held.nodes.size());
  held.known.resize(held.nodes.size());
  for (std::size_t i = first; i < last; ++i) {
    std::copy_n(coefficients.begin() + static_cast<std::ptrdiff_t>(per * (i - first)), per,
                held.harmonics.begin() + static_cast<std::ptrdiff_t>(per * nodes[i]));
    held.known[nodes[i]] = own[i - first];
  }
  harmonics_ = true;
  ++count_.taken;
}

const glm::vec3* SplatForest::harmonics_of(const HeldCluster& held, std::size_t node) const {
  for (const HeldCluster* at = &held;;) {
    if (!at->known.empty() && at->known[node]) return at->harmonics.data() + harmonic_count(degree_) * node;
    if (at->parent == ClusterHead::kNoParent) return nullptr;
    node = at->origins[node].parent;
    at = &clusters_.at(at->parent);
  }
}

}  // namespace gs::qnv::gaussians
