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

/// Layout of panels and picture in the window. Areas without open panels are absent.
struct DockLayout {
  struct Area {
    DockRectangle place;    // area of the panels
    DockRectangle divider;  // draggable line between panels and picture
  };
  std::array<std::optional<Area>, kDockSides> areas;  // by DockSide
  DockRectangle picture;
};

/// Dock state: which panels are open, on which side, and the sizes of the areas. The left and right areas take the
/// whole height; the bottom area lies between them. Panels in one area are tabs; one is in front. Panels are identified
/// by number. No drawing.
class Dock {
 public:
  static constexpr float kMinArea = 120, kMaxArea = 4000;      // limits of an area's width or height
  static constexpr float kMinPicture = 200, kMinHeight = 120;  // min size of the picture; areas shrink first
  static constexpr float kDivider = 5;

  /// `sides` is the initial side of each panel. All start closed.
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

  /// Preferred width of an area (height for the bottom) at scale 1.
  [[nodiscard]] float size(DockSide side) const { return area(side).size; }
  void set_size(DockSide side, float size);

  /// Computes the layout in `whole` at a screen scale. The picture gets the remaining space, at least one unit.
  [[nodiscard]] DockLayout lay_out(const DockRectangle& whole, float scale) const;
  /// Returns the size of an area after its divider is dragged to `place` along its axis.
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
