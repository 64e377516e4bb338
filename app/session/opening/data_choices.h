#pragma once

#include "app/loading/fetch/load_options.h"
#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace gs::app {

/// Choices of the data that the opened files show: dataset, step, channel, component, form and colours. One thread.
class DataChoices {
 public:
  DataChoices(StepContext& step, SessionViewports& viewports, const LoadOptions& load)
      : step_(step), viewports_(viewports), load_(load) {}

  /// Returns the choice for an entry of the list of files; that of the options if the user chose nothing.
  [[nodiscard]] VoxelComponent of(const std::string& path) const;
  /// Shows other data of the file in the active viewport. The former picture stays until they are read.
  void choose(const VoxelComponent& choice);
  /// Chooses data of an entry, and reads it again.
  void choose_for(const std::string& path, const VoxelComponent& choice);
  /// Shows data of the file in a new viewport beside the active one, and links the cameras. Reports a notice if there
  /// is no room for a viewport.
  void show_beside(const VoxelComponent& choice);
  /// Draws data of the file over the content of the active viewport.
  void show_over(const VoxelComponent& choice);
  /// Shows another opened file, by its index in the list, beside or over the active viewport.
  void show_file_beside(std::size_t file);
  void show_file_over(std::size_t file);
  /// Removes content over the active viewport.
  void remove_over(std::size_t index);
  /// Notes the data that were read. If a reader lists a single step or component, keeps the list of the previous
  /// choice, because not all readers know the others.
  void note_opened(const std::string& path, Document& document);

 private:
  [[nodiscard]] const std::string& active_path() const {
    return viewports_.panes().at(viewports_.panes().active()).shown;
  }
  /// Makes an entry for a further view of the file of the active viewport.
  [[nodiscard]] std::string add_view(const VoxelComponent& choice);
  void show_beside(const std::string& path);

  StepContext& step_;
  SessionViewports& viewports_;
  const LoadOptions& load_;
  std::map<std::string, VoxelComponent> choices_;  // by entry
};

}  // namespace gs::app
