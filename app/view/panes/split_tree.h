#pragma once

#include "app/view/viewports.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// Viewports that a window can have, and of those that a program with several files starts with.
inline constexpr std::size_t kMostViewports = 12, kMostViewportsAtStart = 4;

/// How the parts of a split follow each other: from left to right, from top to bottom, or along the longer side of
/// what they share, whichever that is.
enum class SplitAxis : std::uint8_t { columns, rows, longer };

/// A part of the window: a viewport, or several parts beside or above each other.
struct SplitPart {
  double weight = 1;     // > 0: its length is to those of its siblings as their weights are
  std::size_t pane = 0;  // the viewport; where there are no parts
  SplitAxis axis = SplitAxis::columns;
  std::vector<SplitPart> parts;  // none, or two at the least

  bool operator==(const SplitPart&) const = default;
};

/// How a window is split into viewports. Each of them stands in it once. A plain value; all functions below are pure.
struct SplitTree {
  SplitPart root;
  std::optional<std::size_t> maximised;  // the viewport that is alone in sight

  bool operator==(const SplitTree&) const = default;
};

/// The splits that have a button of their own.
enum class ViewportLayout : std::uint8_t { one, two, four };
/// The one that shows so many files at once, as far as one can.
[[nodiscard]] ViewportLayout layout_for(std::size_t files);
[[nodiscard]] ViewportLayout next_layout(ViewportLayout layout);
/// One viewport; a pair along the longer side; two rows of two: of the viewports in the order of their numbers, those
/// that `active` belongs to.
[[nodiscard]] SplitTree split_of(ViewportLayout layout, std::size_t active);
/// The layout that a split has, whatever its weights; nothing: none.
[[nodiscard]] std::optional<ViewportLayout> layout_of(const SplitTree& tree);

/// All viewports, from the upper left; those in sight: all, or the maximised one.
[[nodiscard]] std::vector<std::size_t> panes_of(const SplitTree& tree);
[[nodiscard]] std::vector<std::size_t> panes_in_sight(const SplitTree& tree);
[[nodiscard]] bool has_pane(const SplitTree& tree, std::size_t pane);

/// The places of `panes_in_sight` in `area`. They cover it without gaps; none is narrower or lower than a pixel.
[[nodiscard]] std::vector<Viewport> arrange(const SplitTree& tree, const Viewport& area);

/// Between two parts of a split that follow each other.
struct SplitDivider {
  std::vector<std::size_t> way;  // of parts, from the root to the split
  std::size_t before = 0;        // of its parts, the one on the left or above
  bool upright = false;          // it is dragged sideways
  Viewport place;                // framebuffer pixels: a line, behind `before`, without a width of its own
};
/// All in sight, outer ones first.
[[nodiscard]] std::vector<SplitDivider> dividers_of(const SplitTree& tree, const Viewport& area);
/// With a divider of the tree moved to this column or row of framebuffer pixels, as far as every viewport beside it
/// keeps `least` pixels; in the middle where there is no room for that.
[[nodiscard]] SplitTree with_divider_at(SplitTree tree, const SplitDivider& divider, const Viewport& area, int place,
                                        int least);

/// As it is in `area`: columns or rows where it is along the longer side.
[[nodiscard]] SplitTree resolved(SplitTree tree, const Viewport& area);
/// Half of the place of `pane`, on the right or below, goes to `added`. The same where one is in the tree, or the
/// other not.
[[nodiscard]] SplitTree split_pane(SplitTree tree, std::size_t pane, SplitAxis axis, std::size_t added);
/// Without a viewport, whose place the neighbour before it takes, else that behind it. The last one stays.
[[nodiscard]] SplitTree without_pane(SplitTree tree, std::size_t pane);
/// Two viewports change places. The same where one is not in the tree.
[[nodiscard]] SplitTree with_swapped(SplitTree tree, std::size_t one, std::size_t other);
/// `other`, which is not in the tree, stands where `pane` did.
[[nodiscard]] SplitTree with_replaced(SplitTree tree, std::size_t pane, std::size_t other);
/// A viewport alone in sight; all again, if it is that already.
[[nodiscard]] SplitTree with_maximised(SplitTree tree, std::size_t pane);
/// Parts of a split as long as each other, throughout.
[[nodiscard]] SplitTree evened_out(SplitTree tree);
/// The viewport after (1) or before (-1) this one, around.
[[nodiscard]] std::size_t next_pane(const SplitTree& tree, std::size_t pane, int direction);

/// A split as a text: viewports by their numbers from 1, `|` between those beside each other, `/` between those above
/// each other, `+` along the longer side, in brackets where one stands in another; behind a colon the weight of a part,
/// which is 1 without; behind `!` the maximised viewport. `1:2|(2/3)`: the first is twice as wide as the second, below
/// which the third stands.
[[nodiscard]] std::string split_text(const SplitTree& tree);
/// Reads what `split_text` writes. The text may be anything; else what is wrong with it.
[[nodiscard]] std::variant<SplitTree, std::string> read_split(std::string_view text);

}  // namespace gs::app
