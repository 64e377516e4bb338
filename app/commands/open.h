#pragma once

#include "app/commands/common/option_groups.h"
#include "app/control/control_service.h"
#include "app/view/panes/split_tree.h"

namespace gs::app {

/// Options of `open`.
struct OpenCommand : LoadingOptions, PictureOptions, SimulationOptions, ReportOptions {
  std::string snapshot;  // image file to write; empty opens a window instead
  double time = 0;  // simulated seconds before the picture is drawn
  std::optional<SplitTree> layout;  // layout of the window; nullopt derives it from the number of files
  bool muted = false;
  bool reuse = false;  // true passes the files to a window that is already open
  ControlPlaces control;
  std::string config;  // path of the settings file; empty means the user's
  bool no_config = false;
};
int run_open(const OpenCommand& options);
/// Checks the options together. Returns an error that names the option or the command, or nullopt.
std::optional<std::string> check_open(const OpenCommand& options);

/// Draws one world to an image file, without a window (`--snapshot`).
int run_snapshot(const OpenCommand& options, const std::string& file);

}  // namespace gs::app
