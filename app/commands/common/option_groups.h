#pragma once

#include "app/formats/common/upright.h"
#include "app/formats/splats/splat_edit.h"
#include "app/formats/volume/raw_volume.h"
#include "app/loading/world_loader.h"
#include "app/picture/animation_request.h"
#include "app/picture/picture_request.h"
#include "app/picture/volume_show.h"
#include "app/view/pose.h"
#include "qnv/codecs/shared/encode_options.h"
#include "render/scene/draw_options.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Groups of options that several commands share. The struct of a command inherits the groups of its options.
namespace gs::app {

/// Values from a command line. Base class of the structs of all commands.
struct CommandOptions {
  virtual ~CommandOptions() = default;

  std::vector<std::string> files;
};

/// Options of commands that read files and worlds.
struct LoadingOptions : CommandOptions, LoadOptions {
  bool timeout_given = false, max_bytes_given = false;
  std::string confine;  // folder to which reading is restricted; empty means no restriction
};

/// Options of commands that also read volumes without a header.
struct InputOptions : LoadingOptions {
  RawVolume raw;  // dimensions are 0 if the files have a header
};

/// Options for the form of results.
struct ReportOptions {
  bool json = false;
  std::string stats;  // file for the measurements of the run; "-" means standard output, empty means none
};

struct UpOption {
  std::optional<UpAxis> up;  // nullopt means the axis from the settings or the file
};

/// Changes of Gaussian splats before they are written.
struct SplatEditOptions {
  SplatEdit splats;
};

/// Encoding of a stream in the words of users (`--method`).
enum class EncodeMethod : std::uint8_t { automatic, displaced, octree, records, outlines, values, gaussians };

/// Options of commands that convert an input to vectors.
struct ConversionOptions : InputOptions, UpOption, SplatEditOptions {
  std::size_t vectors = 0;  // number of vectors; 0 means that the option is not given
  double fraction = 0;      // fraction of the vectors; 0 means that the option is not given
  std::optional<double> isovalue;
  EncodeMethod method = EncodeMethod::automatic;
  bool methods_differ = false;          // true if the options name several methods
  int exact_bits = -1;                  // bits of the exact mesh in the tail; 0 means no tail, -1 decides by size
  qnv::ValueTolerance value_tolerance;  // values of a volume
  std::optional<double> parity;         // share of lost chunks that parity restores; nullopt: as the codec chooses
  std::uint64_t seed = 1;
  std::uint64_t most_voxels = 0;  // maximum voxels of a volume; 0 means unlimited
};

/// Size of pictures or of the window. Simulated input refers to a picture of this size.
struct SizeOptions {
  int width = 1024, height = 768;   // pixels
  std::optional<glm::dvec2> paper;  // size in mm; replaces the size in pixels
  bool size_given = false;          // true if the options give a size in pixels
};

/// Options for the content of pictures and the way they are drawn.
struct PictureOptions : SizeOptions, UpOption {
  int samples = 4;
  std::string viewpoint;
  std::optional<std::pair<double, double>> orbit;  // azimuth and elevation in degrees
  bool orthographic = false;
  std::optional<Pose> camera;
  render::DisplayMode display = render::DisplayMode::surface;
  std::optional<bool> backdrop;  // gradient or the world's Background; nullopt: as in a window
  std::string backend = "auto";
  render::SplatPath splats = render::SplatPath::automatic;
  std::size_t budget = 0;  // vector budget; 0 means unlimited
  std::optional<bool> headlight;
  std::optional<glm::vec3> background;
  PictureRequest picture;  // properties other than the paper size
  VolumeWishes volume;
  AnimationRequest animation;  // a single picture of a series uses only the rate
};

/// Options of commands that run simulated time.
struct SimulationOptions {
  std::string input;           // file with simulated input; empty means no input
  bool press_sensors = false;  // true presses all sensors while time passes
  std::string sound;           // WAV file to write the sound to; empty means no file
};

}  // namespace gs::app
