#pragma once

#include "app/picture/picture_request.h"
#include "app/view/values/color_bar.h"
#include "app/view/values/slices.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Output format of an animation.
enum class AnimationFile : std::uint8_t { pictures, mp4, webm };

/// Picture settings, as last chosen by the user.
struct PictureWish {
  bool of_window = true;  // uses the viewport's size times `scale`
  int scale = 1;          // 1..8
  glm::ivec2 size{1920, 1080};
  PictureRequest request;
  AnimationFile animation = AnimationFile::pictures;
  double seconds = 8;  // seconds per turn of a turntable
  double leg = 3;      // seconds between two views of a tour
  double rate = 25;
};

/// State of the measure, volume and picture tools for the active viewport.
struct UiTools {
  // Ruler.
  bool measuring = false;                        // clicks add points
  std::vector<std::optional<glm::vec2>> points;  // framebuffer pixels; empty if behind the viewer
  std::vector<std::string> legs;                 // lengths
  std::string measured;                          // one-line summary
  std::string measured_text;                     // full text for copying
  // Value under the pointer.
  std::string value;
  // Volumes.
  VolumeSlices slices;
  std::array<std::uint32_t, 3> dimensions{};  // in voxels; 0 means unknown
  bool has_file = false;                      // values can be read from the file
  std::string slices_problem;                 // error message if they cannot be read
  bool reading = false;
  std::vector<glm::vec2> slice_edge;  // corners of the hovered or dragged slice, framebuffer pixels
  bool color_bar = false;
  std::optional<ColorBar> bar;  // empty if nothing has a colour bar
  // File series.
  std::size_t files = 0, file = 0;  // number of files, and index of the current one
  bool playing = false;
  double rate = 25;  // files per second
  // Pictures.
  PictureWish picture;
  std::string folder;              // target folder
  std::optional<float> exporting;  // export progress, 0..1
  std::size_t tour = 0;            // number of tour views of this file
};

/// Requests of the user to the tools.
struct UiToolActions {
  std::optional<bool> measure, color_bar, play;
  bool forget_points = false, undo_point = false, wants_value = false;
  std::optional<VolumeSlices> slices;
  std::optional<std::size_t> file;
  std::optional<double> rate;
  std::optional<PictureWish> picture;
  bool take_picture = false, take_turntable = false, cancel_export = false;
  bool add_to_tour = false, forget_tour_view = false, take_tour = false;
  std::optional<std::string> save_transfer, load_transfer;  // paths
};

}  // namespace gs::app
