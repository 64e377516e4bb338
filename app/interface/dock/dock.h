#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace gs::app {

/// Where panels stand beside the picture.
enum class DockSide : std::uint8_t { left, right, bottom };
inline constexpr std::size_t kDockSides = 3;

/// A part of the window, in the units of Dear ImGui, from the upper left.
struct DockRectangle {
  float left = 0, top = 0, width = 0, height = 0;

  [[nodiscard]] bool contains(float x, float y) const {
    return x >= left && y >= top && x < left + width && y < top + height;
  }
};

/// What the panels and the picture get of the window. An area without open panels is not there.
struct DockLayout {
  struct Area {
    DockRectangle place;    // of the panels
    DockRectangle divider;  // between them and the picture; drags make the area larger and smaller
  };
  std::array<std::optional<Area>, kDockSides> areas;  // by DockSide
  DockRectangle picture;
};

/// Which panels are open, where, and how large the areas are in which they stand: at the left and right over the whole
/// height, and below the picture between them. The panels of an area share it; one of them is in front. Panels are
/// numbers here. Pure bookkeeping.
class Dock {
 public:
  static constexpr float kLeastArea = 120, kMostArea = 4000;       // across
  static constexpr float kLeastPicture = 200, kLeastHeight = 120;  // of the picture; areas give way before it does
  static constexpr float kDivider = 5;

  /// `sides`: where each panel stands at first. None is open.
  explicit Dock(const std::vector<DockSide>& sides);

  [[nodiscard]] std::size_t panels() const { return panels_.size(); }
  [[nodiscard]] bool is_open(std::size_t panel) const;
  /// Open, and not behind another one.
  [[nodiscard]] bool is_front(std::size_t panel) const;
  [[nodiscard]] DockSide side_of(std::size_t panel) const { return panels_[panel].side; }
  /// The open ones, in the order in which they were opened there.
  [[nodiscard]] const std::vector<std::size_t>& open_at(DockSide side) const { return area(side).open; }
  [[nodiscard]] std::optional<std::size_t> front_at(DockSide side) const { return area(side).front; }

  /// Opens it, or brings it to the front.
  void open(std::size_t panel);
  void close(std::size_t panel);
  /// Closes what is in front, opens what is not.
  void toggle(std::size_t panel);
  /// To another side; it stays open or closed.
  void move(std::size_t panel, DockSide side);

  /// How wide (at the bottom: how high) an area is wanted, on a screen of scale 1.
  [[nodiscard]] float size(DockSide side) const { return area(side).size; }
  void set_size(DockSide side, float size);

  /// In `whole`, on a screen of `scale`. The picture gets what the areas leave, and never less than a unit.
  [[nodiscard]] DockLayout lay_out(const DockRectangle& whole, float scale) const;
  /// The size of an area whose divider is dragged to `place` along its axis.
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
