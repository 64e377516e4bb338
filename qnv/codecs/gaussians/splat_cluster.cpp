#include "qnv/codecs/gaussians/splat_cluster.h"

#include "qnv/base/short_number.h"
#include "qnv/codecs/gaussians/cluster_code.h"

#include <algorithm>
#include <initializer_list>

namespace gs::qnv::gaussians {
namespace {

std::vector<std::byte> with_numbers(std::initializer_list<std::uint32_t> numbers, std::span<const std::byte> bytes) {
  std::vector<std::byte> out;
  for (const std::uint32_t number : numbers) put_number(out, number);
  out.insert(out.end(), bytes.begin(), bytes.end());
  return out;
}

/// Takes numbers below 2^32 from the front of a payload. Returns false if one is missing or larger.
bool take_numbers(std::span<const std::byte>& payload, std::initializer_list<std::uint32_t*> numbers) {
  if (payload.size() > kMostClusterBytes) return false;
  for (std::uint32_t* const number : numbers) {
    const auto taken = take_wide_number(payload);
    if (!taken || *taken > 0xffffffff) return false;
    *number = static_cast<std::uint32_t>(*taken);
  }
  return true;
}

}  // namespace

std::vector<std::byte> pack(const ClusterHead& head, std::span<const std::byte> bytes) {
  return with_numbers({head.id, head.parent + 1, head.first, head.count, head.level}, bytes);
}

std::optional<PackedCluster> parse_cluster(std::span<const std::byte> payload) {
  ClusterHead head;
  if (!take_numbers(payload, {&head.id, &head.parent, &head.first, &head.count, &head.level})) return std::nullopt;
  head.parent -= 1;
  const bool root = head.parent == ClusterHead::kNoParent;
  if (head.count == 0 || head.count > kMostNodes || head.first > kMostNodes || head.id == ClusterHead::kNoParent ||
      head.id == head.parent || root != (head.level == 0) || (root && (head.first != 0 || head.count != 1)))
    return std::nullopt;
  return PackedCluster{head, payload};
}

std::vector<std::byte> pack(const HarmonicsHead& head, std::span<const std::byte> bytes) {
  return with_numbers({head.cluster, head.first, head.count}, bytes);
}

std::optional<PackedHarmonics> parse_harmonics(std::span<const std::byte> payload) {
  HarmonicsHead head;
  if (!take_numbers(payload, {&head.cluster, &head.first, &head.count})) return std::nullopt;
  if (head.count == 0 || head.count > kMostNodes || head.first > kMostNodes) return std::nullopt;
  return PackedHarmonics{head, payload};
}

bool decode_nodes(std::span<const std::byte> bytes, std::span<const SplatNode> parents, bool may_stay,
                  SplatModels& models, const Precision& precision, std::vector<SplatNode>& nodes,
                  std::vector<NodeOrigin>* origins) {
  Reader reader{BinaryDecoder(bytes)};
  nodes.clear();
  if (origins) origins->clear();
  for (std::size_t i = 0; i < parents.size(); ++i) {
    if (parents[i].leaf) continue;
    const std::size_t count = code_children(reader, models, parents[i], may_stay, {}, precision, nodes);
    if (reader.coder.exhausted() || nodes.size() > kMostNodes) return false;
    if (origins) origins->resize(nodes.size(), {static_cast<std::uint16_t>(i), may_stay && count == 1});
  }
  return !nodes.empty();
}

SplatNode root_node(const Box& box) {
  SplatNode node;
  const glm::vec3 size = box.size();
  node.position = box.lower + size * 0.5f;
  node.scales.fill(static_cast<std::int16_t>(scale_code(std::max({size.x, size.y, size.z}) / 4)));
  node.opacity = kMostOpacity;
  node.color = glm::vec3(0.5f);
  return node;
}

}  // namespace gs::qnv::gaussians
