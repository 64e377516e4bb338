#pragma once

#include "app/base/exit_status.h"
#include "app/formats/common/upright.h"
#include "app/formats/volume/raw_volume.h"
#include "app/picture/animation_request.h"
#include "app/picture/picture_request.h"
#include "app/view/panes/split_tree.h"
#include "app/view/pose.h"
#include "app/view/values/slices.h"
#include "net/base/address_space.h"
#include "net/cells/congestion.h"
#include "render/scene/draw_options.h"
#include "vrml/scene/limits.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Values of all command line options.
struct Options {
  std::vector<std::string> files;
  std::string snapshot;  // image to write; if empty, a window opens
  int width = 1024, height = 768, samples = 4;
  std::string viewpoint;
  std::optional<SplitTree> layout;                 // of the window; nullopt derives it from the number of files
  double time = 0;                                 // simulated seconds before the picture
  std::optional<double> until;                     // end time of a trace
  bool press_sensors = false;                      // presses all sensors while time passes
  std::string input;                               // file of simulated input; empty means none
  std::optional<std::pair<double, double>> orbit;  // azimuth and elevation in degrees
  std::optional<UpAxis> up;                        // nullopt means the setting or that of the file
  bool orthographic = false;
  std::optional<Pose> camera;
  render::DisplayMode display = render::DisplayMode::surface;
  bool backdrop = false;
  std::size_t max_bytes = std::numeric_limits<std::size_t>::max();
  std::string backend = "auto";
  std::string splats = "auto";
  std::size_t budget = 0;  // vectors; 0 means unlimited
  double loss = 0;
  std::uint64_t loss_seed = 1;
  std::string stats;
  std::string sound;   // WAV file for the sound of the simulated time; empty means none
  bool muted = false;  // in a window
  bool reuse = false;  // passes the files to an open window
  std::optional<bool> headlight;
  std::optional<glm::vec3> background;
  PictureRequest picture;  // without the members above
  AnimationRequest animation;
  // Display of volumes.
  std::string transfer;  // name of a colour map, or file of a transfer function; if empty, the volume's own is used
  std::vector<SliceWish> slices;
  VolumeSlices slice_look;  // without the number and positions of slices
  vrml::Limits limits;
  double timeout_seconds = 30;
  bool timeout_given = false;
  // serve
  std::optional<std::uint16_t> http_port, cells_port;
  std::string bind = "127.0.0.1", cache, log = "-";
  std::vector<std::string> host_names, origins;
  std::vector<net::AddressBlock> proxies;
  std::uint64_t rate = 0;  // bits per second; 0 means unlimited
  net::CongestionResponse congestion = net::CongestionResponse::equation;
  bool offline = false;
  bool allow_network = false;        // also for Scripts that have read private files
  std::vector<std::string> allowed;  // files and folders that worlds may read besides their own folders
  std::string confine;               // only files below this folder may be read; empty means no restriction
  bool markdown = false, wrl = false, json = false, vrml97 = false, scripts = false;
  std::size_t vectors = 0;       // 0 means not given
  double fraction = 0;           // 0 means not given
  bool max_bytes_given = false;  // `max_bytes` also limits the output
  std::optional<double> isovalue;
  bool packed = false, records = false, displaced = false;
  int exact_bits = -1;  // of the exact mesh in the tail; 0 means no tail, -1 adds one if it saves bytes
  bool outlines = false;
  std::optional<double> tolerance;  // of outline groups, in units; nullopt derives it from the model's size
  double merge = 0;                 // of their polygons, in units
  std::size_t groups = 0;           // approximate; 0 means as few as the tolerance allows
  int position_bits = 16;
  std::uint64_t seed = 1;
  RawVolume raw;                             // all dimensions 0 if the file has a header
  std::vector<std::string> control_paths;    // Unix sockets for clients
  std::vector<std::uint16_t> control_ports;  // TCP ports on this machine for clients
  std::string control_token;                 // file for the token; if empty, it is printed on standard error
  bool size_given = false;
  std::string config;  // settings file; empty means the user's
  bool no_config = false;
};

/// Option. Parsing, --help and the manual page are made from these rows.
struct OptionRow {
  std::string_view name;      // "--size"
  std::string_view argument;  // "WxH"; empty for a flag; "[=BITS]" if it is optional
  std::string_view standard;  // default value for the help; may be empty
  std::string_view help;
  std::string_view commands;  // commands that accept it, each followed by a blank: "open check "
  /// Sets the value. Returns the expected form if it is wrong.
  std::optional<std::string> (*set)(Options& options, const std::string& value);
  bool repeats = false;  // may be given several times
};
[[nodiscard]] std::span<const OptionRow> option_rows();
/// Returns true if the argument is optional; its value is empty if it is omitted.
[[nodiscard]] constexpr bool has_optional_value(const OptionRow& row) { return row.argument.starts_with("[="); }

/// Command. The first row, "open", is used if the command line names no command.
struct CommandRow {
  std::string_view name;
  std::string_view arguments;  // "FILE..."
  std::string_view help;
  std::size_t least_files, most_files;
  int (*run)(const Options& options);
  /// Checks combinations of options that are valid one by one. Null if there is nothing to check.
  std::optional<std::string> (*check)(const Options& options) = nullptr;
};
[[nodiscard]] std::span<const CommandRow> command_rows();

}  // namespace gs::app
