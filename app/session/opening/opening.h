#pragma once

#include "app/loading/world_loader.h"
#include "app/session/documents/session_log.h"
#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Opening of files and URLs in viewports. Stores the Viewpoints and budgets that links name. One thread.
class Opening {
 public:
  Opening(StepContext& step, SessionViewports& viewports, LoadOptions& load, SessionLog& log)
      : step_(step), viewports_(viewports), load_(load), log_(log) {}

  /// Opens the files of the command line; see Panes::start().
  void start(const std::vector<std::string>& paths, const std::optional<SplitTree>& split);
  void open_files(const std::vector<std::string>& paths);
  void select_file(std::size_t index);
  /// Opens a file or URL in a viewport.
  void open_in(std::size_t pane, const std::string& path);
  /// Retries the file that a viewport could not show.
  void open_again(std::size_t pane);
  /// Restores the arrangement of viewports of an earlier window, with their files and weights.
  void restore_split(const SplitTree& split, const std::map<std::size_t, std::string>& files,
                     const std::map<std::size_t, double>& weights);
  /// Returns the path or URL of a file that the user entered, and allows worlds to read it. If it is an invalid link,
  /// reports the error and returns nullopt.
  [[nodiscard]] std::optional<std::string> allowed_target(const std::string& place);
  /// Shows a file in the active viewport. Reads the file only if it is not in the list yet.
  void show(const std::string& path);
  /// Sets the memory limit of worlds that are opened from now on, in bytes.
  void set_memory(std::size_t bytes) { load_.limits.memory = bytes; }

  /// Sets the Viewpoint at which the viewer enters a file when its world is running.
  void enter_at(const std::string& path, const std::string& viewpoint) { entries_[path] = viewpoint; }
  /// Sets the Viewpoint at which the viewer enters a file, unless a link has already set one.
  void enter_by_default_at(const std::string& path, const std::string& viewpoint) {
    entries_.try_emplace(path, viewpoint);
  }
  /// Returns the Viewpoint at which the viewer enters a file; null if none is set.
  [[nodiscard]] const std::string* entry_of(const std::string& path) const;
  void forget_entry(const std::string& path) { entries_.erase(path); }
  /// Returns the vector budget that a link to a file sets; 0 means none.
  [[nodiscard]] std::size_t budget_of(const std::string& path) const;

 private:
  [[nodiscard]] std::vector<std::string> targets_of(const std::vector<std::string>& given);

  StepContext& step_;
  SessionViewports& viewports_;
  LoadOptions& load_;
  SessionLog& log_;
  std::map<std::string, std::string> entries_;  // Viewpoints that links set, by file
  std::map<std::string, std::size_t> budgets_;  // vector budgets that links set, by file
};

}  // namespace gs::app
