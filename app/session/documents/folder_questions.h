#pragma once

#include "app/loading/updates/loaded_world.h"

#include <deque>
#include <string>
#include <vector>

namespace gs::app {

/// Questions to the user about folders outside of worlds; each folder is asked about once per session. Bookkeeping
/// only: neither reads files nor draws.
class FolderQuestions {
 public:
  struct Question {
    std::string folder;
    std::string reference;            // the first one, as the world writes it
    std::vector<std::string> worlds;  // paths of the worlds that refer to the folder; none is empty
  };

  /// Queues the folders that a world refers to, except those that were already answered.
  void ask(const std::string& world, const std::vector<OutsideFolder>& outside);
  /// Returns the current question, or null if there is none.
  [[nodiscard]] const Question* current() const { return questions_.empty() ? nullptr : &questions_.front(); }
  /// Answers the current question. Returns the worlds to read again, because they refer to a folder that is now
  /// allowed.
  std::vector<std::string> answer(bool allow);
  /// Returns the folders that the user allowed.
  [[nodiscard]] const std::vector<std::string>& allowed() const { return allowed_; }

 private:
  std::deque<Question> questions_;
  std::vector<std::string> allowed_, refused_;
};

}  // namespace gs::app
