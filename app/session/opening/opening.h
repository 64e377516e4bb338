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

/// Opening of files and URLs in viewports, with the Viewpoints and budgets that their links name. One thread.
class Opening {
 public:
  Opening(StepContext& step, SessionViewports& viewports, LoadOptions& load, SessionLog& log)
      : step_(step), viewports_(viewports), load_(load), log_(log) {}

  /// Shows the files of the command line; see Panes::start().
  void start(const std::vector<std::string>& paths, const std::optional<SplitTree>& split);
  void open_files(const std::vector<std::string>& paths);
  void select_file(std::size_t index);
  /// Opens a file or URL in a viewport.
  void open_in(std::size_t pane, const std::string& path);
  /// Opens the file again that a viewport could not show.
  void open_again(std::size_t pane);
  /// Restores the split of an earlier window, with the files and weights of its viewports.
  void restore_split(const SplitTree& split, const std::map<std::size_t, std::string>& files,
                     const std::map<std::size_t, double>& weights);
  /// Returns the path or URL of a place that the user gave, and allows worlds to read it. Returns nullopt and reports
  /// the problem if it is a broken link.
  [[nodiscard]] std::optional<std::string> allowed_target(const std::string& place);
  /// Shows a listed or new file in the active viewport. A listed file is not read again.
  void show(const std::string& path);
  /// Sets the memory limit in bytes of worlds that are opened from now on.
  void set_memory(std::size_t bytes) { load_.limits.memory = bytes; }

  /// Sets the Viewpoint at which the viewer enters a file once its world is running.
  void enter_at(const std::string& path, const std::string& viewpoint) { entries_[path] = viewpoint; }
  /// Sets the Viewpoint of a file, unless a link has named one.
  void enter_by_default_at(const std::string& path, const std::string& viewpoint) {
    entries_.try_emplace(path, viewpoint);
  }
  /// Returns the Viewpoint at which to enter a file, or null.
  [[nodiscard]] const std::string* entry_of(const std::string& path) const;
  void forget_entry(const std::string& path) { entries_.erase(path); }
  /// Returns the number of vectors that a link to a file asks for; 0 means none.
  [[nodiscard]] std::size_t budget_of(const std::string& path) const;

 private:
  [[nodiscard]] std::vector<std::string> targets_of(const std::vector<std::string>& given);

  StepContext& step_;
  SessionViewports& viewports_;
  LoadOptions& load_;
  SessionLog& log_;
  std::map<std::string, std::string> entries_;  // Viewpoints of links, by file
  std::map<std::string, std::size_t> budgets_;  // vectors that links ask for, by file
};

}  // namespace gs::app
