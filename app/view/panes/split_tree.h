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

/// Max viewports in a window, and max viewports opened at start for several files.
inline constexpr std::size_t kMaxViewports = 12, kMaxViewportsAtStart = 4;

/// Direction of a split: left to right, top to bottom, or along the longer side of the shared area.
enum class SplitAxis : std::uint8_t { columns, rows, longer };

/// Part of the window: a viewport, or adjacent parts in a row or column.
struct SplitPart {
  double weight = 1;     // > 0; lengths of siblings are proportional to their weights
  std::size_t pane = 0;  // viewport number, if there are no parts
  SplitAxis axis = SplitAxis::columns;
  std::vector<SplitPart> parts;  // empty, or two or more

  bool operator==(const SplitPart&) const = default;
};

/// Layout of a window's viewports; each one occurs once. A plain value. All functions below are pure.
struct SplitTree {
  SplitPart root;
  std::optional<std::size_t> maximised;  // the only visible viewport, if set

  bool operator==(const SplitTree&) const = default;
};

/// Layout with its own button.
enum class ViewportLayout : std::uint8_t { one, two, four };
/// Returns the layout that shows `files` files at once, or the largest one.
[[nodiscard]] ViewportLayout layout_for(std::size_t files);
[[nodiscard]] ViewportLayout next_layout(ViewportLayout layout);
/// Returns the split for a layout: one viewport, a pair along the longer side, or two rows of two. Viewports are
/// grouped by number; the group that contains `active` is used.
[[nodiscard]] SplitTree split_of(ViewportLayout layout, std::size_t active);
/// Returns the layout of a split, regardless of weights; nullopt if it is none of them.
[[nodiscard]] std::optional<ViewportLayout> layout_of(const SplitTree& tree);

/// Return all viewports, or only the visible ones, from the upper left.
[[nodiscard]] std::vector<std::size_t> panes_of(const SplitTree& tree);
[[nodiscard]] std::vector<std::size_t> panes_in_sight(const SplitTree& tree);
[[nodiscard]] bool has_pane(const SplitTree& tree, std::size_t pane);

/// Returns the rectangles of `panes_in_sight` in `area`. They cover it without gaps; each is at least one pixel wide
/// and high.
[[nodiscard]] std::vector<Viewport> arrange(const SplitTree& tree, const Viewport& area);

/// Divider between two adjacent parts of a split.
struct SplitDivider {
  std::vector<std::size_t> way;  // part indices from the root to the split
  std::size_t before = 0;        // index of the part left of it or above it
  bool upright = false;          // vertical line, dragged sideways
  Viewport place;                // framebuffer pixels: zero-width line after `before`
};
/// Returns all visible dividers, outer ones first.
[[nodiscard]] std::vector<SplitDivider> dividers_of(const SplitTree& tree, const Viewport& area);
/// Moves a divider to column or row `place` in framebuffer pixels. Each adjacent viewport keeps at least `least`
/// pixels; if there is no room, the divider goes to the middle.
[[nodiscard]] SplitTree with_divider_at(SplitTree tree, const SplitDivider& divider, const Viewport& area, int place,
                                        int least);

/// Replaces each SplitAxis::longer by rows or columns, as they are in `area`.
[[nodiscard]] SplitTree resolved(SplitTree tree, const Viewport& area);
/// Splits `pane` in half; `added` gets the right or lower half. Returns the tree unchanged if `pane` is missing or
/// `added` is present.
[[nodiscard]] SplitTree split_pane(SplitTree tree, std::size_t pane, SplitAxis axis, std::size_t added);
/// Removes a viewport; the preceding neighbour takes its area, else the following one. The last viewport stays.
[[nodiscard]] SplitTree without_pane(SplitTree tree, std::size_t pane);
/// Swaps two viewports. Returns the tree unchanged if one is missing.
[[nodiscard]] SplitTree with_swapped(SplitTree tree, std::size_t one, std::size_t other);
/// Replaces `pane` by `other`, which must not be in the tree.
[[nodiscard]] SplitTree with_replaced(SplitTree tree, std::size_t pane, std::size_t other);
/// Maximises a viewport; restores all if it is already maximised.
[[nodiscard]] SplitTree with_maximised(SplitTree tree, std::size_t pane);
/// Gives all parts of each split equal length.
[[nodiscard]] SplitTree evened_out(SplitTree tree);
/// Returns the next (`direction` 1) or previous (-1) viewport, wrapping around.
[[nodiscard]] std::size_t next_pane(const SplitTree& tree, std::size_t pane, int direction);

/// Formats a split. Numbers from 1 are viewports; `|` separates columns, `/` rows, and `+` parts along the longer side.
/// Parentheses enclose nested splits. `:W` is a part's weight (default 1); a final `!N` is the maximised viewport. In
/// `1:2|(2/3)`, viewport 1 is twice as wide as viewport 2, and 3 is below 2.
[[nodiscard]] std::string split_text(const SplitTree& tree);
/// Parses the output of `split_text`, or returns a message. Safe for untrusted text.
[[nodiscard]] std::variant<SplitTree, std::string> read_split(std::string_view text);

}  // namespace gs::app
