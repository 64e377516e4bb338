#pragma once

#include "app/loading/updates/loaded_world.h"

#include <deque>
#include <string>
#include <vector>

namespace gs::app {

/// Questions to the user whether worlds may read folders outside of their own. Each folder is asked about once per
/// session. Bookkeeping only: neither reads files nor draws.
class FolderQuestions {
 public:
  struct Question {
    std::string folder;
    std::string reference;            // first reference into the folder, as written in the world
    std::vector<std::string> worlds;  // paths of the worlds that refer to the folder; at least one
  };

  /// Queues questions about the folders to which a world refers, except for folders that were already answered.
  void ask(const std::string& world, const std::vector<OutsideFolder>& outside);
  /// Returns the current question, or null if there is none.
  [[nodiscard]] const Question* current() const { return questions_.empty() ? nullptr : &questions_.front(); }
  /// Answers the current question. If `allow`, returns the worlds that refer to the folder and must be read again.
  std::vector<std::string> answer(bool allow);
  /// Returns the folders that the user allowed.
  [[nodiscard]] const std::vector<std::string>& allowed() const { return allowed_; }

 private:
  std::deque<Question> questions_;
  std::vector<std::string> allowed_, refused_;
};

}  // namespace gs::app
