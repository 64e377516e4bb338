#pragma once

#include "app/commands/common/option_groups.h"
#include "app/control/control_service.h"
#include "app/view/panes/split_tree.h"

namespace gs::app {

/// Options of `open`.
struct OpenCommand : LoadingOptions, PictureOptions, SimulationOptions, ReportOptions {
  std::string snapshot;             // image to write; if empty, a window opens
  double time = 0;                  // simulated seconds before the picture
  std::optional<SplitTree> layout;  // of the window; nullopt derives it from the number of files
  bool muted = false;
  bool reuse = false;  // passes the files to an open window
  ControlPlaces control;
  std::string config;  // settings file; empty means the user's
  bool no_config = false;
};
int run_open(const OpenCommand& options);
/// Returns the problem with its subject, an option or the command.
std::optional<std::string> check_open(const OpenCommand& options);

/// Draws one world without a window (`--snapshot`).
int run_snapshot(const OpenCommand& options, const std::string& file);

}  // namespace gs::app
