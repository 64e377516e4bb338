#include "qnv/codecs/gaussians/encode/part_tree.h"

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <utility>

namespace gs::qnv::gaussians {
namespace {

static_assert(std::is_trivially_copyable_v<MergedNode>);

/// Appends a splat of other Gaussians with an equal degree.
void append_splat(Gaussians& to, const Gaussians& from, std::size_t i) {
  const std::size_t per = harmonic_count(from.degree);
  to.degree = from.degree;
  to.positions.push_back(from.positions[i]);
  to.scales.push_back(from.scales[i]);
  to.rotations.push_back(from.rotations[i]);
  to.opacities.push_back(from.opacities[i]);
  to.bases.push_back(from.bases[i]);
  for (std::size_t k = 0; k < per; ++k) to.harmonics.push_back(from.harmonics[i * per + k]);
}

template <class T>
void append_list(std::vector<std::byte>& to, const std::vector<T>& list) {
  const std::uint64_t count = list.size();
  const auto head = std::as_bytes(std::span(&count, 1)), bytes = std::as_bytes(std::span(list));
  to.insert(to.end(), head.begin(), head.end());
  to.insert(to.end(), bytes.begin(), bytes.end());
}

template <class T>
bool next_list(std::span<const std::byte>& from, std::vector<T>& list) {
  std::uint64_t count = 0;
  if (from.size() < sizeof count) return false;
  std::memcpy(&count, from.data(), sizeof count);
  from = from.subspan(sizeof count);
  if (count > from.size() / sizeof(T)) return false;
  list.resize(static_cast<std::size_t>(count));
  const std::size_t bytes = list.size() * sizeof(T);
  if (bytes > 0) std::memcpy(static_cast<void*>(list.data()), from.data(), bytes);
  from = from.subspan(bytes);
  return true;
}

/// Calls each(list) for all lists of a top, until a call returns false.
template <class Top, class Each>
bool each_list(Top& top, const Each& each) {
  auto& leaves = top.leaves;
  return each(top.forest.nodes) && each(top.forest.roots) && each(top.places) && each(top.harmonics) &&
         each(leaves.positions) && each(leaves.scales) && each(leaves.rotations) && each(leaves.opacities) &&
         each(leaves.bases) && each(leaves.harmonics);
}

}  // namespace

std::optional<StoredTree> store_tree(const MergeTree& tree, const PartTop& top, std::string_view work,
                                     std::size_t splats, SharedStore& store) {
  const auto merged = tree.nodes().subspan(tree.given());
  const auto nodes = std::as_bytes(merged);
  std::vector<std::byte> bytes(nodes.begin(), nodes.end());
  for (const MergedNode& leaf : tree.nodes().first(tree.given())) {
    const auto number = std::as_bytes(std::span(&leaf.blob.visibility, 1));
    bytes.insert(bytes.end(), number.begin(), number.end());
  }
  std::vector<std::byte> result;
  append_list(result, std::vector<std::uint64_t>{splats, merged.size()});
  append_list(result, tree.roots());
  append_top(result, top);
  const auto offset = store.finish(work, bytes, result);
  return offset ? std::optional(StoredTree{*offset, merged.size(), tree.roots()}) : std::nullopt;
}

bool restore_tree(std::string_view work, std::size_t splats, const SharedStore& store, StoredTree& tree, PartTop& top) {
  const auto found = store.finished(work);
  if (!found) return false;
  std::span<const std::byte> rest(found->result);
  std::vector<std::uint64_t> sizes;
  StoredTree kept;
  kept.offset = found->offset;
  if (!next_list(rest, sizes) || sizes.size() != 2 || sizes[0] != splats ||
      sizes[1] >= std::max<std::size_t>(splats, 1))
    return false;
  kept.merged = static_cast<std::size_t>(sizes[1]);
  auto kept_top = next_list(rest, kept.roots) ? next_top(rest) : std::nullopt;
  const auto exists = [&](std::uint32_t node) { return node < splats + kept.merged; };
  if (!kept_top || !std::ranges::all_of(kept.roots, exists) || !std::ranges::all_of(kept_top->places, exists))
    return false;
  tree = std::move(kept);
  top = std::move(*kept_top);
  return true;
}

std::optional<MergeTree> read_tree(const StoredTree& stored, const Gaussians& source, float detail,
                                   const SharedStore& store) {
  std::vector<float> visibility(source.size());
  const std::uint64_t after = stored.offset + stored.merged * sizeof(MergedNode);
  if (!store.read(after, std::as_writable_bytes(std::span(visibility)))) return std::nullopt;
  std::vector<MergedNode> nodes = leaves_of(source, source.description.box, detail, visibility).nodes;
  const std::size_t leaves = nodes.size();
  nodes.resize(leaves + stored.merged);
  if (!store.read(stored.offset, std::as_writable_bytes(std::span(nodes).subspan(leaves)))) return std::nullopt;
  return MergeTree(std::move(nodes), stored.roots, leaves, detail);
}

PartTop top_of(const MergeTree& tree, const Gaussians& source, std::size_t most) {
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const float p = tree[a].leaf() ? -1 : tree[a].error, q = tree[b].leaf() ? -1 : tree[b].error;
    return p != q ? p < q : a > b;
  };
  std::vector<std::uint32_t> heap = tree.roots(), above;
  std::ranges::make_heap(heap, less);
  while (heap.size() < most && !tree[heap.front()].leaf()) {
    const std::uint32_t worst = heap.front();
    std::ranges::pop_heap(heap, less);
    heap.back() = tree[worst].left;
    std::ranges::push_heap(heap, less);
    heap.push_back(tree[worst].right);
    std::ranges::push_heap(heap, less);
    above.push_back(worst);
  }
  // Children have smaller indices than their parents.
  PartTop top;
  top.places = heap;
  top.places.insert(top.places.end(), above.begin(), above.end());
  std::ranges::sort(top.places);
  std::ranges::sort(above);
  const auto at = [&](std::uint32_t place) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(top.places, place) - top.places.begin());
  };
  const MeanHarmonics means(tree, source);
  top.leaves.degree = source.degree;
  for (const std::uint32_t place : top.places) {
    MergedNode node = tree[place];
    if (node.leaf()) {
      append_splat(top.leaves, source, node.right);
      node.right = static_cast<std::uint32_t>(top.leaves.size() - 1);
    } else if (std::ranges::binary_search(above, place)) {
      node.left = at(node.left);
      node.right = at(node.right);
    } else {
      node.left = node.right = MergedNode::kOutside;
    }
    top.forest.box.add(node.blob.mean);
    top.forest.nodes.push_back(node);
    const auto own = means.of(place);
    top.harmonics.insert(top.harmonics.end(), own.begin(), own.end());
  }
  for (const std::uint32_t root : tree.roots()) top.forest.roots.push_back(at(root));
  return top;
}

void append_top(std::vector<std::byte>& to, const PartTop& top) {
  append_list(to, std::vector<int>{top.leaves.degree});
  (void)each_list(top, [&](const auto& list) {
    append_list(to, list);
    return true;
  });
}

std::optional<PartTop> next_top(std::span<const std::byte>& from) {
  PartTop top;
  std::vector<int> degree;
  if (!next_list(from, degree) || degree.size() != 1) return std::nullopt;
  top.leaves.degree = degree.front();
  if (!each_list(top, [&](auto& list) { return next_list(from, list); })) return std::nullopt;
  return top;
}

void TopForest::add(PartTop top) {
  const auto first = static_cast<std::uint32_t>(forest.nodes.size());
  const auto first_leaf = static_cast<std::uint32_t>(leaves.size());
  const std::uint32_t part = origins.empty() ? 0 : origins.back().part + 1;
  leaves.degree = top.leaves.degree;
  for (std::size_t i = 0; i < top.leaves.size(); ++i) append_splat(leaves, top.leaves, i);
  for (MergedNode node : top.forest.nodes) {
    if (node.leaf()) {
      node.right += first_leaf;
    } else if (!node.outside()) {
      node.left += first;
      node.right += first;
    }
    forest.box.add(node.blob.mean);
    forest.nodes.push_back(node);
  }
  for (const std::uint32_t root : top.forest.roots) forest.roots.push_back(first + root);
  for (const std::uint32_t place : top.places) origins.push_back({part, place});
  harmonics.insert(harmonics.end(), top.harmonics.begin(), top.harmonics.end());
}

}  // namespace gs::qnv::gaussians
