#include "app/session/documents/folder_questions.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

bool has_entry(const std::vector<std::string>& list, const std::string& one) {
  return std::find(list.begin(), list.end(), one) != list.end();
}

}  // namespace

void FolderQuestions::ask(const std::string& world, const std::vector<OutsideFolder>& outside) {
  for (const OutsideFolder& one : outside) {
    if (has_entry(allowed_, one.folder) || has_entry(refused_, one.folder)) continue;
    auto known = std::find_if(questions_.begin(), questions_.end(),
                              [&](const Question& question) { return question.folder == one.folder; });
    if (known == questions_.end()) known = questions_.insert(known, {one.folder, one.reference, {}});
    if (!has_entry(known->worlds, world)) known->worlds.push_back(world);
  }
}

std::vector<std::string> FolderQuestions::answer(bool allow) {
  if (questions_.empty()) return {};
  Question answered = std::move(questions_.front());
  questions_.pop_front();
  (allow ? allowed_ : refused_).push_back(std::move(answered.folder));
  return allow ? std::move(answered.worlds) : std::vector<std::string>();
}

}  // namespace gs::app
