#include "app/viewer/viewer_window.h"

namespace gs::app {

std::vector<SessionInput::Event> Viewer::take(const std::vector<WindowEvent>& events) {
  std::vector<SessionInput::Event> result;
  for (const WindowEvent& event : events) {
    if (event.kind == WindowEvent::Kind::key_down) {
      const ActionRow* row = action_of(event);
      const bool typed = ui_.wants_keys();
      if (row && !(row->of_world && typed) && run(row->action)) continue;
      if (typed && !(row && !row->of_world)) continue;
    }
    result.push_back({event, ui_.wants_pointer()});
    tools_.take(result.back(), session_.view(), active_place());
  }
  return result;
}

// True where it is the interface's, or the window's, alone.
bool Viewer::run(Action action) {
  switch (action) {
    case Action::full_screen:
      window_->toggle_full_screen();
      return true;
    case Action::ruler:
      tools_.toggle_ruler();
      return true;
    case Action::take_picture:
      if (const View* seen = session_.view()) tools_.take_picture(*seen, active_place(), teller());
      return true;
    case Action::close:
      return ui_.run(action) || tools_.close();
    case Action::quit:
      window_->close();
      return true;
    default:
      return ui_.run(action);
  }
}

void Viewer::apply(const UiActions& actions) {
  if (actions.open) {
    opening_ = given_place(*actions.open).target;
    session_.open_files({*actions.open});
  }
  if (actions.file) session_.select_file(*actions.file);
  if (actions.layout) session_.choose_layout(*actions.layout);
  if (actions.run && !run(*actions.run)) (void)session_.run(*actions.run);
  if (actions.allow_folder) session_.answer_question(*actions.allow_folder);
  if (actions.cancel_loading) session_.cancel_loading(*actions.cancel_loading);
  View* seen = session_.view();
  if (actions.tools.play) session_.play_series(*actions.tools.play);
  if (actions.tools.file) session_.show_of_series(*actions.tools.file);
  if (actions.tools.rate) session_.set_series_rate(*actions.tools.rate);
  tools_.apply(actions.tools, seen, active_place(), teller());
  if (!seen) return;
  if (actions.viewpoint) {
    const std::vector<std::size_t> listed = listed_viewpoints(seen->list->viewpoints);
    if (*actions.viewpoint < listed.size()) session_.bind_viewpoint(listed[*actions.viewpoint]);
  }
  if (actions.mode) session_.choose_mode(*actions.mode);
  if (actions.look) seen->look = *actions.look;
}

}  // namespace gs::app
