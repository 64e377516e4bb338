#pragma once

#include "app/loading/world_loader.h"
#include "app/session/documents/folder_questions.h"
#include "app/session/viewports/panes.h"

#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Questions of worlds to the user. Questions about folders precede those about the network. One thread.
class SessionQuestions {
 public:
  SessionQuestions(LoadOptions& load, Panes& panes) : load_(load), panes_(panes) {}

  /// Queues questions about the folders to which a world refers, except for folders that were already answered.
  void ask(const std::string& world, const std::vector<OutsideFolder>& outside) { folders_.ask(world, outside); }
  /// Returns the current question about a folder; null if there is none.
  [[nodiscard]] const FolderQuestions::Question* folder() const { return folders_.current(); }
  /// Question about the network, with the path of the world that needs the answer.
  struct Network {
    std::string world;
    NetworkQuestion question;
  };
  /// Returns the first question about the network; nullopt if no world has one.
  [[nodiscard]] std::optional<Network> network() const;
  /// Answers the question of folder(); if there is none, that of network(). Worlds that refer to a folder that is now
  /// allowed are read again.
  void answer(bool allow);

 private:
  LoadOptions& load_;
  Panes& panes_;
  FolderQuestions folders_;
};

}  // namespace gs::app
