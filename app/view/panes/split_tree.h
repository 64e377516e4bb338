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

/// Max viewports of a window, and max viewports that several files get at the start.
inline constexpr std::size_t kMaxViewports = 12, kMaxViewportsAtStart = 4;

/// Direction of a split: from left to right, from top to bottom, or along the longer side of the area.
enum class SplitAxis : std::uint8_t { columns, rows, longer };

/// Part of the window: one viewport, or a row or column of adjacent parts.
struct SplitPart {
  double weight = 1;  // > 0; the lengths of the parts of a split are proportional to their weights
  std::size_t pane = 0;  // index of the viewport, if `parts` is empty
  SplitAxis axis = SplitAxis::columns;
  std::vector<SplitPart> parts;  // empty, or at least two

  bool operator==(const SplitPart&) const = default;
};

/// Arrangement of a window's viewports. Each viewport occurs once. All functions below are pure.
struct SplitTree {
  SplitPart root;
  std::optional<std::size_t> maximised;  // viewport that is the only visible one; nullopt if all are visible

  bool operator==(const SplitTree&) const = default;
};

/// Arrangement of viewports that has its own button.
enum class ViewportLayout : std::uint8_t { one, two, four };
/// Returns the smallest layout that shows `files` files at once; the largest one if there is none.
[[nodiscard]] ViewportLayout layout_for(std::size_t files);
[[nodiscard]] ViewportLayout next_layout(ViewportLayout layout);
/// Returns the split of a layout: one viewport, two along the longer side, or two rows of two. Viewports with
/// consecutive indices form groups; the group with `active` is visible.
[[nodiscard]] SplitTree split_of(ViewportLayout layout, std::size_t active);
/// Returns the layout that a split corresponds to, regardless of weights; nullopt if there is none.
[[nodiscard]] std::optional<ViewportLayout> layout_of(const SplitTree& tree);

/// Returns all viewports in the order of the layout, from the upper left. panes_in_sight() returns only the visible
/// ones.
[[nodiscard]] std::vector<std::size_t> panes_of(const SplitTree& tree);
[[nodiscard]] std::vector<std::size_t> panes_in_sight(const SplitTree& tree);
[[nodiscard]] bool has_pane(const SplitTree& tree, std::size_t pane);

/// Returns the rectangles in `area` of the viewports that panes_in_sight() returns, in the same order. They cover
/// `area` without gaps, and each is at least one pixel wide and high.
[[nodiscard]] std::vector<Viewport> arrange(const SplitTree& tree, const Viewport& area);

/// Line between two adjacent parts of a split, which the user can drag.
struct SplitDivider {
  std::vector<std::size_t> way;  // indices of the parts on the path from the root to the split
  std::size_t before = 0;  // index of the part to the left of the divider or above it
  bool upright = false;  // a vertical line, dragged to the left or right
  Viewport place;  // framebuffer pixels; a rectangle of width or height 0 at the end of part `before`
};
/// Returns all visible dividers, those of outer splits first.
[[nodiscard]] std::vector<SplitDivider> dividers_of(const SplitTree& tree, const Viewport& area);
/// Moves a divider to column or row `place`, in framebuffer pixels. Each viewport keeps at least `least` pixels. If
/// there is too little space for that, the divider moves to the middle.
[[nodiscard]] SplitTree with_divider_at(SplitTree tree, const SplitDivider& divider, const Viewport& area, int place,
                                        int least);

/// Replaces each SplitAxis::longer by columns or rows, depending on the rectangle of the split in `area`.
[[nodiscard]] SplitTree resolved(SplitTree tree, const Viewport& area);
/// Splits viewport `pane` in half. Viewport `added` gets the right or lower half. Returns the tree unchanged if `pane`
/// is not in it, or if `added` already is.
[[nodiscard]] SplitTree split_pane(SplitTree tree, std::size_t pane, SplitAxis axis, std::size_t added);
/// Removes a viewport. The previous part of its split gets its area; if there is none, the next part. The only viewport
/// is not removed.
[[nodiscard]] SplitTree without_pane(SplitTree tree, std::size_t pane);
/// Swaps two viewports. Returns the tree unchanged if one of them is not in it.
[[nodiscard]] SplitTree with_swapped(SplitTree tree, std::size_t one, std::size_t other);
/// Replaces viewport `pane` by `other`, which must not be in the tree.
[[nodiscard]] SplitTree with_replaced(SplitTree tree, std::size_t pane, std::size_t other);
/// Maximises a viewport. If it is already maximised, makes all viewports visible again.
[[nodiscard]] SplitTree with_maximised(SplitTree tree, std::size_t pane);
/// Sets equal lengths for the parts of each split.
[[nodiscard]] SplitTree evened_out(SplitTree tree);
/// Returns the viewport after `pane` (`direction` 1) or before it (-1) in the order of the layout. The first viewport
/// follows the last.
[[nodiscard]] std::size_t next_pane(const SplitTree& tree, std::size_t pane, int direction);

/// Formats a split. Numbers from 1 are viewports. `|` separates columns, `/` separates rows, and `+` separates parts
/// along the longer side. Parentheses enclose nested splits. `:W` is the weight of a part (default 1). `!N` at the end
/// is the maximised viewport. In `1:2|(2/3)`, viewport 1 is twice as wide as viewport 2, and viewport 3 is below
/// viewport 2.
[[nodiscard]] std::string split_text(const SplitTree& tree);
/// Parses text in the form of split_text(). Returns a message if the text is invalid. Safe for untrusted text.
[[nodiscard]] std::variant<SplitTree, std::string> read_split(std::string_view text);

}  // namespace gs::app
