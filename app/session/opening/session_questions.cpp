#include "app/session/opening/session_questions.h"

#include <utility>

namespace gs::app {

std::optional<SessionQuestions::Network> SessionQuestions::network() const {
  for (const DocumentList::Entry& entry : panes_.documents().entries())
    if (entry.document && entry.document->runtime)
      if (auto question = entry.document->runtime->requests().network_question())
        return Network{entry.path, std::move(*question)};
  return std::nullopt;
}

void SessionQuestions::answer(bool allow) {
  if (!folders_.current()) {
    if (const auto asked = network())
      panes_.documents().document(asked->world)->runtime->requests().answer_network_question(allow);
    return;
  }
  if (allow) load_.allowed.push_back(folders_.current()->folder);
  for (const std::string& world : folders_.answer(allow)) panes_.documents().reload_unedited(world);
}

}  // namespace gs::app
