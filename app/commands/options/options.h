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

/// What the command line asks for.
struct Options {
  std::vector<std::string> files;
  std::string snapshot;  // picture to write; empty: open a window
  int width = 1024, height = 768, samples = 4;
  std::string viewpoint;
  std::optional<SplitTree> layout;                 // of the window; nothing: by how many files there are
  double time = 0;                                 // simulated seconds before a picture is drawn
  std::optional<double> until;                     // of a trace
  bool press_sensors = false;                      // somebody tries all sensors meanwhile
  std::string input;                               // file of what somebody does meanwhile; empty: none
  std::optional<std::pair<double, double>> orbit;  // azimuth, elevation in degrees
  std::optional<UpAxis> up;                        // none: as the settings say, or the file
  bool orthographic = false;
  std::optional<Pose> camera;
  render::DisplayMode display = render::DisplayMode::surface;
  bool backdrop = false;
  std::size_t max_bytes = std::numeric_limits<std::size_t>::max();
  std::string backend = "auto";
  std::string splats = "auto";
  std::size_t budget = 0;  // vectors; 0: no limit
  double loss = 0;
  std::uint64_t loss_seed = 1;
  std::string stats;
  std::string sound;   // WAV of what is heard in simulated time; empty: none
  bool muted = false;  // in a window
  bool reuse = false;  // of a window that is there already
  std::optional<bool> headlight;
  std::optional<glm::vec3> background;
  PictureRequest picture;  // but for what is above
  AnimationRequest animation;
  // How volumes are shown.
  std::string transfer;  // the name of a colour map, or a file of a transfer function; empty: their own
  std::vector<SliceWish> slices;
  VolumeSlices slice_look;  // but for which, and where
  vrml::Limits limits;
  double timeout_seconds = 30;
  bool timeout_given = false;
  // serve
  std::optional<std::uint16_t> http_port, cells_port;
  std::string bind = "127.0.0.1", cache, log = "-";
  std::vector<std::string> host_names, origins;
  std::vector<net::AddressBlock> proxies;
  std::uint64_t rate = 0;  // bits a second; 0: no limit
  net::CongestionResponse congestion = net::CongestionResponse::equation;
  bool offline = false;
  bool allow_network = false;        // for Scripts that have read private files
  std::vector<std::string> allowed;  // files and folders that worlds may read besides their own folders
  std::string confine;               // folder beneath which is all that may be read; empty: as the system allows
  bool markdown = false, wrl = false, json = false, vrml97 = false, scripts = false;
  std::size_t vectors = 0;       // 0: not asked for
  double fraction = 0;           // 0: not asked for
  bool max_bytes_given = false;  // `max_bytes` bounds what is written, too
  std::optional<double> isovalue;
  bool packed = false, records = false, displaced = false;
  int exact_bits = -1;  // of the mesh at the end of the stream; 0: without it, -1: where it pays
  bool outlines = false;
  std::optional<double> tolerance;  // of outline groups, units; none: by the model's size
  double merge = 0;                 // of their polygons, units
  std::size_t groups = 0;           // about; 0: as few as the tolerance allows
  int position_bits = 16;
  std::uint64_t seed = 1;
  RawVolume raw;                             // dimensions 0: the file has a header
  std::vector<std::string> control_paths;    // Unix sockets for those who control the program
  std::vector<std::uint16_t> control_ports;  // and ports of this machine
  std::string control_token;                 // file for the token; empty: on standard error
  bool size_given = false;
  std::string config;  // file of settings; empty: the user's own
  bool no_config = false;
};

/// One option: the row from which parsing, --help and the manual page are made.
struct OptionRow {
  std::string_view name;      // "--size"
  std::string_view argument;  // "WxH"; empty for a flag; "[=BITS]": may be left out
  std::string_view standard;  // default, for the help; may be empty
  std::string_view help;
  std::string_view commands;  // where it may stand, a blank behind each: "open check "
  /// Takes the value; what was expected when it is wrong.
  std::optional<std::string> (*set)(Options& options, const std::string& value);
  bool repeats = false;  // may be given several times
};
[[nodiscard]] std::span<const OptionRow> option_rows();
/// Whether its argument may be left out; then its value is empty.
[[nodiscard]] constexpr bool has_optional_value(const OptionRow& row) { return row.argument.starts_with("[="); }

/// One command. The first, "open", is what a command line without the name of one means.
struct CommandRow {
  std::string_view name;
  std::string_view arguments;  // "FILE..."
  std::string_view help;
  std::size_t least_files, most_files;
  int (*run)(const Options& options);
  /// What is wrong with options that are right one by one; null: nothing can be.
  std::optional<std::string> (*check)(const Options& options) = nullptr;
};
[[nodiscard]] std::span<const CommandRow> command_rows();

}  // namespace gs::app
