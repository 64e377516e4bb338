#pragma once

#include "app/loading/world_loader.h"
#include "app/session/documents/folder_questions.h"
#include "app/session/viewports/panes.h"

#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Questions of worlds to the user: about folders, then about the network. One thread.
class SessionQuestions {
 public:
  SessionQuestions(LoadOptions& load, Panes& panes) : load_(load), panes_(panes) {}

  /// Queues the folders that a world refers to, except those that were already answered.
  void ask(const std::string& world, const std::vector<OutsideFolder>& outside) { folders_.ask(world, outside); }
  /// Returns the current question about a folder, or null if there is none.
  [[nodiscard]] const FolderQuestions::Question* folder() const { return folders_.current(); }
  /// Question about the network, with the path of its world.
  struct Network {
    std::string world;
    NetworkQuestion question;
  };
  /// Returns the network question, or nullopt if no world asks.
  [[nodiscard]] std::optional<Network> network() const;
  /// Answers folder(), or network() if there is no other. Worlds that refer to an allowed folder are read again.
  void answer(bool allow);

 private:
  LoadOptions& load_;
  Panes& panes_;
  FolderQuestions folders_;
};

}  // namespace gs::app
