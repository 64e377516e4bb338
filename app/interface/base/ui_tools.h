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

/// As what an animation is saved.
enum class AnimationFile : std::uint8_t { pictures, mp4, webm };

/// How pictures are saved, as the user has chosen it last.
struct PictureWish {
  bool of_window = true;  // as many pixels as the viewport has, times `scale`
  int scale = 1;          // 1..8
  glm::ivec2 size{1920, 1080};
  PictureRequest request;
  AnimationFile animation = AnimationFile::pictures;
  double seconds = 8;  // of a turntable
  double leg = 3;      // seconds from one view of a tour to the next
  double rate = 25;
};

/// What the interface shows for who measures, looks into volumes and saves pictures; of the active viewport.
struct UiTools {
  // The ruler.
  bool measuring = false;                        // clicks set its points
  std::vector<std::optional<glm::vec2>> points;  // framebuffer pixels; none: behind the viewer
  std::vector<std::string> legs;                 // lengths
  std::string measured;                          // what matters most of it
  std::string measured_text;                     // all of it, to be copied
  // What lies under the pointer.
  std::string value;
  // Volumes.
  VolumeSlices slices;
  std::array<std::uint32_t, 3> dimensions{};  // of the voxels; 0: not known yet
  bool has_file = false;                      // values can be read
  std::string slices_problem;                 // why they cannot
  bool reading = false;
  std::vector<glm::vec2> slice_edge;  // corners of the one that is held, or could be; framebuffer pixels
  bool color_bar = false;
  std::optional<ColorBar> bar;  // null: nothing has one
  // Series of files.
  std::size_t files = 0, file = 0;  // how many; the one that shows
  bool playing = false;
  double rate = 25;  // files a second
  // Pictures.
  PictureWish picture;
  std::string folder;              // where they go
  std::optional<float> exporting;  // how far that is
  std::size_t tour = 0;            // views that a tour of this file has
};

/// What the user wants of it.
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
