#pragma once

#include "app/picture/picture_request.h"
#include "app/view/derived/volume_histogram.h"
#include "app/view/values/color_bar.h"
#include "app/view/values/slices.h"
#include "app/view/values/volume_display.h"
#include "qnv/base/geometry.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Output format of an animation.
enum class AnimationFile : std::uint8_t { pictures, mp4, webm };

/// Picture settings that the user chose last.
struct PictureWish {
  bool of_window = true;  // the picture has the size of the viewport times `scale`, else `size`
  int scale = 1;          // 1 to 8
  glm::ivec2 size{1920, 1080};
  PictureRequest request;
  AnimationFile animation = AnimationFile::pictures;
  double seconds = 8;  // seconds per turn of a turntable animation
  double leg = 3;      // seconds between two views of a tour
  double rate = 25;
};

/// State of the measure, volume and picture tools for the active viewport.
struct UiTools {
  // Ruler.
  bool measuring = false;                        // clicks in the picture add points
  std::vector<std::optional<glm::vec2>> points;  // framebuffer pixels; nullopt for a point behind the camera
  std::vector<std::string> legs;                 // length of each segment of the ruler
  std::string measured;                          // one-line summary of the ruler
  std::string measured_text;                     // full text of the ruler, for copying
  // Value under the pointer.
  std::string value;
  // Volumes.
  VolumeSlices slices;
  std::array<std::uint32_t, 3> dimensions{};  // of the volume, in voxels; 0 means unknown
  bool has_file = false;                      // voxel values can be read from the file
  std::string slices_problem;                 // error message if the voxel values cannot be read
  bool reading = false;                       // the first values are being read
  VolumeDisplay volume;
  std::shared_ptr<const VolumeHistogram> histogram;  // null until it is made
  std::optional<float> isovalue;                     // of the isosurface; nullopt until it is known
  std::shared_ptr<const qnv::Volume> vectors;        // of another share than usual, or null
  std::string unit;                                  // of the values; may be empty
  std::vector<glm::vec2> slice_edge;                 // corners of the hovered or dragged slice, in framebuffer pixels
  bool color_bar = false;
  std::optional<ColorBar> bar;  // nullopt if the world has nothing with a colour scale
  // Time series of volumes.
  std::vector<double> times;  // of the steps; empty for other contents
  bool steps_playing = false;
  double step_rate = 10;  // steps per second
  // File series.
  std::size_t files = 0, file = 0;  // number of files of the series, and index of the displayed one
  std::optional<double> file_time;  // of the displayed step, if the series is that of the steps of a file
  bool playing = false;
  double rate = 25;  // files per second
  // Pictures.
  PictureWish picture;
  std::string folder;              // target folder of pictures
  std::optional<float> exporting;  // export progress, 0 to 1; nullopt if no export runs
  std::size_t tour = 0;            // number of views in the tour of this file
};

/// Requests of the user to the tools in this frame.
struct UiToolActions {
  std::optional<bool> measure, color_bar, play, play_steps;
  bool forget_points = false, undo_point = false, wants_value = false;
  bool wants_histogram = false;
  std::optional<VolumeSlices> slices;
  std::optional<VolumeDisplay> volume;
  std::optional<std::size_t> file;
  std::optional<double> rate, step_rate;
  std::optional<PictureWish> picture;
  bool take_picture = false, take_turntable = false, cancel_export = false;
  bool add_to_tour = false, forget_tour_view = false, take_tour = false;
  std::optional<std::string> save_transfer, load_transfer;  // paths of transfer function files
};

}  // namespace gs::app
