#pragma once

#include "app/world/opened_world.h"

#include <deque>
#include <string>
#include <vector>

namespace gs::app {

/// What the user is asked about folders outside of worlds: each folder once a session. Plain bookkeeping: it neither
/// reads nor draws.
class FolderQuestions {
 public:
  struct Question {
    std::string folder;
    std::string reference;            // the first, as the world has it
    std::vector<std::string> worlds;  // that refer to it, by path; none empty
  };

  /// A world was read that refers to these folders. Those that were answered already are not asked about again.
  void ask(const std::string& world, const std::vector<OutsideFolder>& outside);
  /// The question of now; null: there is none.
  [[nodiscard]] const Question* current() const { return questions_.empty() ? nullptr : &questions_.front(); }
  /// The answer to it. What has to be read again: the worlds that refer to a folder that is allowed from now on.
  std::vector<std::string> answer(bool allow);
  /// Folders that were allowed.
  [[nodiscard]] const std::vector<std::string>& allowed() const { return allowed_; }

 private:
  std::deque<Question> questions_;
  std::vector<std::string> allowed_, refused_;
};

}  // namespace gs::app
