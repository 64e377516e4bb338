#include "app/view/panes/split_tree.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace gs::app {
namespace {

SplitPart leaf(std::size_t pane, double weight = 1) { return {weight, pane, SplitAxis::columns, {}}; }

void collect_panes(const SplitPart& part, std::vector<std::size_t>& panes) {
  if (part.parts.empty()) panes.push_back(part.pane);
  for (const SplitPart& one : part.parts) collect_panes(one, panes);
}

bool in_columns(const SplitPart& part, const Viewport& area) {
  return part.axis == SplitAxis::columns || (part.axis == SplitAxis::longer && area.height <= area.width);
}

/// Returns the rectangles of the parts of a split within `area`.
std::vector<Viewport> places_of_parts(const SplitPart& part, const Viewport& area) {
  double sum = 0, until = 0;
  for (const SplitPart& one : part.parts) sum += one.weight;
  const bool columns = in_columns(part, area);
  const int length = columns ? area.width : area.height;
  // The small summand prevents rounding from making an exact half one pixel shorter.
  const auto at = [&](double weight) { return static_cast<int>(std::floor(length * (weight / sum) + 1e-9)); };
  std::vector<Viewport> places;
  for (const SplitPart& one : part.parts) {
    const int from = at(until), to = &one == &part.parts.back() ? length : at(until + one.weight);
    until += one.weight;
    Viewport place = area;
    (columns ? place.left : place.top) += from;
    (columns ? place.width : place.height) = std::max(1, to - from);
    places.push_back(place);
  }
  return places;
}

using SeenPart = std::function<void(const SplitPart&, const Viewport&, const std::vector<std::size_t>& way)>;
void visit(const SplitPart& part, const Viewport& area, std::vector<std::size_t>& way, const SeenPart& seen) {
  seen(part, area, way);
  if (part.parts.empty()) return;
  const std::vector<Viewport> places = places_of_parts(part, area);
  for (std::size_t i = 0; i < part.parts.size(); ++i) {
    way.push_back(i);
    visit(part.parts[i], places[i], way, seen);
    way.pop_back();
  }
}

/// Returns the length that a part needs so that each of its viewports is at least `least` pixels long. Measures
/// horizontally if `along_columns`, else vertically.
int least_length(const SplitPart& part, bool along_columns, int least) {
  if (part.parts.empty()) return least;
  const bool adds = part.axis == SplitAxis::longer || (part.axis == SplitAxis::columns) == along_columns;
  int length = 0;
  for (const SplitPart& one : part.parts) {
    const int needed = least_length(one, along_columns, least);
    length = adds ? length + needed : std::max(length, needed);
  }
  return length;
}

SplitPart* find_leaf(SplitPart& part, std::size_t pane) {
  if (part.parts.empty()) return part.pane == pane ? &part : nullptr;
  for (SplitPart& one : part.parts)
    if (SplitPart* found = find_leaf(one, pane)) return found;
  return nullptr;
}

bool splits_leaf(SplitPart& part, std::size_t pane, SplitAxis axis, std::size_t added) {
  for (std::size_t i = 0; i < part.parts.size(); ++i) {
    SplitPart& one = part.parts[i];
    if (!one.parts.empty()) {
      if (splits_leaf(one, pane, axis, added)) return true;
      continue;
    }
    if (one.pane != pane) continue;
    if (part.axis == axis) {
      one.weight /= 2;
      const SplitPart second = leaf(added, one.weight);
      part.parts.insert(part.parts.begin() + static_cast<std::ptrdiff_t>(i) + 1, second);
    } else {
      one = {one.weight, 0, axis, {leaf(pane), leaf(added)}};
    }
    return true;
  }
  return false;
}

/// Replaces each nested split along the same axis by its parts.
void flatten(SplitPart& part) {
  std::vector<SplitPart> parts;
  for (SplitPart& one : part.parts) {
    flatten(one);
    if (one.parts.empty() || one.axis != part.axis || one.axis == SplitAxis::longer) {
      parts.push_back(std::move(one));
      continue;
    }
    double sum = 0;
    for (const SplitPart& inner : one.parts) sum += inner.weight;
    for (SplitPart& inner : one.parts) {
      inner.weight *= one.weight / sum;
      parts.push_back(std::move(inner));
    }
  }
  part.parts = std::move(parts);
  if (part.parts.size() != 1) return;
  SplitPart only = std::move(part.parts.front());
  only.weight = part.weight;
  part = std::move(only);
}

bool removes_leaf(SplitPart& part, std::size_t pane) {
  for (std::size_t i = 0; i < part.parts.size(); ++i) {
    if (!part.parts[i].parts.empty()) {
      if (removes_leaf(part.parts[i], pane)) return true;
      continue;
    }
    if (part.parts[i].pane != pane) continue;
    part.parts[i > 0 ? i - 1 : i + 1].weight += part.parts[i].weight;
    part.parts.erase(part.parts.begin() + static_cast<std::ptrdiff_t>(i));
    return true;
  }
  return false;
}

void even_out(SplitPart& part) {
  part.weight = 1;
  for (SplitPart& one : part.parts) even_out(one);
}

void resolve(SplitPart& part, const Viewport& area) {
  if (part.parts.empty()) return;
  const std::vector<Viewport> places = places_of_parts(part, area);
  part.axis = in_columns(part, area) ? SplitAxis::columns : SplitAxis::rows;
  for (std::size_t i = 0; i < places.size(); ++i) resolve(part.parts[i], places[i]);
}

}  // namespace

ViewportLayout layout_for(std::size_t files) {
  return files <= 1 ? ViewportLayout::one : files == 2 ? ViewportLayout::two : ViewportLayout::four;
}

ViewportLayout next_layout(ViewportLayout layout) {
  return layout == ViewportLayout::one   ? ViewportLayout::two
         : layout == ViewportLayout::two ? ViewportLayout::four
                                         : ViewportLayout::one;
}

SplitTree split_of(ViewportLayout layout, std::size_t active) {
  active = std::min(active, kMaxViewports - 1);
  const std::size_t pair = active / 2 * 2, four = active / 4 * 4;
  switch (layout) {
    case ViewportLayout::one:
      break;
    case ViewportLayout::two:
      return {{1, 0, SplitAxis::longer, {leaf(pair), leaf(pair + 1)}}, {}};
    case ViewportLayout::four:
      return {{1,
               0,
               SplitAxis::rows,
               {{1, 0, SplitAxis::columns, {leaf(four), leaf(four + 1)}},
                {1, 0, SplitAxis::columns, {leaf(four + 2), leaf(four + 3)}}}},
              {}};
  }
  return {leaf(active), {}};
}

std::optional<ViewportLayout> layout_of(const SplitTree& tree) {
  const std::vector<SplitPart>& parts = tree.root.parts;
  if (parts.empty() || tree.maximised) return ViewportLayout::one;
  const auto are_panes = [](const std::vector<SplitPart>& some) {
    return some.size() == 2 && some[0].parts.empty() && some[1].parts.empty();
  };
  if (are_panes(parts)) return ViewportLayout::two;
  if (parts.size() == 2 && are_panes(parts[0].parts) && are_panes(parts[1].parts)) return ViewportLayout::four;
  return std::nullopt;
}

std::vector<std::size_t> panes_of(const SplitTree& tree) {
  std::vector<std::size_t> panes;
  collect_panes(tree.root, panes);
  return panes;
}

std::vector<std::size_t> panes_in_sight(const SplitTree& tree) {
  return tree.maximised ? std::vector<std::size_t>{*tree.maximised} : panes_of(tree);
}

bool has_pane(const SplitTree& tree, std::size_t pane) {
  const std::vector<std::size_t> panes = panes_of(tree);
  return std::find(panes.begin(), panes.end(), pane) != panes.end();
}

std::vector<Viewport> arrange(const SplitTree& tree, const Viewport& area) {
  if (tree.maximised) return {area};
  std::vector<Viewport> places;
  std::vector<std::size_t> way;
  visit(tree.root, area, way, [&](const SplitPart& part, const Viewport& place, const auto&) {
    if (part.parts.empty())
      places.push_back({place.left, place.top, std::max(1, place.width), std::max(1, place.height)});
  });
  return places;
}

std::vector<SplitDivider> dividers_of(const SplitTree& tree, const Viewport& area) {
  std::vector<SplitDivider> dividers;
  if (tree.maximised) return dividers;
  std::vector<std::size_t> way;
  visit(tree.root, area, way, [&](const SplitPart& part, const Viewport& place, const auto& steps) {
    if (part.parts.empty()) return;
    const bool upright = in_columns(part, place);
    const std::vector<Viewport> places = places_of_parts(part, place);
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
      Viewport line = place;
      (upright ? line.left : line.top) = upright ? places[i + 1].left : places[i + 1].top;
      (upright ? line.width : line.height) = 0;
      dividers.push_back({steps, i, upright, line});
    }
  });
  return dividers;
}

SplitTree with_divider_at(SplitTree tree, const SplitDivider& divider, const Viewport& area, int place, int least) {
  SplitPart* part = &tree.root;
  Viewport around = area;
  for (const std::size_t step : divider.way) {
    if (step >= part->parts.size()) return tree;
    around = places_of_parts(*part, around)[step];
    part = &part->parts[step];
  }
  if (divider.before + 1 >= part->parts.size()) return tree;
  const bool columns = in_columns(*part, around);
  const std::vector<Viewport> places = places_of_parts(*part, around);
  SplitPart &before = part->parts[divider.before], &behind = part->parts[divider.before + 1];
  const Viewport &first = places[divider.before], &second = places[divider.before + 1];
  const int start = columns ? around.left : around.top, whole = columns ? around.width : around.height;
  const int from = (columns ? first.left : first.top) - start;
  const int length = columns ? first.width + second.width : first.height + second.height;
  if (length < 2 || whole < length) return tree;
  int lowest = least_length(before, columns, least), highest = length - least_length(behind, columns, least);
  if (lowest > highest) lowest = highest = length / 2;
  double sum = 0, until = 0;
  for (const SplitPart& one : part->parts) {
    if (&one < &before) until += one.weight;
    sum += one.weight;
  }
  // Add half a pixel, so that places_of_parts() rounds to exactly this pixel.
  const double wanted = (from + std::clamp(place - start - from, lowest, highest) + 0.5) / whole * sum - until;
  const double both = before.weight + behind.weight;
  before.weight = std::clamp(wanted, both * 1e-6, both * (1 - 1e-6));
  behind.weight = both - before.weight;
  return tree;
}

SplitTree resolved(SplitTree tree, const Viewport& area) {
  resolve(tree.root, area);
  flatten(tree.root);
  return tree;
}

SplitTree split_pane(SplitTree tree, std::size_t pane, SplitAxis axis, std::size_t added) {
  if (!has_pane(tree, pane) || has_pane(tree, added)) return tree;
  tree.maximised.reset();
  if (tree.root.parts.empty())
    tree.root = {1, 0, axis, {leaf(pane), leaf(added)}};
  else
    (void)splits_leaf(tree.root, pane, axis, added);
  return tree;
}

SplitTree without_pane(SplitTree tree, std::size_t pane) {
  if (tree.root.parts.empty()) return tree;
  (void)removes_leaf(tree.root, pane);
  flatten(tree.root);
  if (tree.maximised == pane) tree.maximised.reset();
  return tree;
}

SplitTree with_swapped(SplitTree tree, std::size_t one, std::size_t other) {
  SplitPart *first = find_leaf(tree.root, one), *second = find_leaf(tree.root, other);
  if (first && second) std::swap(first->pane, second->pane);
  return tree;
}

SplitTree with_replaced(SplitTree tree, std::size_t pane, std::size_t other) {
  if (has_pane(tree, other)) return tree;
  if (SplitPart* found = find_leaf(tree.root, pane)) found->pane = other;
  if (tree.maximised == pane) tree.maximised = other;
  return tree;
}

SplitTree with_maximised(SplitTree tree, std::size_t pane) {
  const bool is_it = tree.maximised == pane || tree.root.parts.empty();
  tree.maximised.reset();
  if (!is_it && has_pane(tree, pane)) tree.maximised = pane;
  return tree;
}

SplitTree evened_out(SplitTree tree) {
  even_out(tree.root);
  return tree;
}

std::size_t next_pane(const SplitTree& tree, std::size_t pane, int direction) {
  const std::vector<std::size_t> panes = panes_of(tree);
  const auto found = std::find(panes.begin(), panes.end(), pane);
  if (found == panes.end()) return panes.front();
  const auto index = static_cast<std::size_t>(found - panes.begin());
  return panes[(index + (direction > 0 ? 1 : panes.size() - 1)) % panes.size()];
}

}  // namespace gs::app
