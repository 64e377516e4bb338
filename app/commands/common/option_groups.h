#pragma once

#include "app/formats/common/upright.h"
#include "app/formats/volume/raw_volume.h"
#include "app/loading/world_loader.h"
#include "app/picture/animation_request.h"
#include "app/picture/picture_request.h"
#include "app/picture/volume_show.h"
#include "app/view/pose.h"
#include "render/scene/draw_options.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Options that several commands share. The struct of a command derives from the groups that it accepts.
namespace gs::app {

/// Values of a command line; base of the struct of each command.
struct CommandOptions {
  virtual ~CommandOptions() = default;

  std::vector<std::string> files;
};

/// Options for reading files and worlds.
struct LoadingOptions : CommandOptions, LoadOptions {
  bool timeout_given = false, max_bytes_given = false;
  std::string confine;  // only files below this folder may be read; empty means no restriction
};

/// Options for reading files that may be volumes without a header.
struct InputOptions : LoadingOptions {
  RawVolume raw;  // all dimensions 0 if the file has a header
};

/// Forms of the results.
struct ReportOptions {
  bool json = false;
  std::string stats;  // file for the measurements of the run; "-" means standard output, empty means none
};

struct UpOption {
  std::optional<UpAxis> up;  // nullopt means the setting or that of the file
};

/// Options for the vectors that are made of an input.
struct ConversionOptions : InputOptions, UpOption {
  std::size_t vectors = 0;  // 0 means not given
  double fraction = 0;      // 0 means not given
  std::optional<double> isovalue;
  bool packed = false, records = false, displaced = false;
  int exact_bits = -1;  // of the exact mesh in the tail; 0 means no tail, -1 adds one if it saves bytes
  std::uint64_t seed = 1;
};

/// Size of pictures, of the window, or of the picture that simulated input refers to.
struct SizeOptions {
  int width = 1024, height = 768;   // pixels
  std::optional<glm::dvec2> paper;  // paper size in mm; replaces the size in pixels
  bool size_given = false;          // in pixels
};

/// Options for the content and the drawing of pictures.
struct PictureOptions : SizeOptions, UpOption {
  int samples = 4;
  std::string viewpoint;
  std::optional<std::pair<double, double>> orbit;  // azimuth and elevation in degrees
  bool orthographic = false;
  std::optional<Pose> camera;
  render::DisplayMode display = render::DisplayMode::surface;
  bool backdrop = false;
  std::string backend = "auto";
  render::SplatPath splats = render::SplatPath::automatic;
  std::size_t budget = 0;  // vectors; 0 means unlimited
  std::optional<bool> headlight;
  std::optional<glm::vec3> background;
  PictureRequest picture;  // without the paper size
  VolumeWishes volume;
  AnimationRequest animation;  // a single picture of a series uses only its rate
};

/// Options for a run of simulated time.
struct SimulationOptions {
  std::string input;           // file of simulated input; empty means none
  bool press_sensors = false;  // presses all sensors while time passes
  std::string sound;           // WAV file for the sound of the simulated time; empty means none
};

}  // namespace gs::app
