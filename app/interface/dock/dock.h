#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace gs::app {

/// Side of the window where panels dock.
enum class DockSide : std::uint8_t { left, right, bottom };
inline constexpr std::size_t kDockSides = 3;

/// Rectangle in Dear ImGui units from the window's upper left.
struct DockRectangle {
  float left = 0, top = 0, width = 0, height = 0;

  [[nodiscard]] bool contains(float x, float y) const {
    return x >= left && y >= top && x < left + width && y < top + height;
  }
};

/// Layout of the dock areas and the picture in the window. `areas` has no value for a side without open panels.
struct DockLayout {
  struct Area {
    DockRectangle place;  // rectangle of the panels
    DockRectangle divider;  // draggable line between panels and picture
  };
  std::array<std::optional<Area>, kDockSides> areas;  // by DockSide
  DockRectangle picture;
};

/// State of the dock: the open panels, their sides, and the sizes of the areas. The left and right areas have the full
/// height; the bottom area lies between them. The panels of one area are tabs, of which one is in front. A panel is
/// identified by its index. Draws nothing.
class Dock {
 public:
  static constexpr float kMinArea = 120, kMaxArea = 4000;  // min and max width or height of an area
  static constexpr float kMinPicture = 200, kMinHeight = 120;  // min size of the picture; areas shrink first
  static constexpr float kDivider = 5;

  /// `sides` holds the initial side of each panel. All panels are closed at first.
  explicit Dock(const std::vector<DockSide>& sides);

  [[nodiscard]] std::size_t panels() const { return panels_.size(); }
  [[nodiscard]] bool is_open(std::size_t panel) const;
  /// Reports whether the panel is open and in front.
  [[nodiscard]] bool is_front(std::size_t panel) const;
  [[nodiscard]] DockSide side_of(std::size_t panel) const { return panels_[panel].side; }
  /// Returns the open panels of a side, in the order of opening.
  [[nodiscard]] const std::vector<std::size_t>& open_at(DockSide side) const { return area(side).open; }
  [[nodiscard]] std::optional<std::size_t> front_at(DockSide side) const { return area(side).front; }

  /// Opens the panel, or brings it to the front.
  void open(std::size_t panel);
  void close(std::size_t panel);
  /// Closes the panel if it is in front, else opens it.
  void toggle(std::size_t panel);
  /// Moves the panel to another side; it stays open or closed.
  void move(std::size_t panel, DockSide side);

  /// Returns the preferred width of an area, or the height of the bottom area, at scale 1.
  [[nodiscard]] float size(DockSide side) const { return area(side).size; }
  void set_size(DockSide side, float size);

  /// Computes the layout of the rectangle `whole` at a screen scale. The picture gets the space that the areas leave,
  /// at least one unit.
  [[nodiscard]] DockLayout lay_out(const DockRectangle& whole, float scale) const;
  /// Returns the size of an area at scale 1 when its divider is dragged to the coordinate `place`.
  [[nodiscard]] static float size_for(DockSide side, float place, const DockRectangle& whole, float scale);

 private:
  struct Area {
    std::vector<std::size_t> open;
    std::optional<std::size_t> front;
    float size = 0;
  };
  struct Placed {
    DockSide side;
  };
  [[nodiscard]] Area& area(DockSide side) { return areas_[static_cast<std::size_t>(side)]; }
  [[nodiscard]] const Area& area(DockSide side) const { return areas_[static_cast<std::size_t>(side)]; }

  std::vector<Placed> panels_;
  std::array<Area, kDockSides> areas_;
};

}  // namespace gs::app
