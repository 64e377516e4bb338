#include "render/rays/box_tree.h"

#include <algorithm>

namespace gs::render {
namespace {

constexpr std::size_t kBins = 16;

// Halve before adding, because the sum of two floats could overflow.
glm::vec3 middle_of(const Box& box) { return box.empty() ? glm::vec3(0) : box.lower * 0.5f + box.upper * 0.5f; }

double half_area(const Box& box) {
  if (box.empty()) return 0;
  const glm::dvec3 size = glm::dvec3(box.upper) - glm::dvec3(box.lower);
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

}  // namespace

// Splits entries into two parts and returns the size of the first. Tests planes across the longest axis of the box
// centres. Uses the plane with the lowest sum of area times count. Splits in halves if `halves`, or if no plane
// separates the centres.
std::size_t BoxTree::part(Entry* entries, std::size_t count, bool halves) {
  Box middles;
  for (std::size_t i = 0; i < count; ++i) middles.add(middle_of(entries[i].box));
  const glm::dvec3 lower(middles.lower), size = glm::dvec3(middles.upper) - lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  if (!halves && size[axis] > 0) {
    struct Bin {
      Box box;
      std::size_t count = 0;
    };
    std::array<Bin, kBins> bins;
    const double scale = kBins / size[axis];
    const auto bin_of = [&](const Entry& entry) {
      const double place = (middle_of(entry.box)[axis] - lower[axis]) * scale;
      return std::min(kBins - 1, static_cast<std::size_t>(std::max(0.0, place)));
    };
    for (std::size_t i = 0; i < count; ++i) {
      Bin& bin = bins[bin_of(entries[i])];
      bin.box.add(entries[i].box);
      ++bin.count;
    }
    std::array<double, kBins> costs{};  // cost of all entries before each bin
    Bin sum;
    for (std::size_t i = 0; i + 1 < kBins; ++i) {
      sum.box.add(bins[i].box);
      sum.count += bins[i].count;
      costs[i + 1] = half_area(sum.box) * static_cast<double>(sum.count);
    }
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    sum = {};
    for (std::size_t i = kBins; i-- > 1;) {
      sum.box.add(bins[i].box);
      sum.count += bins[i].count;
      const double cost = costs[i] + half_area(sum.box) * static_cast<double>(sum.count);
      if (sum.count >= kMinThings && count - sum.count >= kMinThings && cost < least) {
        least = cost;
        best = i;
      }
    }
    if (best > 0) {
      Entry* const parted =
          std::partition(entries, entries + count, [&](const Entry& entry) { return bin_of(entry) < best; });
      return static_cast<std::size_t>(parted - entries);
    }
  }
  const std::size_t half = count / 2;
  std::nth_element(entries, entries + half, entries + count,
                   [&](const Entry& a, const Entry& b) { return middle_of(a.box)[axis] < middle_of(b.box)[axis]; });
  return half;
}

BoxTree::BoxTree(std::vector<Entry> entries) {
  struct Open {
    std::size_t first, count;
    std::uint32_t parent, depth;  // parent: index of the node for which this is the second child, or kNobody
  };
  constexpr std::uint32_t kNobody = UINT32_MAX;
  if (entries.empty()) return;
  nodes_.reserve(entries.size() / kMinThings * 2 + 1);
  std::vector<Open> open{{0, entries.size(), kNobody, 0}};
  while (!open.empty()) {
    const Open part_of = open.back();
    open.pop_back();
    const auto place = static_cast<std::uint32_t>(nodes_.size());
    if (part_of.parent != kNobody) nodes_[part_of.parent].place = place;
    Entry* const first = entries.data() + part_of.first;
    Box box;
    for (std::size_t i = 0; i < part_of.count; ++i) box.add(first[i].box);
    const bool leaf = part_of.count <= kMaxThings;
    nodes_.push_back({box.lower, leaf ? static_cast<std::uint32_t>(part_of.first) : 0, box.upper,
                      leaf ? static_cast<std::uint32_t>(part_of.count) : 0});
    if (leaf) continue;
    const std::size_t before = part(first, part_of.count, part_of.depth >= kBalanced);
    open.push_back({part_of.first + before, part_of.count - before, place, part_of.depth + 1});
    open.push_back({part_of.first, before, kNobody, part_of.depth + 1});
  }
  nodes_.shrink_to_fit();
  order_.reserve(entries.size());
  for (const Entry& entry : entries) order_.push_back(entry.thing);
}

void BoxTree::refit(const std::vector<Box>& boxes) {
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    Node& node = nodes_[i];
    Box box;
    for (std::uint32_t k = 0; k < node.count; ++k) box.add(boxes[order_[node.place + k]]);
    if (node.count == 0)
      for (const Node* child : {&nodes_[i + 1], &nodes_[node.place]}) box.add(Box{child->lower, child->upper});
    node.lower = box.lower;
    node.upper = box.upper;
  }
}

}  // namespace gs::render
