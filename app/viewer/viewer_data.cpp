#include "app/viewer/viewer_data.h"

namespace gs::app {

UiData describe_data(Session& session) {
  UiData data;
  const Panes& panes = session.panes();
  const Pane& pane = panes.at(panes.active());
  const View* const view = pane.view();
  if (!view) return data;
  static const auto kNoDatasets = std::make_shared<const DatasetList>();
  const auto& found = view->document->data.found;
  data.list = found ? std::shared_ptr<const DatasetList>(found) : kNoDatasets;
  // The choice that is shown, until another one has been read.
  data.choice = view->document->data;
  data.choice.found.reset();
  data.choice.growing = false;
  data.is_mesh = !view->document->has_volumes && view->document->world.color_key.has_value();
  if (data.is_mesh) data.range = {view->document->world.color_key->low, view->document->world.color_key->high};
  data.loading = panes.loading(panes.active());
  for (const View::Over& over : view->over) {
    const auto& shown = over.view ? over.view->document->data.found : nullptr;
    data.over.push_back(file_label(over.path) + (shown && !shown->shown.empty() ? ": " + shown->shown : ""));
  }
  data.can_follow = true;
  data.followed = session.follower().follows(pane.shown);
  data.newest = session.follower().shows_newest(pane.shown);
  data.live = session.live().state();
  return data;
}

void apply_data(const UiDataActions& actions, Session& session) {
  DataChoices& choices = session.data();
  const Panes& panes = session.panes();
  const std::string path = panes.at(panes.active()).shown;
  if (actions.follow) session.follower().follow(path, *actions.follow);
  if (actions.newest) session.follower().follow_newest(path, *actions.newest);
  if (actions.live) session.live().change(*actions.live, actions.live_token.value_or(""));
  if (actions.choose) choices.choose(*actions.choose);
  if (actions.remove_over) choices.remove_over(*actions.remove_over);
  if (actions.over) choices.show_over(*actions.over);
  if (actions.file_over) choices.show_file_over(*actions.file_over);
  if (actions.beside) choices.show_beside(*actions.beside);
  if (actions.file_beside) choices.show_file_beside(*actions.file_beside);
}

}  // namespace gs::app
